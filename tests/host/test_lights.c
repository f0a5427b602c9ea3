/* Two lights and two views: a result belongs to its pair. A sun. The closed form of a box's shadow. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "agreement.h"
#include "host.h"
#include "truth.h"

enum { PIXELS = CAMERA_WIDTH * CAMERA_HEIGHT };

static camera second_camera(void) { return camera_from(v3(-3.2, 1.8, 3.4), v3(0, 0.4, 0)); }

/* 2 x 2 results, drawn interleaved and read at the end, are those of a context with one pair only, to the bit. */
static void test_pairs(void **state) {
  host *h = *state;
  pn_light_desc descs[2] = {host_light_desc(), host_light_desc_other()};
  camera views[2] = {camera_at(1), second_camera()};
  camera_view v[2];
  pn_light *lights[2];
  float *alone[2][2];
  assert_int_equal(host_cast(h, CAST_MEMORY), PN_OK);
  for (int i = 0; i < 2; i++) assert_int_equal(host_view(h, &views[i], &v[i]), PN_OK);
  for (int l = 0; l < 2; l++) {
    for (int r = 0; r < 2; r++) {
      pn_light *light = NULL;
      assert_int_equal(host_light(h, &descs[l], l ? "pcf" : "pcss", &light), PN_OK);
      alone[l][r] = host_visibility(h, light, &v[r]);
      assert_non_null(alone[l][r]);
      assert_true(dark_pixels(alone[l][r], CAMERA_WIDTH, CAMERA_HEIGHT) > 100);
      pn_light_destroy(&light);
    }
    assert_int_equal(host_light(h, &descs[l], l ? "pcf" : "pcss", &lights[l]), PN_OK);
  }
  for (int l = 0; l < 2; l++) assert_int_equal(pn_maps_update(lights[l], h->casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
  for (int k = 0; k < 4; k++) assert_int_equal(pn_visibility(lights[(k ^ (k >> 1)) & 1], v[k >> 1].receiver), PN_OK);
  for (int l = 0; l < 2; l++) {
    for (int r = 0; r < 2; r++) {
      float *both = host_result(lights[l], v[r].receiver);
      assert_non_null(both);
      assert_memory_equal(both, alone[l][r], PIXELS * sizeof *both);
      free(both);
    }
  }
  assert_memory_not_equal(alone[0][0], alone[1][0], PIXELS * sizeof(float));
  assert_memory_not_equal(alone[0][0], alone[0][1], PIXELS * sizeof(float));
  for (int k = 0; k < 4; k++) free(alone[k / 2][k % 2]);
  for (int i = 0; i < 2; i++) pn_light_destroy(&lights[i]), host_view_close(&v[i]);
  host_uncast(h);
}

/* Destroying one receiver or light leaves the other pairs' results alone. */
static void test_lifetimes(void **state) {
  host *h = *state;
  pn_light_desc descs[2] = {host_light_desc(), host_light_desc_other()};
  camera views[2] = {camera_at(0), second_camera()};
  camera_view v[2];
  pn_light *lights[2];
  assert_int_equal(host_cast(h, CAST_MEMORY), PN_OK);
  for (int i = 0; i < 2; i++) {
    assert_int_equal(host_view(h, &views[i], &v[i]), PN_OK);
    assert_int_equal(host_light(h, &descs[i], "pcf", &lights[i]), PN_OK);
  }
  float *kept = host_visibility(h, lights[1], &v[1]);
  free(host_visibility(h, lights[0], &v[0]));
  free(host_visibility(h, lights[1], &v[0]));
  pn_receiver_destroy(&v[0].receiver);
  assert_null(v[0].receiver);
  pn_light_destroy(&lights[0]);
  assert_null(lights[0]);
  float *still = host_result(lights[1], v[1].receiver);
  assert_non_null(kept);
  assert_non_null(still);
  assert_memory_equal(kept, still, PIXELS * sizeof *kept);
  free(kept), free(still);
  pn_light_destroy(&lights[1]);
  for (int i = 0; i < 2; i++) host_view_close(&v[i]);
  host_uncast(h);
}

/* hard against rays for a light, as in test_cameras.c. */
static void check_light(host *h, const pn_light_desc *desc, const camera *view, const char *name) {
  camera_view v;
  surfaces seen;
  pn_light *light = NULL;
  pn_maps_info maps;
  assert_int_equal(host_view(h, view, &v), PN_OK);
  assert_int_equal(host_light(h, desc, "hard", &light), PN_OK);
  assert_true(surfaces_draw(&seen, &h->draw, &h->world, view));
  float *image = host_visibility(h, light, &v);
  assert_non_null(image);
  save_picture(name, image, seen.width, seen.height);
  assert_int_equal(pn_light_maps(light, &maps), PN_OK);
  truth_light truth = truth_light_of(desc, &maps);
  int known = 0, tried = 0, wrong = 0, dark = 0;
  for (int i = 0; i < PIXELS; i += 7) {
    if (seen.position[4 * i + 3] < 0 || !truth_plane_known(&seen, i % seen.width, i / seen.width)) continue;
    tried++;
    int answer = truth_hard(&truth, &h->world, v3_of(seen.position + 4 * i), v3_of(seen.normal + 3 * i), 0.75);
    if (answer == TRUTH_EITHER) continue;
    known++;
    dark += answer == TRUTH_BLOCKED;
    if (image[i] == (answer == TRUTH_BLOCKED ? 0 : 1)) continue;
    if (wrong++ < 8) {
      fprintf(stderr, "%s: pixel %d,%d of %s: %g, rays say %d\n", name, i % seen.width, i / seen.width,
              h->world.meshes[(int)seen.position[4 * i + 3]].name, image[i], answer);
    }
  }
  assert_true(known > 0.6 * tried);
  assert_true(dark > 100);
  assert_int_equal(wrong, 0);
  free(image);
  surfaces_free(&seen);
  pn_light_destroy(&light);
  host_view_close(&v);
}

static void test_other_light(void **state) {
  host *h = *state;
  pn_light_desc desc = host_light_desc_other();
  camera view = second_camera();
  assert_int_equal(host_cast(h, CAST_MEMORY), PN_OK);
  check_light(h, &desc, &view, "light-other");
  host_uncast(h);
}

static void test_sun(void **state) {
  host *h = *state;
  pn_light_desc desc = host_sun_desc();
  camera view = camera_at(0);
  assert_int_equal(host_cast(h, CAST_MEMORY), PN_OK);
  check_light(h, &desc, &view, "light-sun");
  host_uncast(h);
}

/* A slab parallel to a floor, a light's centre straight above: the hard shadow is the slab's rectangle scaled by the
 * distances. The map is given, so a texel's size on the floor is known: pixels further than that from the border are
 * exact. */
static void test_box_shadow(void **state) {
  host *h = *state;
  enum { LIGHT_HEIGHT = 4 };
  const double half_x = 0.7, half_z = 0.4, low = 0.95, high = 1.05;
  mesh slab;
  mesh_box(&slab, "slab", v3(half_x, (high - low) / 2, half_z));
  mat4 at = translation(0.2, (low + high) / 2, -0.1);
  to_float(&at, slab.place);
  mesh_pose(&slab, 0);
  pn_light_desc desc = {
      .center = {0.2f, LIGHT_HEIGHT, -0.1f}, .direction = {0, -1, 0}, .half_u = 0.2f, .half_v = 0.2f, .map_width = 256};
  pn_mesh_desc mesh_desc = {.positions = {.data = slab.posed, .count = (size_t)slab.vertex_count},
                            .indices = {.data = slab.indices, .count = (size_t)slab.index_count},
                            .index_bytes = 4};
  pn_mesh m;
  pn_instance instance;
  pn_light *light = NULL;
  camera_view v;
  surfaces seen;
  pn_maps_info maps;
  camera view = camera_from(v3(0, 5, 4), v3(0, 0, 0));
  assert_int_equal(pn_casters_create(h->context, &h->casters), PN_OK);
  assert_int_equal(pn_mesh_add(h->casters, &mesh_desc, &m), PN_OK);
  assert_int_equal(pn_instance_add(h->casters, m, slab.place, 0, &instance), PN_OK);
  assert_int_equal(host_view(h, &view, &v), PN_OK);
  assert_int_equal(host_light(h, &desc, "hard", &light), PN_OK);
  assert_true(surfaces_draw(&seen, &h->draw, &h->world, &view));
  float *image = host_visibility(h, light, &v);
  assert_non_null(image);
  save_picture("box-shadow", image, seen.width, seen.height);
  assert_int_equal(pn_light_maps(light, &maps), PN_OK);
  /* The upper face casts the wider shadow: it is nearer to the light. */
  double scale = LIGHT_HEIGHT / (LIGHT_HEIGHT - high), x = half_x * scale, z = half_z * scale;
  double texel = fmax(maps.s1 - maps.s0, maps.t1 - maps.t0) / 256 * LIGHT_HEIGHT;
  int inside = 0, outside = 0;
  for (int i = 0; i < PIXELS; i++) {
    const float *p = seen.position + 4 * i;
    if (p[3] != SCENE_FLOOR || !truth_plane_known(&seen, i % seen.width, i / seen.width)) continue;
    double edge = fmax(fabs(p[0] - 0.2) - x, fabs(p[2] + 0.1) - z);
    if (fabs(edge) < texel) continue;
    assert_true(image[i] == (edge < 0 ? 0 : 1));
    inside += edge<0, outside += edge> 0;
  }
  printf("texel %.3g; %d pixels inside, %d outside\n", texel, inside, outside);
  assert_true(inside > 1000 && outside > 10000);
  free(image);
  mesh_free(&slab);
  surfaces_free(&seen);
  pn_light_destroy(&light);
  host_view_close(&v);
  host_uncast(h);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_pairs, host_check),       cmocka_unit_test_teardown(test_lifetimes, host_check),
      cmocka_unit_test_teardown(test_other_light, host_check), cmocka_unit_test_teardown(test_sun, host_check),
      cmocka_unit_test_teardown(test_box_shadow, host_check),
  };
  return cmocka_run_group_tests_name("lights", tests, host_setup, host_teardown);
}
