/* Which changes make maps stale: what was drawn or made with the old values has to be again, what is only read need
 * not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "agreement.h"
#include "host.h"

enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT };

static host h;
static camera_view v;

static pn_light *light_with(const char *spec) {
  pn_light_desc desc = host_light_desc();
  pn_light *light = NULL;
  desc.map_width = 64;
  assert_int_equal(host_light(&h, &desc, spec, &light), PN_OK);
  return light;
}

typedef struct {
  const char *before, *name;
  double value;
  int stale;
  const char *after; /* the spec that comes to the same */
} change;

/* A choice by its index. */
static const change changes[] = {
    {"smoothies", "geometry", 0, 1, "smoothies:geometry=edges"},
    {"smoothies", "width", 0.2, 1, "smoothies:width=0.2"},
    {"smoothies", "filter", 0, 0, "smoothies:filter=off"},
    {"smoothies", "geometry", 1, 0, "smoothies"}, /* as it is */
    {"bitmask", "samples", 1, 0, "bitmask:samples=8"},
    {"bitmask", "cap", 5, 0, "bitmask:cap=5"},
    {"bitmask", "edges", 0, 0, "bitmask:edges=off"},
    {"bitmask", "merge", 6, 0, "bitmask:merge=6"},
    {"bitmask", "maps", 0, 1, "bitmask:maps=front"},
    {"bitmask:maps=layers", "layers", 4, 1, "bitmask:maps=layers,layers=4"},
    {"bitmask:maps=layers", "focus", 40, 1, "bitmask:maps=layers,focus=40"},
    {"bitmask", "primitive", 0, 1, "bitmask:primitive=patch"}, /* quads take more of the range */
    {"bitmask", "merge", 0, 1, "bitmask:merge=0"},             /* another kind of range */
    {"backprojection", "layers", 2, 1, "backprojection:layers=2"},
    {"backprojection", "gaps", 0, 0, "backprojection:gaps=off"},
    {"pcf", "taps", 9, 0, "pcf:taps=9"},
    {"pcf", "filter", 1, 0, "pcf:filter=bicubic"},
    {"pcss", "samples", 5, 0, "pcss:samples=5"},
    {"ssm", "sides", 1, 1, "ssm:sides=front"},
    {"ssm", "faces", 1, 1, "ssm:faces=culled"},
    {"ssm", "layers", 2, 0, "ssm:layers=2"},
    {"ssm", "merge", 1, 0, "ssm:merge=1"},
    {"ssm", "accumulate", 1, 0, "ssm:accumulate=fp16-batched"},
    {"ssm", "accumulate", 3, 0, "ssm:accumulate=fp16-consecutive"},
    {"average:samples=20", "samples", 40, 1, "average:samples=40"},
};

/* Refused until the maps are drawn again where they are stale; right at once where they are not, as with a new light.
 * */
