/* Technique specs: "name" or "name:key=value,...", whatever the locale. */
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_context.h"
#include "techniques/registry.h"

static double value_of(const char *spec, const char *name) {
  const pn_technique *t = NULL;
  double values[PNI_PARAMETERS_MAX];
  char why[256] = "x";
  if (pn_technique_parse(spec, &t, values, why, sizeof why) != PN_OK) fail_msg("%s: %s", spec, why);
  assert_string_equal(why, "");
  for (int i = 0; i < t->parameter_count; i++)
    if (!strcmp(t->parameters[i].name, name)) return values[i];
  fail_msg("%s has no %s", spec, name);
  return 0;
}

/* Refused, with a line that has all the words; technique and values untouched. */
static void refuse(const char *spec, const char *word, const char *other) {
  const pn_technique *t = NULL;
  double values[PNI_PARAMETERS_MAX];
  char why[512] = "";
  for (int i = 0; i < PNI_PARAMETERS_MAX; i++) values[i] = -7;
  assert_int_equal(pn_technique_parse(spec, &t, values, why, sizeof why), PN_ERROR_ARGUMENT);
  assert_null(t);
  for (int i = 0; i < PNI_PARAMETERS_MAX; i++) assert_true(values[i] == -7);
  if (!strstr(why, word) || !strstr(why, other) || strchr(why, '\n'))
    fail_msg("%s: '%s' lacks '%s' or '%s'", spec, why, word, other);
}

static void test_defaults(void **state) {
  (void)state;
  for (int i = 0; i < pn_technique_count(); i++) {
    const pn_technique *t = pn_technique_at(i), *found = NULL;
    double values[PNI_PARAMETERS_MAX];
    assert_int_equal(pn_technique_parse(t->name, &found, values, NULL, 0), PN_OK);
    assert_ptr_equal(found, t);
    assert_ptr_equal(pn_technique_find(t->name), t);
    assert_true(t->parameter_count <= PNI_PARAMETERS_MAX);
    for (int k = 0; k < t->parameter_count; k++) {
      const pn_parameter *p = &t->parameters[k];
      assert_true(values[k] == p->initial && p->least <= p->initial && p->initial <= p->most);
      assert_true(*p->name && *p->help && p->unit && p->source);
      int choices = 0;
      while (p->type == PN_CHOICE && p->choices[choices]) choices++;
      if (p->type == PN_CHOICE) assert_true(p->least == 0 && p->most == choices - 1);
    }
  }
  assert_null(pn_technique_at(-1));
  assert_null(pn_technique_at(pn_technique_count()));
  assert_null(pn_technique_find(NULL));
  assert_null(pn_technique_find("Hard"));
}

static void test_good(void **state) {
  (void)state;
  assert_true(value_of("pcf:taps=7", "taps") == 7);
  assert_true(value_of("pcf:taps=7", "filter") == 0);
  assert_true(value_of("pcf:filter=bicubic,taps=64", "filter") == 1);
  assert_true(value_of("pcf:taps=7,taps=9", "taps") == 9); /* the last one counts */
  assert_true(value_of("pcss:samples=1e1", "samples") == 10);
  assert_true(value_of("pcss:samples=+4.0", "samples") == 4);
  assert_true(value_of("average:samples=65536", "samples") == 65536);
  assert_true(value_of("bitmask:merge=2.5", "merge") == 2.5);
  assert_int_equal(pn_technique_parse("hard", NULL, NULL, NULL, 0), PN_OK);
}

