/* The mean w of pcss's blockers: what a blocker hides of the light is its weight, and nothing hides more than all of
 * it. So where a far blocker hides the whole light, one that fills a single texel right before the receiver counts
 * for no
 * more than half. And where two blockers hide a half each, the mean is their mean. */
#include <stdlib.h>

#include "glsl_call.h"
#include "maps/block.h"

enum { SIZE = 64 };
#define EXTENT 0.5
#define W_LEAST -1.0 /* w at depth 0; at depth 1 three more */

static float depth_of(double w) { return (float)((w - W_LEAST) / 4); }

/* A sun's map over [-1, 1]^2, its block in binding 0, the texture on unit 0; the receiver is at w = 0. */
static void put_map(const float *depth, GLuint *buffer, GLuint *texture) {
  pni_light_block block = {.extent = {EXTENT, EXTENT},
                           .parallel = 1,
                           .map_count = 1,
                           .w_near = 3,
                           .w_far = W_LEAST,
                           .layers = 1,
                           .texel = {2.0f / SIZE, 2.0f / SIZE}};
  block.maps[0] = (pni_map_block){.origin = {-1, -1},
                                  .density = {SIZE / 2, SIZE / 2},
                                  .w_of_depth = {W_LEAST, 4},
                                  .size = {SIZE, SIZE},
                                  .layers = 1};
  glGenBuffers(1, buffer);
  glBindBuffer(GL_UNIFORM_BUFFER, *buffer);
  glBufferData(GL_UNIFORM_BUFFER, sizeof block, &block, GL_STATIC_DRAW);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, *buffer);
  glGenTextures(1, texture);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D_ARRAY, *texture);
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_R32F, SIZE, SIZE, 1, 0, GL_RED, GL_FLOAT, depth);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

/* The mean w at a receiver at (s, t, 0) whose plane is parallel to the map. */
static double mean_w(const float *depth, double s, double t, double w_max, int samples) {
  static const char *const paths[] = {"shaders/precision.glsl", "gather/channels.glsl", "techniques/pcss/pcss.glsl",
                                      NULL};
  static const char text[] =
      "void call() {\n"
      "  pn_ShadedPoint r = pn_shaded_point(0, vec3(taken(0).xy, 0.0), vec3(0.0), vec3(0.0, 0.0, -1.0), 0.0);\n"
      "  results[0].x = floatBitsToUint(pn_blockers(0, pn_maps, r, int(taken(0).w), taken(0).z));\n"
      "}";
  const float in[4] = {(float)s, (float)t, (float)w_max, (float)samples};
  stage host;
  GLuint buffer, texture;
  stage_open(&host);
  put_map(depth, &buffer, &texture);
  uint32_t *out = glsl_call(&host, &(glsl_function){paths, "PN_PARAMETER_SAMPLES 0\n", text}, in, 1, 1);
  double found = as_float(out[0]);
  free(out);
  glDeleteBuffers(1, &buffer);
  glDeleteTextures(1, &texture);
  stage_close(&host);
  return found;
}

static void test_one_texel_before_the_receiver(void **state) {
  (void)state;
  static float depth[SIZE * SIZE];
  const int at = SIZE / 2;
  const double middle = 1.0 / SIZE, near[] = {1e-4, 1e-3, 1e-2}, far[] = {0.5, 1, 1.5};
  for (int k = 0; k < 9; k++)
    for (int samples = 4; samples <= 32; samples *= 2) {
      for (int i = 0; i < SIZE * SIZE; i++) depth[i] = depth_of(far[k / 3]);
      depth[at * SIZE + at] = depth_of(near[k % 3]);
      double found = mean_w(depth, middle, middle, far[k / 3], samples);
      /* The far one lacks no more than the texel's share of its window, which is 2 EXTENT far wide. */
      double share = 1.0 / SIZE / (EXTENT * far[k / 3]), least = (near[k % 3] + (1 - share * share) * far[k / 3]) / 2;
      if (!(found >= least - 0.01 && found <= far[k / 3]))
        fail_msg("near %g, far %g, %d samples: mean %g, not at least %g", near[k % 3], far[k / 3], samples, found,
                 least);
    }
}

/* Half of the light behind a near blocker, half behind one four times as far. */
static void test_two_halves(void **state) {
  (void)state;
  static float depth[SIZE * SIZE];
  for (int i = 0; i < SIZE * SIZE; i++) depth[i] = depth_of(i % SIZE < SIZE / 2 ? 0.4 : 1.6);
  double found = mean_w(depth, 0, 0, 1.6, 16);
  if (fabs(found - 1) > 0.1) fail_msg("mean %g, not 1", found);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_one_texel_before_the_receiver),
                                     cmocka_unit_test(test_two_halves)};
  return GL_RUN("pcss_weights", tests);
}
