/* What the library keeps with its objects: a technique's state goes with the technique, a pair's results with the light
 * and the receiver, and what is destroyed is never taken for what comes after it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "agreement.h"
#include "host.h"

enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT, SPECS_MOST = 40 };

/* ---- an allocator that hands out at once what was freed last ----------------------------------------------------- */

typedef struct block {
  size_t bytes;
  struct block *next; /* of those that are free */
} block;
static block *free_blocks;

static block *take_free(size_t bytes) {
  for (block **at = &free_blocks; *at; at = &(*at)->next)
    if ((*at)->bytes == bytes) {
      block *found = *at;
      *at = found->next;
      return found;
    }
  return NULL;
}

static void *allocate(void *user, void *old, size_t bytes) {
  (void)user;
  block *was = old ? (block *)old - 1 : NULL, *now = NULL;
  if (bytes) {
    now = take_free(bytes);
    if (!now) now = malloc(sizeof *now + bytes);
    if (!now) return NULL;
    now->bytes = bytes;
    if (was) memcpy(now + 1, was + 1, was->bytes < bytes ? was->bytes : bytes);
  }
  if (was) {
    was->next = free_blocks;
    free_blocks = was;
  }
  return now ? now + 1 : NULL;
}

static void free_all(void) {
  for (block *at; (at = free_blocks); free(at)) free_blocks = at->next;
}

/* ---- the scene --------------------------------------------------------------------------------------------------- */

static host h;
static camera_view v;

static pn_light *light_with(const char *spec) {
  pn_light_desc desc = host_light_desc();
  pn_light *light = NULL;
  desc.map_width = 64;
  assert_int_equal(host_light(&h, &desc, spec, &light), PN_OK);
  return light;
}

static int count_specs(void) {
  int count = 0;
  while (host_spec(count)) count++;
  assert_in_range(count, 10, SPECS_MOST);
  return count;
}

/* ---- techniques in turn ------------------------------------------------------------------------------------------ */

typedef struct {
  float *image;
  size_t memory; /* of the light, its maps and its result */
} kept;

static kept fresh(const char *spec) {
  size_t before = host_gpu_memory(&h);
  pn_light *light = light_with(spec);
  kept out = {.image = host_visibility(&h, light, &v)};
  assert_non_null(out.image);
  out.memory = host_gpu_memory(&h) - before;
  pn_light_destroy(&light);
  return out;
}

/* Of one technique with other parameters some images may stay for the next change. */
static int same_technique(const char *a, const char *b) {
  size_t length = strcspn(a, ":");
  return strcspn(b, ":") == length && strncmp(a, b, length) == 0;
}

static void check_turn(pn_light *light, const char *spec, const char *last, const kept *expected, size_t before) {
  assert_int_equal(pn_light_technique(light, spec, NULL, 0), PN_OK);
  float *image = host_visibility(&h, light, &v);
  assert_non_null(image);
  if (memcmp(image, expected->image, PIXELS * sizeof *image) != 0)
    fail_msg("%s after %s is not %s alone", spec, last, spec);
  size_t memory = host_gpu_memory(&h) - before;
  if (memory != expected->memory && !same_technique(spec, last))
    fail_msg("%s after %s holds %zu bytes in GL, alone %zu", spec, last, memory, expected->memory);
  free(image);
}

/* One light takes every technique after every other kind of it, forth and back: each time it is to the bit, and to the
 * byte, what a new light is. */
static void test_in_turn(void **state) {
  (void)state;
  kept alone[SPECS_MOST];
  int count = count_specs();
  for (int i = 0; i < count; i++)
    free(fresh(host_spec(i)).image); /* what receiver and meshes keep is there from now on */
  for (int i = 0; i < count; i++) alone[i] = fresh(host_spec(i));
  size_t before = host_gpu_memory(&h);
  pn_light *light = light_with("hard");
  const char *last = "nothing";
  for (int step = 0; step < 3; step++) { /* forth, back, and by threes */
    for (int k = 0; k < count; k++) {
      int i = step == 0 ? k : step == 1 ? count - 1 - k : 3 * k % count;
      check_turn(light, host_spec(i), last, &alone[i], before);
      last = host_spec(i);
    }
  }
  pn_light_destroy(&light);
  assert_int_equal(host_gpu_memory(&h), before);
  for (int i = 0; i < count; i++) free(alone[i].image);
}

/* Where nothing casts any more, nothing of the last technique is told as the new one's. */
static void test_nothing_after_something(void **state) {
  (void)state;
  for (int i = 0; host_spec(i); i++) {
    pn_light *light = light_with(host_spec(i));
    pn_soft_shadow_map map;
    free(host_visibility(&h, light, &v));
    assert_int_equal(pn_light_technique(light, "pcf", NULL, 0), PN_OK);
    assert_int_equal(pn_maps_update(light, h.casters, 0, NULL, 0), PN_OK);
    assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
    float *image = host_result(light, v.receiver);
    for (int p = 0; p < PIXELS; p++) assert_true(image[p] == 1);
    assert_int_equal(pn_soft_shadow_map_image(light, v.receiver, &map), PN_ERROR_NOT_READY);
    free(image);
    pn_light_destroy(&light);
  }
}

