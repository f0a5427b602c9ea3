/* Every technique as the client sees it: flat faces that see the whole light are exactly 1, what the light's whole area
 * cannot see is dark, and no pixel sparkles. */
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

static host h;
static camera_view v;
static surfaces seen;

static int flat_object(int object) { return object == SCENE_FLOOR || object == SCENE_BOX || object == SCENE_SLAB; }

static int is_lit(const truth_light *light, int x, int y) {
  int i = y * CAMERA_WIDTH + x;
  return flat_object((int)seen.position[4 * i + 3]) && truth_plane_known(&seen, x, y) &&
         truth_sees_all(light, &h.world, v3_of(seen.position + 4 * i), v3_of(seen.normal + 3 * i));
}

/* What is scattered into a map is known at its texels, which here are about as far apart as the view's pixels: a pixel
 * next to a penumbra may have some of it. */
static int is_lit_around(const truth_light *light, int x, int y, int distance) {
  for (int dy = -distance; dy <= distance; dy++)
    for (int dx = -distance; dx <= distance; dx++) {
      int inside = x + dx >= 0 && x + dx < CAMERA_WIDTH && y + dy >= 0 && y + dy < CAMERA_HEIGHT;
      if (!inside || !is_lit(light, x + dx, y + dy)) return 0;
    }
  return 1;
}

static void check_lit(const char *spec, const truth_light *light, const float *image) {
  int distance = strcmp(spec, "ssm") == 0 ? 3 : 0;
  int lit = 0, wrong = 0;
  for (int i = 0; i < PIXELS; i += 7) {
    int x = i % CAMERA_WIDTH, y = i / CAMERA_WIDTH;
    if (!is_lit_around(light, x, y, distance)) continue;
    lit++;
    if (image[i] == 1) continue;
    if (wrong++ < 5) fprintf(stderr, "%s: lit pixel %d,%d: 1 - %g\n", spec, x, y, 1 - image[i]);
  }
  assert_true(lit > 1000);
  assert_int_equal(wrong, 0);
}

/* A pixel that is darker or brighter than all eight around it, although all nine show one flat face. */
static void check_sparkles(const char *spec, const float *image) {
  int lone = 0;
  for (int i = 0; i < PIXELS; i++) {
    int x = i % CAMERA_WIDTH, y = i / CAMERA_WIDTH, face = 1;
    if (!flat_object((int)seen.position[4 * i + 3]) || !truth_plane_known(&seen, x, y)) continue;
    float least = 2, most = -1;
    for (int k = 0; k < 9; k++) {
      int j = i + (k / 3 - 1) * CAMERA_WIDTH + k % 3 - 1;
      if (j == i) continue;
      face &= seen.position[4 * j + 3] == seen.position[4 * i + 3] &&
              dot(v3_of(seen.normal + 3 * i), v3_of(seen.normal + 3 * j)) > 0.999;
      least = fminf(least, image[j]), most = fmaxf(most, image[j]);
    }
    if (!face || (image[i] > least - 0.3f && image[i] < most + 0.3f)) continue;
    if (lone++ < 5) fprintf(stderr, "%s: pixel %d,%d: %g among %g to %g\n", spec, x, y, image[i], least, most);
  }
  assert_int_equal(lone, 0);
}

static void test_technique(void **state) {
  const char *spec = *state;
  const pn_technique *technique = NULL;
  pn_light_desc descs[2] = {host_light_desc(), host_light_desc_other()};
  if (pn_technique_parse(spec, &technique, NULL, NULL, 0) != PN_OK) skip();
  for (int i = 0; i < 2; i++) {
    pn_light *light = NULL;
    pn_maps_info maps;
    assert_int_equal(host_light(&h, &descs[i], spec, &light), PN_OK);
    float *image = host_visibility(&h, light, &v);
    assert_non_null(image);
    char name[120];
    snprintf(name, sizeof name, "technique-%s-%d", spec, i);
    save_picture(name, image, CAMERA_WIDTH, CAMERA_HEIGHT);
    assert_int_equal(pn_light_maps(light, &maps), PN_OK);
    truth_light truth = truth_light_of(&descs[i], &maps);
    assert_true(dark_pixels(image, CAMERA_WIDTH, CAMERA_HEIGHT) > 1000);
    for (int p = 0; p < PIXELS; p++) {
      assert_true(image[p] >= 0 && image[p] <= 1);
      if (seen.position[4 * p + 3] < 0) assert_true(image[p] == 1);
    }
    if (technique->self_shadows) check_lit(spec, &truth, image);
    if (strcmp(technique->name, "hard") != 0 && technique->self_shadows) check_sparkles(spec, image);
    free(image);
    pn_light_destroy(&light);
  }
  assert_int_equal(gl_errors(), 0);
}

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  camera view = camera_at(0);
  if (host_context(&h) != PN_OK || host_cast(&h, CAST_MEMORY) != PN_OK || host_view(&h, &view, &v) != PN_OK) return -1;
  return surfaces_draw(&seen, &h.draw, &h.world, &view) ? 0 : -1;
}

static int teardown(void **state) {
  (void)state;
  surfaces_free(&seen);
  host_view_close(&v);
  host_close(&h);
  return 0;
}

int main(void) {
  static const char *const specs[] = {"hard",
                                      "pcf",
                                      "pcf:filter=bicubic",
                                      "pcss",
                                      "average:samples=16",
                                      "ssm",
                                      "backprojection",
                                      "backprojection:primitive=quad",
                                      "bitmask",
                                      "bitmask:maps=front",
                                      "bitmask:maps=layers",
                                      "smoothies"};
  enum { COUNT = sizeof specs / sizeof *specs };
  struct CMUnitTest tests[COUNT];
  for (int i = 0; i < COUNT; i++) {
    tests[i] = (struct CMUnitTest){specs[i], test_technique, NULL, NULL, (void *)(intptr_t)specs[i]};
  }
  return cmocka_run_group_tests_name("techniques", tests, setup, teardown);
}
