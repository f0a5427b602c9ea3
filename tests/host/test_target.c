/* Results in the host's own textures: four lights share one, channel by channel, and what a channel gets is the light's
 * own result. */
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

/* The texture is larger than the view. */
enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT, WIDE = WIDTH + 5, HIGH = HEIGHT + 3, TEXELS = WIDE * HIGH };
enum { LIGHTS = 4, LAYERS = 3 };

static host h;
static camera_view views[2]; /* at scale 1 and 2 */

/* ---- textures ---------------------------------------------------------------------------------------------------- */

typedef struct {
  GLuint name;
  GLenum format;
  int layers; /* 0: 2D */
} texture;

static GLenum target_of(const texture *t) { return t->layers ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D; }

static int texture_layers(const texture *t) { return t->layers ? t->layers : 1; }

/* What is there before: unlike any result, and exact in every format. */
static float before(int channel) { return channel % 2 ? 1 : 0; }

static texture make_target(GLenum format, int layers) {
  texture t = {.format = format, .layers = layers};
  size_t numbers = 4 * (size_t)TEXELS * (size_t)texture_layers(&t);
  float *texels = malloc(numbers * sizeof *texels);
  assert_non_null(texels);
  for (size_t i = 0; i < numbers; i++) texels[i] = before((int)(i % 4));
  gl.GenTextures(1, &t.name);
  gl.BindTexture(target_of(&t), t.name);
  gl.TexParameteri(target_of(&t), GL_TEXTURE_MAX_LEVEL, 0);
  if (layers) gl.TexImage3D(target_of(&t), 0, (GLint)format, WIDE, HIGH, layers, 0, GL_RGBA, GL_FLOAT, texels);
  else gl.TexImage2D(target_of(&t), 0, (GLint)format, WIDE, HIGH, 0, GL_RGBA, GL_FLOAT, texels);
  gl.BindTexture(target_of(&t), 0);
  free(texels);
  return t;
}

static float *read_target(const texture *t) {
  float *texels = malloc(4 * (size_t)TEXELS * (size_t)texture_layers(t) * sizeof *texels);
  assert_non_null(texels);
  gl.BindTexture(target_of(t), t->name);
  gl.GetTexImage(target_of(t), 0, GL_RGBA, GL_FLOAT, texels);
  gl.BindTexture(target_of(t), 0);
  return texels;
}

static void drop(texture *t) { gl.DeleteTextures(1, &t->name); }

/* How far a number in [0, 1] may be off in that format: a step where it may be cut off, half of one where it is
 * rounded. */
static float step_of(GLenum format) {
  return format == GL_RGBA32F ? 0 : format == GL_RGBA16F ? 0x1p-11f : format == GL_RGB10_A2 ? 1.0f / 1023 : 1.0f / 255;
}

/* ---- one texture, four lights ------------------------------------------------------------------------------------ */

typedef struct {
  const char *spec;
  uint32_t groups; /* 0: nothing casts */
} one_light;

static void make_lights(const one_light kinds[LIGHTS], pn_light *out[LIGHTS]) {
  for (int i = 0; i < LIGHTS; i++) {
    pn_light_desc desc = i % 2 ? host_light_desc_other() : host_light_desc();
    desc.map_width = desc.map_height = 64;
    desc.center[1] += 0.1f * (float)i;
    assert_int_equal(host_light(&h, &desc, kinds[i].spec, &out[i]), PN_OK);
    assert_int_equal(pn_maps_update(out[i], h.casters, kinds[i].groups, NULL, 0), PN_OK);
  }
}

