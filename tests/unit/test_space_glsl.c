/* The functions of space.glsl, run by GL on thousands of inputs, agree with space.c up to float rounding. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gl/embedded.h"
#include "gl_context.h"
#include "space/space.h"
#include "vector.h"

enum { SIDE = 96, COUNT = SIDE * SIDE, INPUTS = 4 };

/* Rounding unit of float. GLSL allows a quotient an error of 2.5 units in the last place, that is 5 of these. */
static const double e = 0x1p-24;

typedef struct {
  float a[4], b[4], n[4], more[4];
} inputs; /* more: extent u, v, two w */

static const char main_text[] =
    "uniform sampler2D input_0, input_1, input_2, input_3; uniform int which; uniform bool sun;\n"
    "layout(location = 0) out vec4 result;\n"
    "void main() {\n"
    "  ivec2 at = ivec2(gl_FragCoord.xy);\n"
    "  vec3 a = texelFetch(input_0, at, 0).xyz, b = texelFetch(input_1, at, 0).xyz, n = texelFetch(input_2, at, "
    "0).xyz;\n"
    "  vec4 more = texelFetch(input_3, at, 0);\n"
    "  result = vec4(0.0);\n"
    "  if (which == 0) result.xyz = pn_map_point(a, sun);\n"
    "  if (which == 1) result.xyz = pn_light_point(a, sun);\n"
    "  if (which == 2) result.xy = pn_back_project(a, b);\n"
    "  if (which == 3) result.x = pn_plane_offset(n, a, sun);\n"
    "  if (which == 4) result.x = pn_plane_front(n, more.x, a, b);\n"
    "  if (which == 5) result.x = pn_horizon(n, more.x, more.yz);\n"
    "  if (which == 6) result.xy = pn_search_window(more.xy, more.z, more.w);\n"
    "  if (which == 7) result.xy = pn_penumbra_extent(more.xy, more.z, more.w);\n"
    "}\n";
static const char vertex_text[] =
    "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }\n";

static GLuint program, textures[INPUTS], target, framebuffer, array;

static const char *space_text(void) {
  for (int i = 0; i < pni_embedded_shader_count; i++)
    if (!strcmp(pni_embedded_shaders[i].path, "space/space.glsl")) return pni_embedded_shaders[i].text;
  return "";
}

static GLuint image(const float *values) {
  GLuint texture;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, SIDE, SIDE, 0, GL_RGBA, GL_FLOAT, values);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  return texture;
}

/* Runs one function over all inputs; four floats for each, freed by the caller. */
static float *run(const inputs *in, int which, bool sun) {
  size_t length = strlen(space_text()) + sizeof main_text;
  char *text = malloc(length);
  snprintf(text, length, "%s%s", space_text(), main_text);
  program = gl_program(vertex_text, text);
  free(text);
  float *values = malloc(COUNT * 4 * sizeof *values);
  glUseProgram(program);
  for (int k = 0; k < INPUTS; k++) {
    char name[] = "input_0";
    name[6] = (char)('0' + k);
    for (int i = 0; i < COUNT; i++) memcpy(values + 4 * i, (const float *)&in[i] + 4 * k, 16);
    glActiveTexture(GL_TEXTURE0 + (GLenum)k);
    textures[k] = image(values);
    glUniform1i(glGetUniformLocation(program, name), k);
  }
  free(values);
  glActiveTexture(GL_TEXTURE0 + INPUTS);
  target = image(NULL);
  glUniform1i(glGetUniformLocation(program, "which"), which);
  glUniform1i(glGetUniformLocation(program, "sun"), sun);
  glGenVertexArrays(1, &array);
  glBindVertexArray(array);
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target, 0);
  glViewport(0, 0, SIDE, SIDE);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  float *out = gl_read_texture(target, 0, -1, SIDE, SIDE, 4);
  glDeleteFramebuffers(1, &framebuffer);
  glDeleteTextures(INPUTS, textures);
  glDeleteTextures(1, &target);
  glDeleteVertexArrays(1, &array);
  glUseProgram(0);
  glDeleteProgram(program);
  return out;
}

static void fill(float out[4], uint64_t *seed, double low, double high) {
  for (int k = 0; k < 4; k++) out[k] = (float)random_in(seed, low, high);
}

