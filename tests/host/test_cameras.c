/* The same scene through every kind of camera and depth buffer. Each is held against rays (hard: 0 or 1 exactly, flat
 * lit faces exactly 1) and against the baseline's picture. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "agreement.h"
#include "host.h"
#include "truth.h"

static host h;
static pn_light *hard, *soft;
static float *base_hard, *base_soft;
static surfaces base_seen;

/* One sample of pcss is worth 1/64 of the light. */
static const double sample = 1.0 / 64;

static truth_light light_truth(pn_light *light) {
  pn_light_desc desc = host_light_desc();
  pn_maps_info maps;
  assert_int_equal(pn_light_maps(light, &maps), PN_OK);
  return truth_light_of(&desc, &maps);
}

/* hard against rays, at every third pixel of every third row. */
static void check_hard(const camera *view, const surfaces *seen, const float *image) {
  truth_light light = light_truth(hard);
  int known = 0, tried = 0, wrong = 0;
  for (int y = 1; y < seen->height; y += 3) {
    for (int x = 1; x < seen->width; x += 3) {
      int i = y * seen->width + x;
      const float *p = seen->position + 4 * i;
      if (p[3] < 0) {
        wrong += image[i] != 1;
        continue;
      }
      if (!truth_plane_known(seen, x, y)) continue;
      tried++;
      int truth = truth_hard(&light, &h.world, v3_of(p), v3_of(seen->normal + 3 * i), 0.75);
      if (truth == TRUTH_EITHER) continue;
      known++;
      if (image[i] == (truth == TRUTH_BLOCKED ? 0 : 1)) continue;
      if (wrong++ < 8) {
        fprintf(stderr, "%s: pixel %d,%d of %s: %g, rays say %d\n", view->name, x, y, h.world.meshes[(int)p[3]].name,
                image[i], truth);
      }
    }
  }
  assert_true(known > 0.6 * tried);
  assert_int_equal(wrong, 0);
}

/* Where the whole light is seen with a margin, pcss is 1 and nothing less. */
static void check_lit(const camera *view, const surfaces *seen, const float *image) {
  truth_light light = light_truth(soft);
  int lit = 0, wrong = 0;
  for (int y = 1; y < seen->height; y += 5) {
    for (int x = 1; x < seen->width; x += 5) {
      int i = y * seen->width + x, object = (int)seen->position[4 * i + 3];
      if (object != SCENE_FLOOR && object != SCENE_BOX && object != SCENE_SLAB) continue;
      if (!truth_plane_known(seen, x, y)) continue;
      if (!truth_sees_all(&light, &h.world, v3_of(seen->position + 4 * i), v3_of(seen->normal + 3 * i))) continue;
      lit++;
      if (image[i] == 1) continue;
      if (wrong++ < 8) fprintf(stderr, "%s: lit pixel %d,%d: 1 - %g\n", view->name, x, y, 1 - image[i]);
    }
  }
  assert_true(lit > 100);
  assert_int_equal(wrong, 0);
}

/* The same rays: changes are bounded as agreement.h derives it, with the errors of both views. */
static void check_same_rays(const camera *view, const surfaces *seen, const float *hard_image,
                            const float *soft_image) {
  camera base = camera_at(0);
  double delta = view_error(view, seen) + view_error(&base, &base_seen);
  int w = seen->width, height = seen->height;
  unsigned char *skip = calloc((size_t)w * (size_t)height, 1);
  assert_non_null(skip);
  for (int i = 0; i < w * height; i++)
    skip[i] = seen->position[4 * i + 3] >= 0 && !truth_plane_known(seen, i % w, i / w);
  agreement a = agree(base_hard, CAMERA_WIDTH, CAMERA_HEIGHT, view->crop_x, view->crop_y, hard_image, w, height, skip);
  agreement b = agree(base_soft, CAMERA_WIDTH, CAMERA_HEIGHT, view->crop_x, view->crop_y, soft_image, w, height, skip);
  free(skip);
  printf("%s: delta %.2g pixels; hard: %d of %d differ, %d strays; pcss: mean %.2g, worst %.2g\n", view->name, delta,
         a.differing, a.pixels, a.strays, b.sum / b.pixels, b.worst);
  assert_true(delta < 0.1);
  assert_true(a.differing <= allowed_changes(a.range * delta));
  assert_int_equal(a.strays, 0);
  assert_true(b.sum / sample <= allowed_changes(b.range * delta / sample));
  /* Moving less than a texel carries at most one column and one row of the 8 x 8 samples across a border; but a texel
   * that enters the search moves the blockers' mean w, and with it every sample. Such pixels lie where hard shadows
   * change too, within what the baseline sees around them. */
  assert_int_equal(b.strays, 0);
}

