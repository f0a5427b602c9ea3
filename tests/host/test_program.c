/* The client's picture and the program's: the same model file, camera and light, through two renderers that share
 * nothing but the library. Arguments: the program, and a model file of the system's or "". */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sys/wait.h>

#include <cmocka.h>

#include "agreement.h"
#include "host.h"
#include "image_file.h"
#include "model.h"
#include "truth.h"

enum { PIXELS = CAMERA_WIDTH * CAMERA_HEIGHT, TECHNIQUES = 3 };

static const char *const techniques[TECHNIQUES] = {"hard", "pcf", "pcss"};
static const char *program, *system_model;

typedef struct {
  vec3 eye, target;
  pn_light_desc light;
  vec3 light_target; /* center + direction */
} setting;

/* The light as the program derives it from center, target and up. */
static void aim(setting *s, vec3 target) {
  static const float up[3] = {0, 1, 0};
  s->light_target = target;
  s->light.direction[0] = (float)(target.x - s->light.center[0]);
  s->light.direction[1] = (float)(target.y - s->light.center[1]);
  s->light.direction[2] = (float)(target.z - s->light.center[2]);
  pn_light_frame(s->light.direction, up, NULL, s->light.axis_u, NULL);
}

/* Exit status of the program's compare with its raw buffers in the directory. */
static int run_program(const char *model, const char *directory, const setting *s) {
  char command[4096];
  const float *c = s->light.center, *f = s->light.fit_bounds;
  const double degrees = 180 / 3.14159265358979323846;
  int sun = s->light.shape == PN_LIGHT_SUN;
  double width = sun ? 2 * atan(s->light.half_u) * degrees : 2.0 * s->light.half_u;
  double height = sun ? 2 * atan(s->light.half_v) * degrees : 2.0 * s->light.half_v;
  snprintf(command, sizeof command,
           "'%s' compare '%s' -t %s -t %s -t %s --save-dir '%s' --size %dx%d --map %d --fit "
           "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g --ground off --up y "
           "--light %s --light-center %.9g,%.9g,%.9g --light-target %.9g,%.9g,%.9g --light-up 0,1,0 --light-size "
           "%.17g,%.17g "
           "--camera-position %.9g,%.9g,%.9g --camera-target %.9g,%.9g,%.9g --camera-up 0,1,0 --fov %.17g "
           "--reference-samples 1 --no-cache --frames 1 --quiet -o '%s.png' > '%s.log' 2>&1",
           program, model, techniques[0], techniques[1], techniques[2], directory, CAMERA_WIDTH, CAMERA_HEIGHT,
           s->light.map_width, f[0], f[1], f[2], f[3], f[4], f[5], sun ? "sun" : "rectangle", c[0], c[1], c[2],
           s->light_target.x, s->light_target.y, s->light_target.z, width, height, s->eye.x, s->eye.y, s->eye.z,
           s->target.x, s->target.y, s->target.z, 2 * atan(camera_fov_tangent) * degrees, directory, directory);
  int status = system(command);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fprintf(stderr, "failed: %s\n", command);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void compare_technique(host *h, const setting *s, const camera_view *v, const surfaces *seen,
                              const char *directory, int index) {
  char path[512];
  int width = 0, height = 0;
  pn_light *light = NULL;
  snprintf(path, sizeof path, "%s/%02d-%s.exr", directory, index + 1, techniques[index]);
  float *theirs = exr_channel(path, "Y", &width, &height);
  assert_non_null(theirs);
  assert_int_equal(width, CAMERA_WIDTH);
  assert_int_equal(height, CAMERA_HEIGHT);
  assert_int_equal(host_light(h, &s->light, techniques[index], &light), PN_OK);
  float *ours = host_visibility(h, light, v);
  assert_non_null(ours);
  snprintf(path, sizeof path, "%s-%s-client", directory, techniques[index]);
  save_picture(path, ours, width, height);
  snprintf(path, sizeof path, "%s-%s-program", directory, techniques[index]);
  save_picture(path, theirs, width, height);
  unsigned char *skip_pixel = calloc(PIXELS, 1);
  assert_non_null(skip_pixel);
  for (int i = 0; i < PIXELS; i++) {
    skip_pixel[i] = seen->position[4 * i + 3] >= 0 && !truth_plane_known(seen, i % width, i / width);
  }
  /* Two rasterisations of the same view, from matrices that were composed by different code: view_error each, of which
   * a step of the rasteriser's grid is the largest part. */
  agreement a = agree(ours, width, height, 0, 0, theirs, width, height, skip_pixel);
  double delta = 2 * view_error(&v->view, seen), step = index == 1 ? 1.0 / 25 : 1;
  double allowed = allowed_changes(a.range * delta / step);
  printf("%s %s: %d of %d pixels differ, mean %.2g, worst %.2g; %d strays\n", directory, techniques[index], a.differing,
         a.pixels, a.sum / a.pixels, a.worst, a.strays);
  assert_true(a.range > 20); /* a shadow is there to be compared: on the model little of it lies on known planes */
  /* pcss changes by up to 1 wherever one of its hundreds of search samples crosses into another texel, since the
   * blockers' mean w then moves all of the filter: what is bounded is where (nowhere outside what the picture shows
   * around) and, over all pixels, that it stays below one of its 64 filter samples by far. */
  if (index == 2) assert_true(a.strays == 0 && a.sum / a.pixels < 1.0 / 64 / 8);
  else assert_true(a.sum / step <= allowed);
  if (index == 0) assert_true(a.strays <= 4);
  free(skip_pixel), free(ours), free(theirs);
  pn_light_destroy(&light);
}

/* The map's bounds are given, since the program may cut the file into other meshes, which are fitted one by one. */
static void compare_model(const char *path, const char *directory, setting *s) {
  host h;
  mesh model;
  camera_view v;
  surfaces seen;
  assert_true(model_load(path, &model));
  s->light.fit = PN_FIT_GIVEN;
  memcpy(s->light.fit_bounds, model.bounds_min, sizeof model.bounds_min);
  memcpy(s->light.fit_bounds + 3, model.bounds_max, sizeof model.bounds_max);
  assert_int_equal(run_program(path, directory, s), 0);
  if (!host_open_model(&h, &model)) skip();
  camera view = camera_from(s->eye, s->target);
  assert_int_equal(host_context(&h), PN_OK);
  assert_int_equal(host_cast(&h, CAST_MEMORY), PN_OK);
  assert_int_equal(host_view(&h, &view, &v), PN_OK);
  assert_true(surfaces_draw(&seen, &h.draw, &h.world, &view));
  for (int i = 0; i < TECHNIQUES; i++) compare_technique(&h, s, &v, &seen, directory, i);
  surfaces_free(&seen);
  host_view_close(&v);
  assert_int_equal(gl_errors(), 0);
  host_close(&h);
}

static void save_scene(const char *path) {
  scene world;
  scene_make(&world);
  world.meshes[SCENE_FLAG].holes = 0;
  assert_true(model_save(path, &world));
  scene_free(&world);
}

static void test_rectangle(void **state) {
  (void)state;
  setting s = {.eye = v3(0.4, 2.7, 5.2), .target = v3(0, 0.6, 0), .light = host_light_desc()};
  aim(&s, v3(0, 0.25, 0.125));
  save_scene("scene.obj");
  compare_model("scene.obj", "program-rectangle", &s);
}

static void test_other_rectangle(void **state) {
  (void)state;
  setting s = {.eye = v3(-3.25, 1.75, 3.5), .target = v3(0, 0.375, 0), .light = host_light_desc_other()};
  s.light.map_width = 300, s.light.map_height = 0;
  aim(&s, v3(0, 0.5, 0.25));
  save_scene("scene.obj");
  compare_model("scene.obj", "program-other", &s);
}

static void test_sun(void **state) {
  (void)state;
  setting s = {.eye = v3(0.4, 2.7, 5.2), .target = v3(0, 0.6, 0), .light = host_sun_desc()};
  s.light.center[1] = 4;
  aim(&s, v3(-1, 0, -1.5));
  save_scene("scene.obj");
  compare_model("scene.obj", "program-sun", &s);
}

/* A real model, read by Assimp there and by the client's own loader here. */
static void test_system_model(void **state) {
  (void)state;
  mesh model;
  if (!system_model[0]) skip();
  assert_true(model_load(system_model, &model));
  const float *a = model.bounds_min, *b = model.bounds_max;
  double size = fmax(fmax(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
  vec3 middle = scaled(add(v3_of(a), v3_of(b)), 0.5);
  mesh_free(&model);
  setting s = {.light = {.map_width = 256}};
  s.eye = v3((float)(middle.x + size), (float)(middle.y + size), (float)(middle.z + 1.75 * size));
  s.target = v3((float)middle.x, (float)middle.y, (float)middle.z);
  s.light.center[0] = (float)(middle.x - size), s.light.center[1] = (float)(middle.y + 2 * size);
  s.light.center[2] = (float)(middle.z + size);
  s.light.half_u = s.light.half_v = (float)(0.125 * size);
  aim(&s, s.target);
  if (size < 0.5 || size > 8) skip(); /* the client's near and far planes */
  compare_model(system_model, "program-model", &s);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_rectangle), cmocka_unit_test(test_other_rectangle),
                                     cmocka_unit_test(test_sun), cmocka_unit_test(test_system_model)};
  program = argc > 1 ? argv[1] : NULL;
  system_model = argc > 2 ? argv[2] : "";
  if (!program) return 77;
  return cmocka_run_group_tests_name("program", tests, NULL, NULL);
}
