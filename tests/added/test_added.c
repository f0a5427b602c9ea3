/* A technique that was added by a folder and a line is listed, explained, parsed and drawn like the others. */
#include <stdlib.h>
#include <string.h>

#include "over_ground.h"

enum { SIZE = 24 };

static void test_listed(void **state) {
  (void)state;
  const pn_technique *flat = pn_technique_find("flat");
  assert_non_null(flat);
  assert_ptr_equal(pn_technique_at(pn_technique_count() - 2), flat);
  assert_null(pn_technique_at(pn_technique_count()));
  assert_string_equal(flat->title, "flat shadow");
  assert_int_equal(flat->parameter_count, 1);
  assert_string_equal(flat->parameters[0].help, "visibility where the light's centre is hidden");
  assert_non_null(pn_technique_find(PN_TECHNIQUE_DEFAULT));
}

static void test_parsed(void **state) {
  (void)state;
  const pn_technique *technique = NULL;
  double value = -1;
  char why[256];
  assert_ok(pn_technique_parse("flat", &technique, &value, why, sizeof why));
  assert_ptr_equal(technique, pn_technique_find("flat"));
  assert_true(value == 0.25);
  assert_ok(pn_technique_parse("flat:level=0.5", &technique, &value, why, sizeof why));
  assert_true(value == 0.5);
  assert_int_equal(pn_technique_parse("flat:level=2", NULL, NULL, why, sizeof why), PN_ERROR_ARGUMENT);
  assert_string_equal(why, "technique flat: level=2 is no value; it takes a number from 0 to 1");
  assert_int_equal(pn_technique_parse("flat:lever=1", NULL, NULL, why, sizeof why), PN_ERROR_ARGUMENT);
  assert_string_equal(why, "technique flat: parameter 'lever' is unknown; it has level");
  assert_int_equal(pn_technique_parse("flatter", NULL, NULL, why, sizeof why), PN_ERROR_ARGUMENT);
  assert_non_null(strstr(why, ", flat"));
}

/* Under a square of half width 1 at half the light's height the shadow of the light's centre reaches from -2 to 2. */
static void check_flat(over_ground *c, const char *spec, float level) {
  pn_light_desc light = light_over_ground(0.3, 0.3, 64);
  float *image = stage_visibility(&c->s, &light, spec);
  assert_true(image[SIZE / 2 * SIZE + SIZE / 2] == level);
  assert_true(image[0] == 1);
  assert_true(image[SIZE * SIZE - 1] == 1);
  int dark = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    assert_true(image[i] == level || image[i] == 1);
    dark += image[i] == level;
  }
  /* 16 of the 36 square units seen; a row of pixels may go either way on each side. */
  assert_in_range(dark, (SIZE * 2 / 3 - 2) * (SIZE * 2 / 3 - 2), (SIZE * 2 / 3 + 2) * (SIZE * 2 / 3 + 2));
  free(image);
}

static void test_drawn(void **state) {
  (void)state;
  over_ground c = {0};
  soup_patch(&c.casters, v3(0, LIGHT_HEIGHT / 2, 0), v3(1, 0, 0), v3(0, 0, 1));
  over_ground_open(&c, SIZE, 3);
  check_flat(&c, "flat", 0.25f);
  check_flat(&c, "flat:level=0.5", 0.5f);
  assert_ok(pn_light_parameter(c.s.light, "level", 0.75));
  float *image = stage_look(&c.s);
  assert_true(image[SIZE / 2 * SIZE + SIZE / 2] == 0.75f);
  free(image);
  over_ground_close(&c);
}

/* Each parameter is read from its own place: the last of twenty is what its name says, whatever the others are. */
static void test_many(void **state) {
  (void)state;
  over_ground c = {0};
  soup_patch(&c.casters, v3(0, LIGHT_HEIGHT / 2, 0), v3(1, 0, 0), v3(0, 0, 1));
  over_ground_open(&c, SIZE, 3);
  pn_light_desc light = light_over_ground(0.3, 0.3, 64);
  float *image = stage_visibility(&c.s, &light, "many:nineteenth=0.125,twentieth=0.75,first=0");
  for (int i = 0; i < SIZE * SIZE; i++) assert_true(image[i] == 0.75f);
  free(image);
  assert_ok(pn_light_parameter(c.s.light, "twentieth", 0.25));
  image = stage_look(&c.s);
  for (int i = 0; i < SIZE * SIZE; i++) assert_true(image[i] == 0.25f);
  free(image);
  assert_int_equal(pn_technique_find("many")->parameter_count, 20);
  assert_non_null(pn_glsl(c.s.context, "many", 330, 0));
  over_ground_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_listed),
      cmocka_unit_test(test_parsed),
      cmocka_unit_test(test_drawn),
      cmocka_unit_test(test_many),
  };
  return GL_RUN("added", tests);
}
