/* The errors that `penumbra compare` tells, taken again from the files it saves and from the pictures `render` writes:
 * corners of the light from position and normal, what arrives without a shadow from a sum over points of the light. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>
#include <cmocka.h>

#include "exr_channel.h"

enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT };

static char folder[] = "/tmp/penumbra-truth-XXXXXX";

static void read_channel(const char *name, const char *channel, float *out) {
  char path[256];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  assert_true(exr_channel_read(path, channel, WIDTH, HEIGHT, out));
}

static void run(const char *command, const char *scene, const char *light, const char *options) {
  char line[1024];
  snprintf(line, sizeof line, "cd %s && \"%s\" %s %s --size %dx%d --map 48 --frames 1 -t pcss %s %s >out 2>err", folder,
           getenv("PENUMBRA_PROGRAM"), command, scene, WIDTH, HEIGHT, light, options);
  if (system(line) != 0) fail_msg("%s", line);
}

static cJSON *read_json(void) {
  char path[256];
  static char text[65536];
  snprintf(path, sizeof path, "%s/a.json", folder);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  text[fread(text, 1, sizeof text - 1, file)] = 0;
  fclose(file);
  cJSON *json = cJSON_Parse(text);
  assert_non_null(json);
  return json;
}

static void read_vector(const cJSON *object, const char *name, double out[3]) {
  const cJSON *list = cJSON_GetObjectItem(object, name);
  for (int k = 0; k < 3; k++) {
    const cJSON *item = cJSON_GetArrayItem(list, k);
    out[k] = item ? item->valuedouble : 0;
  }
}

static float position[3][PIXELS], normal[3][PIXELS], truth[PIXELS], visibility[PIXELS], shaded[PIXELS], mask[PIXELS];

static const double pi = 3.14159265358979323846;

/* The JSON's light; a sun's sizes are full tangents. */
struct lamp {
  double center[3], u[3], v[3], direction[3], size[3], target[3];
  int sun;
};

static struct lamp read_lamp(const cJSON *light) {
  struct lamp l;
  read_vector(light, "center", l.center);
  read_vector(light, "u", l.u);
  read_vector(light, "v", l.v);
  read_vector(light, "direction", l.direction);
  read_vector(light, "size", l.size);
  read_vector(light, "target", l.target);
  l.sun = strcmp(cJSON_GetObjectItem(light, "type")->valuestring, "rectangle") != 0;
  for (int k = 0; k < 2 && l.sun; k++) l.size[k] = 2 * tan(l.size[k] * pi / 360);
  return l;
}