/* Other rays: what is seen at a point lies between what the baseline sees at the pixels around that point, give or take
 * two samples. Where the baseline does not see the point's face all around, nothing is compared. */
static void check_other_rays(const camera *view, const surfaces *seen, const float *image) {
  camera base = camera_at(0);
  mat4 clip = camera_clip(&base);
  int compared = 0, outside = 0;
  for (int i = 0; i < seen->width * seen->height; i++) {
    const float *p = seen->position + 4 * i;
    if (p[3] < 0 || !truth_plane_known(seen, i % seen->width, i / seen->width)) continue;
    vec3 c = project(&clip, v3_of(p), NULL), n = v3_of(seen->normal + 3 * i);
    int x = (int)floor((c.x + 1) / 2 * CAMERA_WIDTH), y = (int)floor((c.y + 1) / 2 * CAMERA_HEIGHT);
    if (x < 2 || y < 2 || x >= CAMERA_WIDTH - 2 || y >= CAMERA_HEIGHT - 2) continue;
    int same = 1;
    for (int k = 0; same && k < 25; k++) {
      int j = (y + k / 5 - 2) * CAMERA_WIDTH + x + k % 5 - 2;
      const float *q = base_seen.position + 4 * j;
      same = q[3] == p[3] && fabs(dot(n, sub(v3_of(q), v3_of(p)))) < 1e-3 &&
             dot(n, v3_of(base_seen.normal + 3 * j)) > 0.999;
    }
    if (!same) continue;
    compared++;
    float least = 2, most = -1;
    for (int k = 0; k < 25; k++) {
      float v = base_soft[(y + k / 5 - 2) * CAMERA_WIDTH + x + k % 5 - 2];
      least = fminf(least, v), most = fmaxf(most, v);
    }
    outside += !(image[i] >= least - 2 * sample && image[i] <= most + 2 * sample);
  }
  printf("%s: %d of %d points outside the baseline's range\n", view->name, outside, compared);
  assert_true(compared > seen->width * seen->height / 3);
  /* A spot smaller than the pixels around it may hide between them: one point in a thousand. */
  assert_true(outside <= compared / 1000);
}

static void test_camera(void **state) {
  camera view = camera_at((int)(intptr_t)*state);
  if (view.zero_to_one && !gl.ClipControl) skip();
  camera_view v;
  surfaces seen;
  assert_int_equal(host_view(&h, &view, &v), PN_OK);
  assert_true(surfaces_draw(&seen, &h.draw, &h.world, &view));
  float *hard_image = host_visibility(&h, hard, &v), *soft_image = host_visibility(&h, soft, &v);
  assert_non_null(hard_image);
  assert_non_null(soft_image);
  char name[80];
  snprintf(name, sizeof name, "camera-%s", view.name);
  save_picture(name, soft_image, view.width, view.height);
  check_hard(&view, &seen, hard_image);
  check_lit(&view, &seen, soft_image);
  if (view.same_rays) {
    check_same_rays(&view, &seen, hard_image, soft_image);
  } else {
    check_other_rays(&view, &seen, soft_image);
  }
  free(hard_image);
  free(soft_image);
  surfaces_free(&seen);
  host_view_close(&v);
  assert_int_equal(gl_errors(), 0);
}

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  pn_light_desc desc = host_light_desc();
  camera view = camera_at(0);
  camera_view v;
  if (host_context(&h) != PN_OK || host_cast(&h, CAST_MEMORY) != PN_OK) return -1;
  if (host_light(&h, &desc, "hard", &hard) != PN_OK || host_light(&h, &desc, "pcss", &soft) != PN_OK) return -1;
  if (host_view(&h, &view, &v) != PN_OK) return -1;
  base_hard = host_visibility(&h, hard, &v);
  base_soft = host_visibility(&h, soft, &v);
  host_view_close(&v);
  return base_hard && base_soft && surfaces_draw(&base_seen, &h.draw, &h.world, &view) ? 0 : -1;
}

static int teardown(void **state) {
  (void)state;
  free(base_hard);
  free(base_soft);
  surfaces_free(&base_seen);
  host_close(&h);
  return 0;
}

int main(void) {
  struct CMUnitTest tests[CAMERA_COUNT];
  for (int i = 0; i < CAMERA_COUNT; i++) {
    tests[i] = (struct CMUnitTest){camera_at(i).name, test_camera, NULL, NULL, (void *)(intptr_t)i};
  }
  return cmocka_run_group_tests_name("cameras", tests, setup, teardown);
}