static void check_change(const change *c) {
  pn_light *light = light_with(c->before), *fresh = light_with(c->after);
  pn_maps_info maps;
  free(host_visibility(&h, light, &v));
  assert_int_equal(pn_light_parameter(light, c->name, c->value), PN_OK);
  pn_result result = pn_visibility(light, v.receiver);
  if (result != (c->stale ? PN_ERROR_NOT_READY : PN_OK))
    fail_msg("%s, then %s=%g: %s", c->before, c->name, c->value, pn_result_name(result));
  assert_int_equal(pn_light_maps(light, &maps), result);
  if (c->stale) assert_int_equal(pn_maps_update(light, h.casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
  assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
  float *changed = host_result(light, v.receiver), *expected = host_visibility(&h, fresh, &v);
  assert_true(dark_pixels(expected, WIDTH, HEIGHT) > 100);
  if (memcmp(changed, expected, PIXELS * sizeof *changed) != 0)
    fail_msg("%s, then %s=%g, is not %s", c->before, c->name, c->value, c->after);
  free(changed), free(expected);
  pn_light_destroy(&light);
  pn_light_destroy(&fresh);
}

static void test_parameters(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) check_change(&changes[i]);
}

/* A value that is refused changes nothing. */
static void test_refused(void **state) {
  (void)state;
  pn_light *light = light_with("smoothies");
  float *before = host_visibility(&h, light, &v);
  assert_int_equal(pn_light_parameter(light, "geometry", 7), PN_ERROR_ARGUMENT);
  assert_int_equal(pn_light_parameter(light, "width", -1), PN_ERROR_ARGUMENT);
  assert_int_equal(pn_light_parameter(light, "layers", 1), PN_ERROR_ARGUMENT);
  assert_int_equal(pn_light_technique(light, "smoothies:width=-1", NULL, 0), PN_ERROR_ARGUMENT);
  assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
  float *after = host_result(light, v.receiver);
  assert_memory_equal(before, after, PIXELS * sizeof *before);
  free(before), free(after);
  pn_light_destroy(&light);
}

/* The light itself: any change of it does, the same description does not. */
static void test_light(void **state) {
  (void)state;
  pn_light *light = light_with("pcss");
  pn_light_desc desc = host_light_desc();
  desc.map_width = 64;
  free(host_visibility(&h, light, &v));
  assert_int_equal(pn_light_set(light, &desc), PN_OK);
  assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
  assert_int_equal(pn_light_technique(light, "pcss:samples=8", NULL, 0), PN_OK); /* as it is */
  assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
  desc.half_u *= 1.5f;
  assert_int_equal(pn_light_set(light, &desc), PN_OK);
  assert_int_equal(pn_visibility(light, v.receiver), PN_ERROR_NOT_READY);
  free(host_visibility(&h, light, &v));
  assert_int_equal(pn_light_technique(light, "pcss:samples=9", NULL, 0), PN_OK);
  assert_int_equal(pn_visibility(light, v.receiver), PN_ERROR_NOT_READY);
  pn_light_destroy(&light);
}

/* An update that fails before it draws leaves the maps of the last one, and where they lie. */
static void test_failed_update(void **state) {
  (void)state;
  pn_light_desc desc = host_light_desc();
  pn_light *light = NULL;
  pn_receiver *unset = NULL, *seen[] = {v.receiver, NULL};
  pn_maps_info first, then;
  desc.map_width = 64;
  desc.fit = PN_FIT_VISIBLE;
  assert_int_equal(host_light(&h, &desc, "bitmask", &light), PN_OK);
  assert_int_equal(pn_receiver_create(h.context, &unset), PN_OK);
  seen[1] = unset;
  assert_int_equal(pn_maps_update(light, h.casters, PN_GROUPS_ALL, seen, 1), PN_OK);
  assert_int_equal(pn_light_maps(light, &first), PN_OK);
  assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
  float *before = host_result(light, v.receiver);
  assert_int_equal(pn_maps_update(light, h.casters, 2, seen, 2), PN_ERROR_NOT_READY);
  assert_int_equal(pn_light_maps(light, &then), PN_OK);
  assert_memory_equal(&first.s0, &then.s0, 6 * sizeof first.s0); /* s0 to w_far */
  assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
  float *after = host_result(light, v.receiver);
  assert_memory_equal(before, after, PIXELS * sizeof *before);
  assert_true(dark_pixels(after, WIDTH, HEIGHT) > 100);
  free(before), free(after);
  pn_receiver_destroy(&unset);
  pn_light_destroy(&light);
}

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  camera view = camera_sized(0, WIDTH, HEIGHT);
  if (host_context(&h) != PN_OK || host_cast(&h, CAST_MEMORY) != PN_OK) return -1;
  return host_view(&h, &view, &v) != PN_OK;
}

static int teardown(void **state) {
  (void)state;
  host_uncast(&h);
  host_view_close(&v);
  host_close(&h);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_parameters, host_check),
      cmocka_unit_test_teardown(test_refused, host_check),
      cmocka_unit_test_teardown(test_light, host_check),
      cmocka_unit_test_teardown(test_failed_update, host_check),
  };
  return cmocka_run_group_tests_name("stale", tests, setup, teardown);
}