/* From p to the light's point (a, b) of [-1, 1]^2; a sun: the direction to it. */
static void toward(const struct lamp *l, const double p[3], double a, double b, double out[3]) {
  for (int k = 0; k < 3; k++) {
    double across = 0.5 * (a * l->size[0] * l->u[k] + b * l->size[1] * l->v[k]);
    out[k] = across + (l->sun ? -l->direction[k] : l->center[k] - p[k]);
  }
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static int behind(const struct lamp *l, const double p[3]) {
  double d[3];
  toward(l, p, 0, 0, d);
  return !l->sun && !(dot(d, l->direction) < 0);
}

/* How many corners of the light a surface faces. */
static int corners_faced(const struct lamp *l, const double p[3], const double n[3]) {
  int count = 0;
  for (int corner = 0; corner < 4; corner++) {
    double d[3];
    toward(l, p, corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, d);
    count += dot(n, d) > 0;
  }
  return behind(l, p) ? 0 : count;
}

/* The form factor as a sum over SIDE x SIDE parts of the light: cosine times cosine over pi r^2. A part that the
 * horizon
 * runs through is taken whole or not at all, though its cosine is next to nothing there. A sun counts as its middle. */
static double form_factor(const struct lamp *l, const double p[3], const double n[3]) {
  enum { SIDE = 24 };
  double sum = 0;
  if (l->sun) return fmax(0, -dot(n, l->direction));
  for (int i = 0; i < SIDE * SIDE && !behind(l, p); i++) {
    double d[3];
    toward(l, p, (2 * (i % SIDE) + 1.0) / SIDE - 1, (2 * (i / SIDE) + 1.0) / SIDE - 1, d);
    double far = dot(d, d);
    sum += fmax(0, dot(n, d)) * -dot(l->direction, d) / (pi * far * far);
  }
  return sum * l->size[0] * l->size[1] / (SIDE * SIDE);
}

static void assert_near(double found, double want, double allowed) {
  if (!(fabs(found - want) <= allowed)) fail_msg("%.9g, not %.9g", found, want);
}

static void read_files(void) {
  static const char *const axes[] = {"X", "Y", "Z"};
  for (int k = 0; k < 3; k++) {
    read_channel("position.exr", axes[k], position[k]);
    read_channel("normal.exr", axes[k], normal[k]);
  }
  read_channel("mask.exr", "Y", mask);
  read_channel("reference.exr", "Y", truth);
  read_channel("01-pcss.exr", "Y", visibility);
}

/* What a program that reads the files finds. */
static void check(const cJSON *json, int partly_least) {
  const struct lamp light = read_lamp(cJSON_GetObjectItem(cJSON_GetObjectItem(json, "scene"), "light"));
  const cJSON *result = cJSON_GetArrayItem(cJSON_GetObjectItem(json, "results"), 0);
  const cJSON *all = cJSON_GetObjectItem(result, "all"), *error = cJSON_GetObjectItem(result, "error");
  double sum = 0, squares = 0, signed_sum = 0, most = 0, picture = 0, shadow = 0;
  const double back[3] = {-light.direction[0], -light.direction[1], -light.direction[2]};
  double exposure = 0.8 / form_factor(&light, light.target, back);
  int faced = 0, partly = 0, receiving = 0, counted = 0;
  for (int i = 0; i < PIXELS; i++) {
    if (isnan(position[0][i])) continue;
    const double p[3] = {position[0][i], position[1][i], position[2][i]};
    const double n[3] = {normal[0][i], normal[1][i], normal[2][i]};
    double off = (double)visibility[i] - (double)truth[i], arrives = exposure * form_factor(&light, p, n);
    int corners = corners_faced(&light, p, n);
    receiving++;
    picture += arrives * fabs(off);
    assert_near(shaded[i], arrives * visibility[i] + 0.02, 2e-3 * arrives + 1e-3);
    assert_true((mask[i] > 0) == (corners == 4));
    if (corners == 4 && (visibility[i] < 1 - 1 / 2048.0 || truth[i] < 1 - 1 / 2048.0)) {
      shadow += fabs(off);
      counted++;
    }
    if (!corners) continue;
    faced++;
    partly += corners < 4;
    sum += fabs(off);
    squares += off * off;
    signed_sum += off;
    most = fmax(most, fabs(off));
  }
  assert_true(partly >= partly_least && counted > 0 && shadow > 0);
  assert_int_equal(cJSON_GetObjectItem(all, "pixels")->valueint, faced);
  assert_near(cJSON_GetObjectItem(all, "mae")->valuedouble, sum / faced, 1e-12);
  assert_near(cJSON_GetObjectItem(all, "rmse")->valuedouble, sqrt(squares / faced), 1e-12);
  assert_near(cJSON_GetObjectItem(all, "bias")->valuedouble, signed_sum / faced, 1e-12);
  assert_near(cJSON_GetObjectItem(all, "max")->valuedouble, most, 1e-12);
  assert_int_equal(cJSON_GetObjectItem(error, "pixels")->valueint, counted);
  assert_near(cJSON_GetObjectItem(error, "mae")->valuedouble, shadow / counted, 1e-12);
  assert_near(cJSON_GetObjectItem(result, "picture")->valuedouble, picture / receiving, 0.01 * picture / receiving);
}

static void compare_and_check(const char *scene, const char *light, int partly_least) {
  run("compare", scene, light, "--no-cache --reference-samples 16 --save-dir . --json a.json");
  read_files();
  run("render", scene, light, "-o shaded.exr");
  read_channel("shaded.exr", "G", shaded);
  cJSON *json = read_json();
  check(json, partly_least);
  cJSON_Delete(json);
}

static void test_rectangle(void **state) {
  (void)state;
  compare_and_check("builtin:boxes", "--light-center 1.5,1,0.5 --light-target 0,0,0 --light-size 1.2", 30);
}

static void test_sun(void **state) {
  (void)state;
  compare_and_check("builtin:boxes", "--light sun --light-center 0.6,1,0.3 --light-target 0,0,0 --light-size 80,50",
                    30);
}

int main(void) {
  if (!getenv("PENUMBRA_PROGRAM")) return 77;
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_rectangle), cmocka_unit_test(test_sun)};
  if (!mkdtemp(folder)) return 1;
  int failures = cmocka_run_group_tests_name("truth", tests, NULL, NULL);
  char line[256];
  snprintf(line, sizeof line, "rm -rf %s", folder);
  return failures + (system(line) != 0);
}