/* a, b: points of either space, the third coordinate positive unless wide. */
static inputs *random_inputs(uint64_t seed, bool wide) {
  inputs *in = calloc(COUNT, sizeof *in);
  for (int i = 0; i < COUNT; i++) {
    fill(in[i].a, &seed, -9, 9);
    fill(in[i].b, &seed, -9, 9);
    fill(in[i].n, &seed, -1, 1);
    fill(in[i].more, &seed, 0.01, 4);
    if (wide) continue;
    in[i].a[2] = (float)exp2(random_in(&seed, -6, 6));
    in[i].b[2] = (float)exp2(random_in(&seed, -6, 6));
  }
  return in;
}

static void widen(const float in[3], double out[3]) {
  for (int k = 0; k < 3; k++) out[k] = in[k];
}

static void check(double found, double want, double bound) {
  if (!(fabs(found - want) <= bound)) fail_msg("%.9g, but C says %.9g +- %.3g", found, want, bound);
}

/* A coordinate is one quotient, or 1 / z and a product. */
static void points(int which, bool sun) {
  inputs *in = random_inputs(1 + (uint64_t)which, sun);
  float *out = run(in, which, sun);
  for (int i = 0; i < COUNT; i++) {
    double a[3], want[3];
    widen(in[i].a, a);
    (which ? pni_light_point : pni_map_point)(a, sun, want);
    for (int k = 0; k < 3; k++) check(out[4 * i + k], want[k], 6 * e * fabs(want[k]));
  }
  free(out);
  free(in);
}

static void test_points(void **state) {
  (void)state;
  for (int which = 0; which < 2; which++)
    for (int sun = 0; sun < 2; sun++) points(which, sun);
}

/* Two differences and a quotient, of inputs that are exact. */
static void test_back_project(void **state) {
  (void)state;
  inputs *in = random_inputs(3, true);
  float *out = run(in, 2, false);
  for (int i = 0; i < COUNT; i++) {
    double a[3], b[3], want[2];
    widen(in[i].a, a);
    widen(in[i].b, b);
    pni_back_project(a, b, want);
    for (int k = 0; k < 2; k++) check(out[4 * i + k], want[k], 8 * e * fabs(want[k]));
  }
  free(out);
  free(in);
}

/* Sums of three products: at most a rounding for each factor's difference, one for the product, two for the sums. */
static void test_planes(void **state) {
  (void)state;
  inputs *in = random_inputs(4, true);
  for (int sun = 0; sun < 2; sun++) {
    float *offset = run(in, 3, sun), *front = run(in, 4, sun), *horizon = run(in, 5, sun);
    for (int i = 0; i < COUNT; i++) {
      double a[3], b[3], n[3], k = in[i].more[0], point[2] = {in[i].more[1], in[i].more[2]};
      widen(in[i].a, a);
      widen(in[i].b, b);
      widen(in[i].n, n);
      double size = fabs(n[0] * a[0]) + fabs(n[1] * a[1]) + fabs(n[2] * a[2]);
      check(offset[4 * i], pni_plane_offset(n, a, sun), sun ? 0 : 4 * e * size);
      size = fabs(n[0] * (a[0] - b[0])) + fabs(n[1] * (a[1] - b[1])) + fabs(k * (a[2] - b[2]));
      check(front[4 * i], pni_plane_front(n, k, a, b), 5 * e * size);
      size = fabs(n[0] * point[0]) + fabs(n[1] * point[1]) + fabs(k);
      check(horizon[4 * i], pni_horizon(n, k, point), 4 * e * size);
    }
    free(offset);
    free(front);
    free(horizon);
  }
  free(in);
}

/* A difference and a product; nothing at all below zero. */
static void test_windows(void **state) {
  (void)state;
  inputs *in = random_inputs(5, true);
  float *window = run(in, 6, false), *extent = run(in, 7, false);
  for (int i = 0; i < COUNT; i++)
    for (int k = 0; k < 2; k++) {
      const float *more = in[i].more;
      double want = pni_search_window(more[k], more[2], more[3]);
      check(window[4 * i + k], want, 3 * e * want);
      want = pni_penumbra_extent(more[k], more[2], more[3]);
      check(extent[4 * i + k], want, 3 * e * want);
    }
  free(window);
  free(extent);
  free(in);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_points), cmocka_unit_test(test_back_project),
                                     cmocka_unit_test(test_planes), cmocka_unit_test(test_windows)};
  return GL_RUN("space.glsl", tests);
}
