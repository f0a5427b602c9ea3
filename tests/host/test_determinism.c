/* The same input gives the same bits; and a still caster's shadow does not change by a bit when another one moves. */
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

/* What is tested beside each technique of the list as it comes, and in the place of one that would take its time. */
static const char *const specs[] = {"pcf:filter=bicubic", "average:samples=16"};
enum { SPECS = sizeof specs / sizeof *specs, TECHNIQUES_MOST = 32 };

/* All of them: how many there are. */
static int techniques(const char *out[TECHNIQUES_MOST]) {
  int count = 0;
  for (int i = 0; i < SPECS; i++) out[count++] = specs[i];
  for (int i = 0; i < pn_technique_count(); i++) {
    const char *name = pn_technique_at(i)->name;
    if (!strcmp(name, "average")) continue;
    assert_true(count < TECHNIQUES_MOST);
    out[count++] = name;
  }
  return count;
}

/* The scene, cast from memory, and its receiver. */
static void open_scene(host *h, camera_view *v) {
  camera view = camera_at(0);
  assert_int_equal(host_view(h, &view, v), PN_OK);
  assert_int_equal(host_cast(h, CAST_MEMORY), PN_OK);
}

static pn_light *light_with(host *h, const char *spec) {
  pn_light_desc desc = host_light_desc();
  pn_light *light = NULL;
  assert_int_equal(host_light(h, &desc, spec, &light), PN_OK);
  return light;
}

/* Again in the same context, and again in a new one. */
static void test_twice(void **state) {
  host *h = *state;
  camera_view v;
  const char *all[TECHNIQUES_MOST];
  float *first[TECHNIQUES_MOST];
  int count = techniques(all);
  for (int pass = 0; pass < 3; pass++) {
    if (pass == 2) {
      pn_context_destroy(&h->context);
      assert_int_equal(host_context(h), PN_OK);
    }
    open_scene(h, &v);
    for (int i = 0; i < count; i++) {
      pn_light *light = light_with(h, all[i]);
      float *image = host_visibility(h, light, &v);
      assert_non_null(image);
      if (pass == 0) {
        first[i] = image;
        continue;
      }
      assert_memory_equal(image, first[i], PIXELS * sizeof *image);
      free(image);
      if (pass == 2) free(first[i]);
      pn_light_destroy(&light);
    }
    host_uncast(h);
    host_view_close(&v);
  }
}

typedef struct {
  float *image;
  pn_maps_info maps;
} shot;

static shot shoot(host *h, pn_light *light, const camera_view *v, pn_instance moving, double x) {
  float place[16];
  memcpy(place, h->world.meshes[SCENE_SLAB].place, sizeof place);
  place[12] = (float)x, place[14] = -0.2f;
  assert_int_equal(pn_instance_move(h->casters, moving, place), PN_OK);
  shot out = {.image = host_visibility(h, light, v)};
  assert_non_null(out.image);
  assert_int_equal(pn_light_maps(light, &out.maps), PN_OK);
  return out;
}

static int same_maps(const pn_maps_info *a, const pn_maps_info *b) {
  return a->s0 == b->s0 && a->t0 == b->t0 && a->s1 == b->s1 && a->t1 == b->t1 && a->w_near == b->w_near &&
         a->w_far == b->w_far;
}

/* The slab moves between the flag and the box, well inside what the others span. What changes lies in its shadow: left
 * and right of that, in the picture, everything stays. */
static void test_still_caster(void **state) {
  host *h = *state;
  camera_view v;
  const char *all[TECHNIQUES_MOST];
  int moved_something = 0, count = techniques(all);
  open_scene(h, &v);
  for (int i = 0; i < count; i++) {
    pn_light *light = light_with(h, all[i]);
    shot still = shoot(h, light, &v, h->instances[SCENE_SLAB], -0.3);
    for (int step = 1; step <= 4; step++) {
      shot next = shoot(h, light, &v, h->instances[SCENE_SLAB], -0.3 + 0.0173 * step);
      /* The box stands at x = 1.2: right of column 200 there is only its shadow, and left of column 100 only the
       * flag's. */
      assert_true(same_maps(&still.maps, &next.maps));
      int differ = 0;
      for (int p = 0; p < PIXELS; p++) {
        int same = memcmp(&still.image[p], &next.image[p], sizeof(float)) == 0;
        moved_something += !same;
        differ += !same && (p % CAMERA_WIDTH < 80 || p % CAMERA_WIDTH > 230);
      }
      assert_int_equal(differ, 0);
      free(next.image);
    }
    free(still.image);
    pn_light_destroy(&light);
  }
  assert_true(moved_something > 100);
  host_uncast(h);
  host_view_close(&v);
}

/* Even when the mover sets the bounds: a box that rises little by little changes them a few times, not at every
 * step. */
static void test_bounds_snap(void **state) {
  enum { SMALL_STEPS = 60 };
  host *h = *state;
  pn_maps_info last = {0}, now;
  int changes = 0;
  assert_int_equal(host_cast(h, CAST_MEMORY), PN_OK);
  pn_light *light = light_with(h, "hard");
  for (int step = 0; step <= SMALL_STEPS; step++) {
    float place[16];
    memcpy(place, h->world.meshes[SCENE_BOX].place, sizeof place);
    place[12] += 0.001f * (float)step;
    assert_int_equal(pn_instance_move(h->casters, h->instances[SCENE_BOX], place), PN_OK);
    assert_int_equal(pn_maps_update(light, h->casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
    assert_int_equal(pn_light_maps(light, &now), PN_OK);
    changes += step > 0 && !same_maps(&last, &now);
    last = now;
  }
  printf("%d of %d small moves changed the map's bounds\n", changes, SMALL_STEPS);
  assert_true(changes < SMALL_STEPS / 4);
  pn_light_destroy(&light);
  host_uncast(h);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_twice, host_check),
      cmocka_unit_test_teardown(test_still_caster, host_check),
      cmocka_unit_test_teardown(test_bounds_snap, host_check),
  };
  return cmocka_run_group_tests_name("determinism", tests, host_setup, host_teardown);
}