/* expected[i]: of light i, NULL: not drawn yet. What is outside of the view, of the layer, of the channels stays. */
static void check_texels(const texture *t, int layer, float *const expected[LIGHTS], const char *when) {
  float *texels = read_target(t);
  int wrong = 0;
  for (int k = 0; k < texture_layers(t); k++) {
    for (int i = 0; i < 4 * TEXELS; i++) {
      int channel = i % 4, x = i / 4 % WIDE, y = i / 4 / WIDE;
      int drawn = k == layer && x < WIDTH && y < HEIGHT && expected[channel];
      float want = drawn ? expected[channel][y * WIDTH + x] : before(channel);
      float got = texels[4 * TEXELS * k + i];
      /* Two bits of alpha say little of a shadow. */
      if (drawn && t->format == GL_RGB10_A2 && channel == 3) continue;
      if (fabsf(got - want) <= (drawn ? step_of(t->format) : 0)) continue;
      if (wrong++ < 4)
        fprintf(stderr, "%s, layer %d, %d,%d, channel %d: %g instead of %g\n", when, k, x, y, channel, got, want);
    }
  }
  free(texels);
  assert_int_equal(wrong, 0);
}

static void check_four(const one_light kinds[LIGHTS], int scale, GLenum format, int layers) {
  texture t = make_target(format, layers);
  pn_receiver *receiver = views[scale / 2].receiver;
  pn_light *lights[LIGHTS];
  float *own[LIGHTS] = {0}, *drawn[LIGHTS] = {0};
  int layer = layers ? layers - 1 : 0;
  make_lights(kinds, lights);
  for (int i = 0; i < LIGHTS; i++) {
    assert_int_equal(pn_visibility(lights[i], receiver), PN_OK);
    own[i] = host_result(lights[i], receiver);
    assert_int_equal(dark_pixels(own[i], WIDTH, HEIGHT) > 50, kinds[i].groups != 0);
  }
  for (int i = 0; i < LIGHTS; i++) {
    char when[96];
    pn_target into = {t.name, layer, 1 << i};
    snprintf(when, sizeof when, "%s at scale %d, format 0x%x", kinds[i].spec, scale, format);
    assert_int_equal(pn_visibility_into(lights[i], receiver, &into), PN_OK);
    drawn[i] = own[i];
    check_texels(&t, layer, drawn, when);
    float *still = host_result(lights[i], receiver);
    assert_memory_equal(still, own[i], PIXELS * sizeof *still);
    free(still);
  }
  for (int i = 0; i < LIGHTS; i++) {
    free(own[i]);
    pn_light_destroy(&lights[i]);
  }
  drop(&t);
}

static const one_light kinds[3][LIGHTS] = {
    {{"pcss", 1}, {"ssm", 1}, {"average:samples=20", 1}, {"smoothies", 1}},
    {{"hard", 1}, {"ssm", 0}, {"bitmask", 1}, {"average:samples=20", 0}},
    {{"backprojection", 1}, {"smoothies", 0}, {"pcf", 1}, {"hard", 0}},
};

static void test_four_lights(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++)
    for (int scale = 1; scale <= 2; scale++) {
      check_four(kinds[k], scale, GL_RGBA8, 0);
      check_four(kinds[k], scale, GL_RGBA16F, LAYERS);
    }
}

static void test_other_formats(void **state) {
  (void)state;
  check_four(kinds[0], 1, GL_RGBA32F, LAYERS);
  check_four(kinds[0], 1, GL_RGBA16F, 0);
  check_four(kinds[0], 1, GL_RGBA8, LAYERS);
  check_four(kinds[0], 1, GL_RGB10_A2, 0);
}