static void test_bad(void **state) {
  (void)state;
  refuse(NULL, "technique", "");
  refuse("", "''", "pcss");
  refuse("soft", "'soft'", "pcss");
  refuse(" hard", "' hard'", "hard");
  refuse("hard:samples=3", "samples", "none");
  refuse("pcss:sample=3", "sample", "samples");
  refuse("pcss:samples", "samples", "key=value");
  refuse("pcss:", "key=value", "pcss");
  refuse("pcss:samples=3,", "key=value", "pcss");
  refuse("pcss:=3", "''", "samples");
  static const char *const numbers[] = {
      "",    "0",    "65",    "-1",  "2.5", "nan",
      "inf", "0x10", "1e999", "8 ",  " 8",  "8,5x",
      "--8", "1e",   "1.2.3", "1,5", "8;",  "9999999999999999999999999999999999999999999999999999999999999999999999"};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
    char spec[256] = "pcss:samples=";
    strcat(spec, numbers[i]);
    refuse(spec, "pcss", "");
  }
  refuse("pcf:filter=Box", "filter=Box", "bicubic");
  refuse("pcf:filter=0", "filter=0", "box");
  char *huge = malloc(100001);
  memset(huge, 'a', 100000);
  huge[100000] = 0;
  refuse(huge, "long", "");
  memcpy(huge, "pcss:", 5);
  huge[400] = 0;
  refuse(huge, "key=value", "");
  huge[300] = '=';
  refuse(huge, "unknown", "");
  free(huge);
}

/* However short the space for the reason, it is terminated and nothing is written after it. */
static void test_short_reason(void **state) {
  (void)state;
  for (size_t size = 0; size < 40; size++) {
    char why[48];
    memset(why, '#', sizeof why);
    assert_int_equal(pn_technique_parse("pcss:samples=0", NULL, NULL, why, size), PN_ERROR_ARGUMENT);
    if (size) assert_true(memchr(why, 0, size) != NULL);
    for (size_t i = size; i < sizeof why; i++) assert_true(why[i] == '#');
  }
}

/* A locale with a decimal comma, if there is one here: numbers keep their point. */
static void test_locale(void **state) {
  (void)state;
  static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8", "de_DE", "fr_FR"};
  bool found = false;
  for (size_t i = 0; i < sizeof names / sizeof *names && !found; i++) found = setlocale(LC_ALL, names[i]) != NULL;
  if (!found) print_message("no locale with a comma here\n");
  assert_true(value_of("bitmask:merge=2.5", "merge") == 2.5);
  assert_true(value_of("bitmask:merge=1.25e1", "merge") == 12.5);
  refuse("bitmask:merge=2,5", "key=value", "");
  setlocale(LC_ALL, "C");
}

static void test_set_by_name(void **state) {
  (void)state;
  const pni_technique_class *t = pni_technique_class_of(pn_technique_find("pcf"));
  double values[2] = {0, 5};
  pni_explanation why;
  assert_true(pni_parameter_set(t, "taps", 9, values, &why) == PN_OK && values[1] == 9);
  assert_int_equal(pni_parameter_set(t, "tap", 9, values, &why), PN_ERROR_ARGUMENT);
  assert_int_equal(why.message, PN_MESSAGE_PARAMETER_UNKNOWN);
  static const double bad[] = {0, 65, 2.5, NAN, INFINITY, -1};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    assert_int_equal(pni_parameter_set(t, "taps", bad[i], values, &why), PN_ERROR_ARGUMENT);
    assert_int_equal(why.message, PN_MESSAGE_PARAMETER_VALUE);
  }
  assert_true(values[1] == 9);
}

/* A number whose least value has a name. */
static void test_word(void **state) {
  (void)state;
  assert_true(value_of("smoothies", "width") == 0);
  assert_true(value_of("smoothies:width=light", "width") == 0);
  assert_true(value_of("smoothies:width=0", "width") == 0);
  assert_true(value_of("smoothies:width=0.25", "width") == 0.25);
  refuse("smoothies:width=dark", "width=dark", "light or a number from 0 to 100");
  refuse("smoothies:width=101", "width=101", "light or");
  refuse("smoothies:width=lights", "width=lights", "light or");
  refuse("pcss:samples=light", "samples=light", "whole number");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_defaults),     cmocka_unit_test(test_good),   cmocka_unit_test(test_bad),
      cmocka_unit_test(test_short_reason), cmocka_unit_test(test_locale), cmocka_unit_test(test_word),
      cmocka_unit_test(test_set_by_name),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
