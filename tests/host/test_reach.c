/* Casters that a light does not reach cast nothing: those wholly beyond its range, and those behind everything that is
 * seen, whose depth must not be clamped into the map. However they are drawn, the picture is the one without them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "host.h"

enum { PIXELS = CAMERA_WIDTH * CAMERA_HEIGHT };

static host *h;

/* A plate in a scene's coordinates, around (x, y, z). */
static pn_mesh_desc plate_desc(float positions[18], float x, float y, float z, float half) {
  static const float corners[6][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}};
  for (int i = 0; i < 6; i++) {
    positions[3 * i] = x + half * corners[i][0];
    positions[3 * i + 1] = y;
    positions[3 * i + 2] = z + half * corners[i][1];
  }
  return (pn_mesh_desc){.positions = {.data = positions, .count = 6}};
}

static pn_result add_plate(float x, float y, float z, float half) {
  static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  float positions[18];
  pn_mesh added;
  pn_mesh_desc desc = plate_desc(positions, x, y, z, half);
  pn_result result = pn_mesh_add(h->casters, &desc, &added);
  return result == PN_OK ? pn_instance_add(h->casters, added, identity, 1, NULL) : result;
}

/* The plate is in group 1: with it and without it. */
static float *picture(const lit_view *lit, uint32_t groups, int look) {
  pn_receiver *const visible[1] = {lit->v.receiver};
  if (pn_maps_update(lit->light, h->casters, groups, visible, look) != PN_OK) return NULL;
  if (pn_visibility(lit->light, lit->v.receiver) != PN_OK) return NULL;
  return host_result(lit->light, lit->v.receiver);
}

static int differing(const float *a, const float *b) {
  int count = 0;
  for (int i = 0; i < PIXELS; i++) count += memcmp(&a[i], &b[i], sizeof *a) != 0;
  return count;
}

static void check(const pn_light_desc *desc, int look, float x, float y, float z, float half, float range) {
  for (int i = 0; host_spec(i); i++) {
    lit_view lit;
    pn_light_desc d = *desc;
    d.map_width = 64;
    d.range = range;
    assert_int_equal(host_lit_view(h, CAST_MEMORY, &d, host_spec(i), &lit), PN_OK);
    assert_int_equal(add_plate(x, y, z, half), PN_OK);
    float *without = picture(&lit, 1, look), *with = picture(&lit, 3, look);
    assert_non_null(without);
    assert_non_null(with);
    if (differing(without, with))
      fail_msg("%s: %d pixels know of a caster out of reach", host_spec(i), differing(without, with));
    free(without), free(with);
    host_lit_view_close(h, &lit);
  }
}

/* Below the floor, and farther from the light than it reaches. */
static void test_range(void **state) {
  h = *state;
  pn_light_desc desc = host_light_desc();
  check(&desc, 0, 0, -8, 0, 4, 7);
}

/* What is seen lies before it. */
static void test_behind(void **state) {
  h = *state;
  pn_light_desc desc = host_light_desc(), sun = host_sun_desc();
  desc.fit = sun.fit = PN_FIT_VISIBLE;
  check(&desc, 1, 0, -12, 0, 4, 0);
  check(&sun, 1, 0, -12, 0, 4, 0);
}

/* Where the maps lie is told in numbers, however huge the casters are. */
static void test_huge(void **state) {
  static const float halves[] = {1e-30f, 1, 1e10f, 1e20f, 1e30f, 1.5e38f}, scales[] = {1e-20f, 1, 1e10f, 1e30f};
  h = *state;
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < 6; i++)
      for (int j = 0; j < 4; j++) {
        pn_light_desc d = k ? host_sun_desc() : host_light_desc();
        pn_light *light;
        pn_maps_info m;
        pn_mesh added;
        float positions[18], place[16] = {scales[j], 0, 0, 0, 0, scales[j], 0, 0, 0, 0, scales[j], 0, 0, 0, 0, 1};
        pn_mesh_desc plate = plate_desc(positions, 0, halves[i] / 2, 0, halves[i]);
        assert_int_equal(pn_casters_create(h->context, &h->casters), PN_OK);
        assert_int_equal(pn_mesh_add(h->casters, &plate, &added), PN_OK);
        assert_int_equal(pn_instance_add(h->casters, added, place, 0, NULL), PN_OK);
        assert_int_equal(host_light(h, &d, "hard", &light), PN_OK);
        assert_int_equal(pn_maps_update(light, h->casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
        assert_int_equal(pn_light_maps(light, &m), PN_OK);
        const float numbers[6] = {m.s0, m.t0, m.s1, m.t1, m.w_near, m.w_far};
        for (int n = 0; n < 6; n++)
          if (!isfinite(numbers[n]))
            fail_msg("half %g, scale %g: number %d is %g", halves[i], scales[j], n, numbers[n]);
        if (!m.empty) assert_true(m.s0 < m.s1 && m.t0 < m.t1 && m.w_far <= m.w_near);
        pn_light_destroy(&light);
        host_uncast(h);
      }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_range, host_check),
      cmocka_unit_test_teardown(test_behind, host_check),
      cmocka_unit_test_teardown(test_huge, host_check),
  };
  return cmocka_run_group_tests_name("reach", tests, host_setup, host_teardown);
}
