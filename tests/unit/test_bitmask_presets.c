/* Presets of the papers' techniques set the other parameters, whatever is named before or after them; what is named
 * goes over them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "light.h"
#include "stage.h"

static const char *const names[] = {"bitmask", "backprojection", "ssm", "smoothies"};
enum { NAMES = 4, CHOICES = 4, SEARCHING = 2 };
static const char *const choices[] = {"fast", "good", "exact", "paper"};

static int index_of(const pn_technique *t, const char *name) {
  for (int i = 0; i < t->parameter_count; i++)
    if (!strcmp(t->parameters[i].name, name)) return i;
  fail_msg("%s has no parameter %s", t->name, name);
  return -1;
}

static const pn_technique *parse(const char *spec, double values[PNI_PARAMETERS_MAX]) {
  const pn_technique *t;
  char why[256];
  if (pn_technique_parse(spec, &t, values, why, sizeof why) != PN_OK) fail_msg("%s: %s", spec, why);
  return t;
}

/* A value of the parameter that is not the one given, as a spec writes it. */
static double other_value(const pn_parameter *p, double value, char out[64]) {
  double other = value == p->least ? p->least + 1 : p->least;
  if (p->type == PN_CHOICE) snprintf(out, 64, "%s=%s", p->name, p->choices[(int)other]);
  else if (p->type == PN_BOOL) snprintf(out, 64, "%s=%s", p->name, other != 0 ? "on" : "off");
  else snprintf(out, 64, "%s=%g", p->name, other);
  return other;
}

/* Every preset with every other parameter named before it and after it. */
static void test_order(void **state) {
  (void)state;
  for (int n = 0; n < NAMES; n++)
    for (int c = 0; c < CHOICES; c++) {
      char spec[160], named[64];
      double preset[PNI_PARAMETERS_MAX], values[PNI_PARAMETERS_MAX];
      snprintf(spec, sizeof spec, "%s:preset=%s", names[n], choices[c]);
      const pn_technique *t = parse(spec, preset);
      assert_true(preset[index_of(t, "preset")] == c);
      for (int i = 0; i < t->parameter_count; i++) {
        assert_true(preset[i] >= t->parameters[i].least && preset[i] <= t->parameters[i].most);
        if (!strcmp(t->parameters[i].name, "preset")) continue;
        double other = other_value(&t->parameters[i], preset[i], named);
        for (int after = 0; after < 2; after++) {
          snprintf(spec, sizeof spec, "%s:%s%s%s,preset=%s%s%s", names[n], after ? "preset=" : "",
                   after ? choices[c] : "", after ? "" : named, choices[c], after ? "," : "", after ? named : "");
          if (after) snprintf(spec, sizeof spec, "%s:preset=%s,%s", names[n], choices[c], named);
          parse(spec, values);
          for (int k = 0; k < t->parameter_count; k++)
            if (values[k] != (k == i ? other : preset[k]))
              fail_msg("%s: %s is %g", spec, t->parameters[k].name, values[k]);
        }
      }
    }
}

/* Nothing named is the default preset, and its values are those the table calls initial; presets differ from one
 * another. */
static void test_default(void **state) {
  (void)state;
  for (int n = 0; n < NAMES; n++) {
    double plain[PNI_PARAMETERS_MAX], all[CHOICES][PNI_PARAMETERS_MAX];
    const pn_technique *t = parse(names[n], plain);
    for (int i = 0; i < t->parameter_count; i++) assert_true(plain[i] == t->parameters[i].initial);
    for (int c = 0; c < CHOICES; c++) {
      char spec[64];
      snprintf(spec, sizeof spec, "%s:preset=%s", names[n], choices[c]);
      parse(spec, all[c]);
    }
    int preset = index_of(t, "preset"), chosen = (int)plain[preset];
    for (int i = 0; i < t->parameter_count; i++) assert_true(plain[i] == all[chosen][i]);
    for (int a = 0; a < CHOICES; a++)
      for (int b = 0; b < a; b++) {
        int differ = 0;
        for (int i = 0; i < t->parameter_count; i++) differ += i != preset && all[a][i] != all[b][i];
        bool same = !strcmp(names[n], "smoothies") && a == 2 && b == 1; /* good has all there is */
        assert_true(same || differ > 0);
      }
  }
}

/* The papers' own values, each as its text has it. */
static void test_paper(void **state) {
  (void)state;
  static const char *const papers[][2] = {
      {"bitmask:preset=paper", "bitmask:samples=16j,primitive=quad,maps=front,hierarchy=mssm,merge=0,cap=18,edges=off,"
                               "smooth=5,pass=paper"},
      {"backprojection:preset=paper", "backprojection:primitive=patch,gaps=on,layers=1,hierarchy=hsm,merge=0,cap=18,"
                                      "edges=off"},
      {"ssm:preset=paper", "ssm:sides=both,faces=culled,accumulate=fp16,extents=cpu,merge=0,size=0,layers=1"},
      {"smoothies:preset=paper", "smoothies:geometry=edges,width=0.05,receiver=map,remap=on,filter=off"}};
  for (int i = 0; i < 4; i++) {
    double preset[PNI_PARAMETERS_MAX], named[PNI_PARAMETERS_MAX];
    const pn_technique *t = parse(papers[i][0], preset);
    parse(papers[i][1], named);
    for (int k = 0; k < t->parameter_count; k++)
      if (strcmp(t->parameters[k].name, "preset") != 0 && preset[k] != named[k])
        fail_msg("%s: %s is %g", papers[i][0], t->parameters[k].name, preset[k]);
  }
}

/* The same through pn_light_parameter: a preset sets the rest, a later value goes over it, and nothing it refuses
 * changes anything. */
static void test_light_parameter(void **state) {
  (void)state;
  stage s;
  stage_open(&s);
  for (int n = 0; n < SEARCHING; n++)
    for (int from = 0; from < CHOICES; from++)
      for (int to = 0; to < CHOICES; to++) {
        char spec[64];
        double want[PNI_PARAMETERS_MAX];
        snprintf(spec, sizeof spec, "%s:preset=%s,merge=7,layers=3", names[n], choices[from]);
        assert_ok(pn_light_technique(s.light, spec, NULL, 0));
        assert_ok(pn_light_parameter(s.light, "preset", to));
        snprintf(spec, sizeof spec, "%s:preset=%s", names[n], choices[to]);
        const pn_technique *t = parse(spec, want);
        for (int i = 0; i < t->parameter_count; i++) assert_true(s.light->values[i] == want[i]);
        assert_ok(pn_light_parameter(s.light, "merge", 3));
        want[index_of(t, "merge")] = 3;
        static const struct {
          const char *name;
          double value;
        } wrong[] = {{"preset", CHOICES}, {"preset", -1}, {"preset", 0.5}, {"merge", -1}, {"merge", NAN},
                     {"merge", 51},       {"cap", 1.5},   {"cap", 4097},   {"layers", 0}, {"layers", 17}};
        for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
          assert_int_equal(pn_light_parameter(s.light, wrong[i].name, wrong[i].value), PN_ERROR_ARGUMENT);
        for (int i = 0; i < t->parameter_count; i++) assert_true(s.light->values[i] == want[i]);
      }
  stage_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_order), cmocka_unit_test(test_default),
                                     cmocka_unit_test(test_paper), cmocka_unit_test(test_light_parameter)};
  return GL_RUN("presets", tests);
}
