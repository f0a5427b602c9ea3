/* A normal that may be wrong by sigma: nothing on the true tangent plane blocks, whichever way the normal errs, and
 * what stands up from it does. From points in the light's frame: (Q - P) . n = (Q - P) . (n - n'), n' the true
 * normal. And a plane that the rasteriser has moved by a part of a texel does not block itself. */
#include <stdlib.h>
#include <string.h>

#include "glsl_call.h"
#include "maps/block.h"

enum { COUNT = 8192 };
static float in[COUNT][16]; /* P, sigma; n; Q; whether a sun */

static void put(float *out, vec v) {
  out[0] = (float)v.x;
  out[1] = (float)v.y;
  out[2] = (float)v.z;
}

static const float texel[2] = {0.02f, 0.05f}; /* of the map, light map space */

/* A light of which the functions ask no more than whether it is a sun, and how far, in texels, its map may be off. */
static GLuint bind_block(bool sun, float raster_error) {
  pni_light_block block = {
      .extent = {1, 1}, .parallel = sun, .map_count = 1, .raster_error = raster_error, .texel = {texel[0], texel[1]}};
  GLuint buffer;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_UNIFORM_BUFFER, buffer);
  glBufferData(GL_UNIFORM_BUFFER, sizeof block, &block, GL_STATIC_DRAW);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, buffer);
  return buffer;
}

/* Odd inputs: Q stands straight up from P. Even ones: Q lies on the true plane, nearer to the light than P; the normal
 * that is told is turned by almost sigma, away from Q as often as towards it. */
static bool make_input(float *out, uint64_t *seed, bool sun, bool stands) {
  vec p = v3(random_in(seed, -1, 1), random_in(seed, -1, 1), sun ? random_in(seed, -3, 3) : random_in(seed, 1, 3));
  if (!sun) p = v3(p.x * p.z, p.y * p.z, p.z);
  vec truth = random_direction(seed), along = unit(cross(truth, random_direction(seed)));
  double sigma = random_in(seed, 0.01, 0.1), far = random_in(seed, 0.1, 0.8);
  vec q = add(p, mul(far, stands ? truth : along)), axis = unit(cross(truth, along));
  if (stands && truth.z > -0.3) return false;
  if (q.z >= p.z - 0.02 || (!sun && q.z < 0.2)) return false;
  double angle = 0.95 * sigma * (random_bits(seed) & 1 ? 1 : -1);
  vec told = add(mul(cos(angle), truth), mul(sin(angle), cross(axis, truth)));
  put(out, p);
  out[3] = (float)sigma;
  put(out + 4, told);
  put(out + 8, q);
  out[12] = stands;
  return true;
}

static void check(bool sun) {
  static const char *const paths[] = {"shaders/precision.glsl", "gather/shaded_point.glsl", NULL};
  static const char text[] =
      "void call() {\n"
      "  pn_ShadedPoint r = pn_shaded_point(0, taken(0).xyz, vec3(0.0), taken(1).xyz, taken(0).w);\n"
      "  r.epsilon_w = 0.0; r.epsilon_plane = 0.0;\n"
      "  results[0].x = pn_blocks(r, pn_map_point(taken(2).xyz, pn_is_parallel(0))) ? 1u : 0u;\n"
      "}";
  stage s;
  stage_open(&s);
  GLuint buffer = bind_block(sun, 0);
  uint64_t seed = 11 + sun;
  for (int i = 0; i < COUNT;) i += make_input(in[i], &seed, sun, i & 1);
  uint32_t *out = glsl_call(&s, &(glsl_function){paths, "", text}, in[0], 4, COUNT);
  for (int i = 0; i < COUNT; i++)
    if (out[32 * i] != (in[i][12] > 0))
      fail_msg("%s %d: what %s", sun ? "sun" : "rectangle", i,
               out[32 * i] ? "lies on the plane blocks" : "stands on the plane does not block");
  free(out);
  glDeleteBuffers(1, &buffer);
  stage_close(&s);
}

/* |d| sin(sigma) bounds what a turned normal adds: on the plane nothing blocks. Straight up from it the front is at
 * least cos(sigma) |d|, and the lever no more than (4 + sqrt 3) |d| for directions within a unit square: below sigma
 * 0.1
 * that blocks. */
static void test_rectangle(void **state) {
  (void)state;
  check(false);
}

static void test_sun(void **state) {
  (void)state;
  check(true);
}

/* Samples of a plane whose vertices were moved to the raster's sub-pixels: each is the plane's own, taken up to that
 * much aside of where the map has it. */
static void check_snapped(bool sun, float raster_error) {
  static const char *const paths[] = {"shaders/precision.glsl", "gather/shaded_point.glsl", NULL};
  static const char text[] = "void call() {\n"
                             "  pn_ShadedPoint r = pn_shaded_point(0, taken(0).xyz, vec3(0.0), taken(1).xyz, 0.0);\n"
                             "  results[0].x = pn_blocks(r, taken(2).xyz) ? 1u : 0u;\n"
                             "}";
  stage s;
  stage_open(&s);
  GLuint buffer = bind_block(sun, raster_error);
  uint64_t seed = 17 + sun;
  for (int i = 0; i < COUNT;) {
    if (!make_input(in[i], &seed, sun, false)) continue;
    float *f = in[i];
    vec p = v3(f[0], f[1], f[2]), q = v3(f[8], f[9], f[10]);
    vec n = unit(cross(sub(q, p), random_direction(&seed))); /* a plane that both lie on */
    vec map = sun ? v3(q.x, q.y, -q.z) : v3(q.x / q.z, q.y / q.z, 1 / q.z);
    map.x += random_in(&seed, -1, 1) * (double)raster_error * (double)texel[0];
    map.y += random_in(&seed, -1, 1) * (double)raster_error * (double)texel[1];
    put(f + 4, n);
    put(f + 8, map);
    i++;
  }
  uint32_t *out = glsl_call(&s, &(glsl_function){paths, "", text}, in[0], 4, COUNT);
  for (int i = 0; i < COUNT; i++)
    if (out[32 * i]) fail_msg("%s %d: a plane blocks itself", sun ? "sun" : "rectangle", i);
  free(out);
  glDeleteBuffers(1, &buffer);
  stage_close(&s);
}

static void test_snapped(void **state) {
  (void)state;
  check_snapped(false, 1.0f / 256);
  check_snapped(true, 1.0f / 16);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_rectangle), cmocka_unit_test(test_sun),
                                     cmocka_unit_test(test_snapped)};
  return GL_RUN("plane_angle", tests);
}