/* ---- pairs ------------------------------------------------------------------------------------------------------- */

/* A pair goes with its light and with its receiver, whichever goes first. */
static void test_pairs_go(void **state) {
  (void)state;
  for (int i = 0; host_spec(i); i++) {
    size_t before = host_gpu_memory(&h);
    pn_light *lights[2] = {light_with(host_spec(i)), light_with("hard")};
    camera view = camera_sized(1, WIDTH, HEIGHT);
    camera_view other;
    assert_int_equal(host_view(&h, &view, &other), PN_OK);
    float *kept_image = host_visibility(&h, lights[1], &v);
    size_t with_hard = host_gpu_memory(&h);
    free(host_visibility(&h, lights[0], &v));
    free(host_visibility(&h, lights[0], &other));
    free(host_visibility(&h, lights[1], &other));
    pn_receiver_destroy(&other.receiver);
    pn_light_destroy(&lights[0]);
    assert_int_equal(host_gpu_memory(&h), with_hard);
    float *still = host_result(lights[1], v.receiver);
    assert_memory_equal(still, kept_image, PIXELS * sizeof *still);
    free(still), free(kept_image);
    pn_light_destroy(&lights[1]);
    assert_int_equal(host_gpu_memory(&h), before);
    host_view_close(&other);
  }
}

/* ---- the same address again -------------------------------------------------------------------------------------- */

/* New casters where the old ones were: a light whose casters are gone does not draw them. */
static void test_casters_again(void **state) {
  (void)state;
  for (int i = 0; host_spec(i); i++) {
    pn_light *light = light_with(host_spec(i));
    int average = strncmp(host_spec(i), "average", 7) == 0;
    float *before = host_visibility(&h, light, &v);
    assert_true(dark_pixels(before, WIDTH, HEIGHT) > 100);
    uintptr_t address = (uintptr_t)h.casters;
    host_uncast(&h);
    assert_int_equal(pn_casters_create(h.context, &h.casters), PN_OK);
    assert_true((uintptr_t)h.casters == address); /* or this test shows nothing */
    pn_result result = pn_visibility(light, v.receiver);
    /* average draws its maps when it looks; the others' are there. What failed leaves the last result. */
    assert_int_equal(result, average ? PN_ERROR_NOT_READY : PN_OK);
    float *after = host_result(light, v.receiver);
    assert_non_null(after);
    assert_memory_equal(after, before, PIXELS * sizeof *after);
    free(after), free(before);
    pn_light_destroy(&light);
    host_uncast(&h);
    assert_int_equal(host_cast(&h, CAST_MEMORY), PN_OK);
  }
}

/* A new light, a new receiver where the old one was has no result yet. */
static void test_pairs_again(void **state) {
  (void)state;
  pn_image image;
  pn_light *light = light_with("pcss");
  uintptr_t address = (uintptr_t)light;
  free(host_visibility(&h, light, &v));
  pn_light_destroy(&light);
  light = light_with("pcss");
  assert_true((uintptr_t)light == address);
  assert_int_equal(pn_result_image(light, v.receiver, &image), PN_ERROR_NOT_READY);
  assert_int_equal(pn_visibility(light, v.receiver), PN_ERROR_NOT_READY); /* nor maps */
  free(host_visibility(&h, light, &v));
  address = (uintptr_t)v.receiver;
  pn_receiver_destroy(&v.receiver);
  pn_receiver_desc desc = host_receiver_desc(&v.view, &v.target);
  assert_int_equal(pn_receiver_create(h.context, &v.receiver), PN_OK);
  assert_true((uintptr_t)v.receiver == address);
  assert_int_equal(pn_result_image(light, v.receiver, &image), PN_ERROR_NOT_READY);
  assert_int_equal(pn_visibility(light, v.receiver), PN_ERROR_NOT_READY);
  assert_int_equal(pn_receiver_set(v.receiver, &desc), PN_OK);
  assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
  pn_light_destroy(&light);
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  pn_context_desc desc = host_context_desc(&h);
  desc.allocate = allocate;
  camera view = camera_sized(0, WIDTH, HEIGHT);
  if (pn_context_create(&desc, &h.context) != PN_OK) return -1;
  return host_cast(&h, CAST_MEMORY) != PN_OK || host_view(&h, &view, &v) != PN_OK;
}

static int teardown(void **state) {
  (void)state;
  host_uncast(&h);
  host_view_close(&v);
  size_t left = host_gpu_memory(&h);
  if (left) fprintf(stderr, "%zu bytes in GL are left although every object is gone\n", left);
  host_close(&h);
  free_all();
  return left != 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_in_turn, host_check),
      cmocka_unit_test_teardown(test_nothing_after_something, host_check),
      cmocka_unit_test_teardown(test_pairs_go, host_check),
      cmocka_unit_test_teardown(test_casters_again, host_check),
      cmocka_unit_test_teardown(test_pairs_again, host_check),
  };
  return cmocka_run_group_tests_name("kept", tests, setup, teardown);
}