/* The pair may have no result of its own at all; several channels get the same; 0 stands for all there are. */
static void test_channels(void **state) {
  (void)state;
  static const int masks[] = {0, 15, PN_CHANNEL_RED | PN_CHANNEL_ALPHA, PN_CHANNEL_GREEN};
  for (int k = 0; k < 4; k++) {
    texture t = make_target(GL_RGBA32F, 0);
    pn_light *light = NULL;
    pn_light_desc desc = host_light_desc();
    pn_image image;
    float *drawn[LIGHTS];
    assert_int_equal(host_light(&h, &desc, "pcss", &light), PN_OK);
    assert_int_equal(pn_maps_update(light, h.casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
    assert_int_equal(pn_visibility_into(light, views[0].receiver, &(pn_target){t.name, 0, masks[k]}), PN_OK);
    assert_int_equal(pn_result_image(light, views[0].receiver, &image), PN_ERROR_NOT_READY);
    float *own = host_visibility(&h, light, &views[0]);
    for (int i = 0; i < LIGHTS; i++) drawn[i] = !masks[k] || masks[k] >> i & 1 ? own : NULL;
    check_texels(&t, 0, drawn, "channels");
    free(own);
    pn_light_destroy(&light);
    drop(&t);
  }
}

/* ---- refused ----------------------------------------------------------------------------------------------------- */

static void refuse(pn_light *light, GLuint name, int layer, int channels) {
  int told = h.log.counts[PN_MESSAGE_RESULT_TARGET];
  pn_result result = pn_visibility_into(light, views[0].receiver, &(pn_target){name, layer, channels});
  assert_int_equal(result, PN_ERROR_ARGUMENT);
  assert_int_equal(h.log.counts[PN_MESSAGE_RESULT_TARGET], told + 1);
  assert_int_equal(gl_errors(), 0);
}

static pn_light *any_light(void) {
  pn_light_desc desc = host_light_desc();
  pn_light *light = NULL;
  assert_int_equal(host_light(&h, &desc, "hard", &light), PN_OK);
  assert_int_equal(pn_maps_update(light, h.casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
  return light;
}

/* A channel that the format lacks, with one that it has or alone. */
static void test_lacking_channels(void **state) {
  (void)state;
  static const struct {
    GLenum format;
    int channels;
  } kinds_of[] = {{GL_R8, 1}, {GL_R16F, 1}, {GL_RG8, 3}, {GL_RG16F, 3}, {GL_RGBA8, 15}};
  pn_light *light = any_light();
  for (int k = 0; k < 5; k++) {
    texture t = make_target(kinds_of[k].format, 0);
    for (int channels = 1; channels < 32; channels++) {
      if (channels & ~kinds_of[k].channels) refuse(light, t.name, 0, channels);
      else assert_int_equal(pn_visibility_into(light, views[0].receiver, &(pn_target){t.name, 0, channels}), PN_OK);
    }
    refuse(light, t.name, 0, -1);
    refuse(light, t.name, 1, 0);
    drop(&t);
  }
  pn_light_destroy(&light);
}

static void test_integers(void **state) {
  (void)state;
  static const GLenum formats[] = {GL_R8UI, GL_R32I, GL_RGBA8UI, GL_RGBA16I, GL_RGBA32UI};
  pn_light *light = any_light();
  for (int k = 0; k < 5; k++) {
    GLuint name = 0;
    gl.GenTextures(1, &name);
    gl.BindTexture(GL_TEXTURE_2D, name);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    GLenum layout = k < 2 ? GL_RED_INTEGER : GL_RGBA_INTEGER;
    gl.TexImage2D(GL_TEXTURE_2D, 0, (GLint)formats[k], WIDE, HIGH, 0, layout, GL_UNSIGNED_BYTE, NULL);
    gl.BindTexture(GL_TEXTURE_2D, 0);
    refuse(light, name, 0, 0);
    refuse(light, name, 0, PN_CHANNEL_RED);
    gl.DeleteTextures(1, &name);
  }
  pn_light_destroy(&light);
}

static void define_texture(GLenum target) {
  if (target == GL_TEXTURE_2D_MULTISAMPLE) gl.TexImage2DMultisample(target, 4, GL_RGBA8, WIDE, HIGH, GL_TRUE);
  else if (target == GL_TEXTURE_3D) gl.TexImage3D(target, 0, GL_RGBA8, WIDE, HIGH, 4, 0, GL_RGBA, GL_FLOAT, NULL);
  else if (target == GL_TEXTURE_CUBE_MAP)
    for (GLenum face = 0; face < 6; face++)
      gl.TexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, 0, GL_RGBA8, 128, 128, 0, GL_RGBA, GL_FLOAT, NULL);
  else gl.TexImage2D(target, 0, GL_RGBA8, WIDE, HIGH, 0, GL_RGBA, GL_FLOAT, NULL);
  if (target != GL_TEXTURE_2D_MULTISAMPLE && target != GL_TEXTURE_RECTANGLE)
    gl.TexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
}

static GLuint make_of_kind(GLenum target) {
  GLuint name = 0;
  gl.GenTextures(1, &name);
  gl.BindTexture(target, name);
  define_texture(target);
  gl.BindTexture(target, 0);
  assert_int_equal(gl_errors(), 0);
  return name;
}

/* The texture in every place of the interface where one is taken, but for a multisampled depth, which would be right.
 * */
static int refused_everywhere(pn_light *light, GLuint name) {
  pn_receiver_desc companion = host_receiver_desc(&views[0].view, &views[0].target), depth = companion;
  pn_mesh_desc alpha = host_mesh_desc(&h, SCENE_FLAG, CAST_MEMORY);
  pn_mesh added;
  depth.depth_texture = companion.normal_texture = alpha.alpha_texture = name;
  pn_result results[5] = {pn_visibility_into(light, views[0].receiver, &(pn_target){name, 0, 0}),
                          pn_receiver_set(views[0].receiver, &depth), pn_receiver_set(views[0].receiver, &companion),
                          pn_mesh_add(h.casters, &alpha, &added)};
  companion.normal_texture = 0, companion.mask_texture = name;
  results[4] = pn_receiver_set(views[0].receiver, &companion);
  int refused = 0;
  for (int i = 0; i < 5; i++) refused += results[i] == PN_ERROR_ARGUMENT;
  return refused == 5;
}

/* Textures that are neither 2D nor a 2D array; and names that are none. Which of them a texture is can be asked for
 * from OpenGL 4.5 on. */
static void test_other_targets(void **state) {
  (void)state;
  static const GLenum targets[] = {GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_3D, GL_TEXTURE_CUBE_MAP, GL_TEXTURE_1D_ARRAY,
                                   GL_TEXTURE_RECTANGLE};
  pn_light *light = any_light();
  int wrong = 0;
  for (int k = 0; k < 5 && (gl_version() >= 45 || gl_has("GL_ARB_direct_state_access")); k++) {
    GLuint name = make_of_kind(targets[k]);
    int refused = refused_everywhere(light, name), errors = gl_errors();
    if (!refused || errors) {
      fprintf(stderr, "target 0x%x: %s, %d GL errors\n", targets[k], refused ? "refused" : "taken", errors);
      wrong++;
    }
    gl.DeleteTextures(1, &name);
  }
  assert_int_equal(wrong, 0);
  GLuint deleted = 0;
  gl.GenTextures(1, &deleted);
  refuse(light, deleted, 0, 0); /* a name without a texture */
  gl.DeleteTextures(1, &deleted);
  refuse(light, deleted, 0, 0);
  refuse(light, 0, 0, 0);
  pn_light_destroy(&light);
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  camera view = camera_sized(0, WIDTH, HEIGHT);
  if (host_context(&h) != PN_OK || host_cast(&h, CAST_MEMORY) != PN_OK) return -1;
  for (int i = 0; i < 2; i++) {
    if (host_view(&h, &view, &views[i]) != PN_OK) return -1;
    pn_receiver_desc desc = host_receiver_desc(&view, &views[i].target);
    desc.scale = i + 1;
    if (pn_receiver_set(views[i].receiver, &desc) != PN_OK) return -1;
  }
  return gl_errors();
}

static int teardown(void **state) {
  (void)state;
  host_uncast(&h);
  for (int i = 0; i < 2; i++) host_view_close(&views[i]);
  host_close(&h);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_four_lights, host_check),
      cmocka_unit_test_teardown(test_other_formats, host_check),
      cmocka_unit_test_teardown(test_channels, host_check),
      cmocka_unit_test_teardown(test_lacking_channels, host_check),
      cmocka_unit_test_teardown(test_integers, host_check),
      cmocka_unit_test_teardown(test_other_targets, host_check),
  };
  return cmocka_run_group_tests_name("target", tests, setup, teardown);
}
