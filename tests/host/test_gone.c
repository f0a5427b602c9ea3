/* What hosts do to their own objects: they delete them, leave odd parameters on textures, draw depth with another
 * range, fill the stack of debug groups. It is read right or refused by a message, and no GL error is raised. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "host.h"

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT };

static host *h;
static camera view;
static depth_target target;
static pn_receiver *receiver;
static pn_light *light;

static void begin(const char *spec, cast_kind kind) {
  pn_light_desc d = host_light_desc();
  d.map_width = 64;
  d.fit = PN_FIT_VISIBLE;
  view = camera_sized(0, WIDTH, HEIGHT);
  assert_true(target_open(&target, &view));
  renderer_depth(&h->draw, &h->world, &view, &target);
  assert_int_equal(host_cast(h, kind), PN_OK);
  assert_int_equal(pn_receiver_create(h->context, &receiver), PN_OK);
  assert_int_equal(host_light(h, &d, spec, &light), PN_OK);
}

static void end(void) {
  pn_light_destroy(&light);
  pn_receiver_destroy(&receiver);
  host_uncast(h);
  target_close(&target);
}

static pn_receiver_desc description(void) { return host_receiver_desc(&view, &target); }

static pn_result update(void) { return pn_maps_update(light, h->casters, PN_GROUPS_ALL, &receiver, 1); }

static float *picture(const pn_receiver_desc *d) {
  assert_int_equal(pn_receiver_set(receiver, d), PN_OK);
  assert_int_equal(update(), PN_OK);
  assert_int_equal(pn_visibility(light, receiver), PN_OK);
  float *out = host_result(light, receiver);
  assert_non_null(out);
  return out;
}

static void check_refused(pn_result result, pn_result expected, pn_message message) {
  if (result != expected || h->log.counts[message] == 0)
    fail_msg("%s, not %s with %s: %s", pn_result_name(result), pn_result_name(expected), pn_message_name(message),
             h->log.last);
  memset(&h->log, 0, sizeof h->log);
  assert_int_equal(gl_errors(), 0);
}

/* ---- textures of the view ---------------------------------------------------------------------------------------- */

static GLuint make_color(GLenum format, int width, int height) {
  GLuint texture;
  gl.GenTextures(1, &texture);
  gl.BindTexture(GL_TEXTURE_2D, texture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, (GLint)format, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  return texture;
}

/* The same texture for a smaller window. */
static void make_smaller(GLuint texture, int depth) {
  GLenum format = depth ? GL_DEPTH_COMPONENT32F : GL_RGBA8, layout = depth ? GL_DEPTH_COMPONENT : GL_RGBA;
  gl.BindTexture(GL_TEXTURE_2D, texture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, (GLint)format, WIDTH / 2, HEIGHT, 0, layout, GL_FLOAT, NULL);
  gl.BindTexture(GL_TEXTURE_2D, 0);
}

/* Depth, normals, mask: each deleted after pn_receiver_set; each with another size. */
static void test_deleted(void **state) {
  h = *state;
  for (int k = 0; k < 3; k++)
    for (int anew = 0; anew < 2; anew++) {
      begin("pcss", CAST_MEMORY);
      GLuint normals = make_color(GL_RGBA8, WIDTH, HEIGHT), mask = make_color(GL_RGBA8, WIDTH, HEIGHT);
      pn_receiver_desc d = description();
      d.normal_texture = normals, d.mask_texture = mask;
      float *before = picture(&d);
      GLuint *which[3] = {&target.depth, &normals, &mask};
      if (anew) make_smaller(*which[k], k == 0);
      else gl.DeleteTextures(1, which[k]);
      check_refused(pn_visibility(light, receiver), PN_ERROR_NOT_READY, PN_MESSAGE_RECEIVER_SOURCE);
      /* Bounds look at depth and at the mask. */
      if (k != 1) check_refused(update(), PN_ERROR_NOT_READY, PN_MESSAGE_RECEIVER_SOURCE);
      float *after = host_result(light, receiver);
      assert_memory_equal(before, after, PIXELS * sizeof *after);
      free(before), free(after);
      gl.DeleteTextures(1, &normals);
      gl.DeleteTextures(1, &mask);
      end();
    }
}

/* Depth as an earlier range of the host's stored it. */
static void test_depth_range(void **state) {
  static const float ranges[][2] = {{0, 1}, {0, 0.5f}, {0.25f, 0.75f}, {1, 0}, {0.9f, 0.1f}};
  float *expected = NULL;
  h = *state;
  for (int i = 0; i < 5; i++) {
    begin("pcss", CAST_MEMORY);
    int turned = ranges[i][0] > ranges[i][1];
    camera drawn = view;
    drawn.reversed = turned; /* which depth is cleared to, and how it is compared */
    gl.DepthRange(ranges[i][0], ranges[i][1]);
    renderer_depth(&h->draw, &h->world, &drawn, &target);
    gl.DepthRange(0, 1);
    pn_receiver_desc d = description();
    memcpy(d.depth_range, ranges[i], sizeof d.depth_range);
    d.reversed_depth = turned;
    float *image = picture(&d);
    int differ = 0;
    for (int p = 0; p < PIXELS && expected; p++)
      differ += image[p] - expected[p] > 0.1f || image[p] - expected[p] < -0.1f;
    if (differ > PIXELS / 500) fail_msg("depth range %g, %g: %d pixels differ", ranges[i][0], ranges[i][1], differ);
    if (expected) free(image);
    else expected = image;
    end();
  }
  free(expected);
  begin("pcss", CAST_MEMORY);
  pn_receiver_desc d = description();
  d.depth_range[0] = d.depth_range[1] = 0.5f;
  check_refused(pn_receiver_set(receiver, &d), PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_RANGE);
  d.depth_range[1] = 1.5f;
  check_refused(pn_receiver_set(receiver, &d), PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_RANGE);
  end();
}

/* With glClipControl's upper-left origin the picture stands on its head, and so does the result. */
static void test_upper_left(void **state) {
  h = *state;
  if (!gl.ClipControl) skip();
  begin("pcss", CAST_MEMORY);
  pn_receiver_desc d = description();
  float *expected = picture(&d);
  gl.ClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  renderer_depth(&h->draw, &h->world, &view, &target);
  gl.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  for (int i = 1; i < 16; i += 4) d.projection[i] = -d.projection[i];
  float *turned = picture(&d);
  int differ = 0;
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      float off = turned[y * WIDTH + x] - expected[(HEIGHT - 1 - y) * WIDTH + x];
      differ += off > 0.1f || off < -0.1f;
    }
  if (differ > PIXELS / 500) fail_msg("%d pixels differ", differ);
  free(expected), free(turned);
  end();
}

/* Rectangles, arrays, integers. */
static void test_kinds(void **state) {
  GLuint textures[3];
  h = *state;
  begin("pcss", CAST_MEMORY);
  gl.GenTextures(3, textures);
  gl.BindTexture(GL_TEXTURE_RECTANGLE, textures[0]);
  gl.TexImage2D(GL_TEXTURE_RECTANGLE, 0, GL_DEPTH_COMPONENT24, WIDTH, HEIGHT, 0, GL_DEPTH_COMPONENT, GL_FLOAT, NULL);
  gl.BindTexture(GL_TEXTURE_RECTANGLE, 0);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, textures[1]);
  gl.TexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RGBA8, WIDTH, HEIGHT, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, 0);
  gl.BindTexture(GL_TEXTURE_2D, textures[2]);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8UI, WIDTH, HEIGHT, 0, GL_RGBA_INTEGER, GL_UNSIGNED_BYTE, NULL);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  for (int i = 0; i < 3; i++) {
    pn_receiver_desc d = description();
    d.depth_texture = textures[i];
    check_refused(pn_receiver_set(receiver, &d), PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_DEPTH);
    d = description();
    d.normal_texture = textures[i];
    check_refused(pn_receiver_set(receiver, &d), PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_NORMAL);
    d = description();
    d.mask_texture = textures[i];
    check_refused(pn_receiver_set(receiver, &d), PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_MASK);
    pn_mesh added;
    pn_mesh_desc m = host_mesh_desc(h, SCENE_FLAG, CAST_MEMORY);
    m.alpha_texture = textures[i];
    check_refused(pn_mesh_add(h->casters, &m, &added), PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_ALPHA);
  }
  gl.DeleteTextures(3, textures);
  end();
}

/* A view that is wider than the framebuffer it is copied from. */
static void test_framebuffer_size(void **state) {
  h = *state;
  for (int i = 0; i < CAMERA_COUNT; i++) {
    camera c = camera_sized(i, WIDTH, HEIGHT);
    if (!c.renderbuffer || gl_version() < 45) continue;
    begin("pcss", CAST_MEMORY);
    depth_target copied;
    assert_true(target_open(&copied, &c));
    pn_receiver_desc d = host_receiver_desc(&c, &copied);
    assert_int_equal(pn_receiver_set(receiver, &d), PN_OK);
    d.width += c.target_width;
    check_refused(pn_receiver_set(receiver, &d), PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_VIEW);
    target_close(&copied);
    end();
  }
}

/* What is read cannot be drawn into. */
static void test_feedback(void **state) {
  h = *state;
  begin("pcss", CAST_MEMORY);
  GLuint normals = make_color(GL_RGBA8, WIDTH, HEIGHT), mask = make_color(GL_RGBA8, WIDTH, HEIGHT);
  pn_receiver_desc d = description();
  pn_image image;
  d.normal_texture = normals, d.mask_texture = mask;
  free(picture(&d));
  check_refused(pn_visibility_into(light, receiver, &(pn_target){.texture = normals}), PN_ERROR_ARGUMENT,
                PN_MESSAGE_RESULT_TARGET);
  check_refused(pn_visibility_into(light, receiver, &(pn_target){.texture = mask}), PN_ERROR_ARGUMENT,
                PN_MESSAGE_RESULT_TARGET);
  for (int i = 0; pn_debug_image(light, receiver, i, NULL, &image); i++)
    check_refused(pn_visibility_into(light, receiver, &(pn_target){.texture = image.texture}), PN_ERROR_ARGUMENT,
                  PN_MESSAGE_RESULT_TARGET);
  gl.DeleteTextures(1, &normals);
  gl.DeleteTextures(1, &mask);
  end();
}

/* ---- casters ----------------------------------------------------------------------------------------------------- */

/* Under GL's default filter a texture without mipmaps is incomplete; a host with sampler objects never notices. */
static void test_alpha_without_mipmaps(void **state) {
  float *images[2];
  h = *state;
  GLuint texture = h->draw.holes;
  gl.BindTexture(GL_TEXTURE_2D, texture);
  unsigned char texels[HOLE_TEXELS * HOLE_TEXELS * 2];
  GLuint plain;
  gl.GetTexImage(GL_TEXTURE_2D, 0, GL_RG, GL_UNSIGNED_BYTE, texels);
  gl.GenTextures(1, &plain);
  gl.BindTexture(GL_TEXTURE_2D, plain);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RG8, HOLE_TEXELS, HOLE_TEXELS, 0, GL_RG, GL_UNSIGNED_BYTE, texels);
  for (int i = 0; i < 2; i++) {
    gl.BindTexture(GL_TEXTURE_2D, plain);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, i ? GL_LINEAR : GL_NEAREST_MIPMAP_LINEAR);
    gl.BindTexture(GL_TEXTURE_2D, 0);
    begin("pcss", CAST_MEMORY);
    host_uncast(h);
    h->draw.holes = plain; /* for the casters alone: the camera's depth is drawn */
    assert_int_equal(host_cast(h, CAST_MEMORY), PN_OK);
    h->draw.holes = texture;
    pn_receiver_desc d = description();
    images[i] = picture(&d);
    end();
  }
  assert_memory_equal(images[0], images[1], PIXELS * sizeof(float));
  free(images[0]), free(images[1]);
  gl.DeleteTextures(1, &plain);
}

static void test_alpha_deleted(void **state) {
  h = *state;
  for (int k = 0; k < 2; k++) {
    GLuint texture = h->draw.holes, copy = make_color(GL_RGBA8, 8, 8);
    h->draw.holes = copy;
    begin(k ? "average:samples=4" : "pcss", CAST_MEMORY);
    h->draw.holes = texture;
    pn_receiver_desc d = description();
    float *before = picture(&d);
    gl.DeleteTextures(1, &copy);
    pn_result result = k ? pn_visibility(light, receiver) : update();
    check_refused(result, PN_ERROR_NOT_READY, PN_MESSAGE_MESH_ALPHA);
    float *after = host_result(light, receiver);
    assert_memory_equal(before, after, PIXELS * sizeof *after);
    free(before), free(after);
    end();
  }
}

/* Edges are read back from buffers. */
static void test_buffers_deleted(void **state) {
  h = *state;
  GLuint buffer, index;
  float positions[9] = {-0.5f, 1, -0.5f, 0.5f, 1, -0.5f, 0, 1, 0.5f};
  uint32_t indices[3] = {0, 1, 2};
  static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  begin("smoothies", CAST_MEMORY);
  gl.GenBuffers(1, &buffer);
  gl.GenBuffers(1, &index);
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
  gl.BufferData(GL_ARRAY_BUFFER, sizeof positions, positions, GL_STATIC_DRAW);
  gl.BindBuffer(GL_ARRAY_BUFFER, index);
  gl.BufferData(GL_ARRAY_BUFFER, sizeof indices, indices, GL_STATIC_DRAW);
  gl.BindBuffer(GL_ARRAY_BUFFER, 0);
  pn_mesh_desc d = {.positions = {.buffer = buffer, .count = 3},
                    .indices = {.buffer = index, .count = 3},
                    .index_bytes = 4,
                    .bounds_min = {-1, 0, -1},
                    .bounds_max = {1, 2, 1}};
  pn_mesh added;
  assert_int_equal(pn_mesh_add(h->casters, &d, &added), PN_OK);
  assert_int_equal(pn_instance_add(h->casters, added, identity, 0, NULL), PN_OK);
  pn_receiver_desc r = description();
  assert_int_equal(pn_receiver_set(receiver, &r), PN_OK);
  gl.DeleteBuffers(1, &buffer);
  check_refused(update(), PN_ERROR_NOT_READY, PN_MESSAGE_MESH_POSITIONS);
  gl.DeleteBuffers(1, &index);
  end();
}

/* A message says which buffer, how large it is and how large it would have to be. */
static void test_message(void **state) {
  h = *state;
  begin("pcss", CAST_MEMORY);
  GLuint buffer;
  char name[32];
  pn_mesh added;
  gl.GenBuffers(1, &buffer);
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
  gl.BufferData(GL_ARRAY_BUFFER, 100, NULL, GL_STATIC_DRAW);
  gl.BindBuffer(GL_ARRAY_BUFFER, 0);
  pn_mesh_desc d = {.positions = {.buffer = buffer, .offset = 4, .stride = 16, .count = 9}, .bounds_max = {1, 1, 1}};
  assert_int_equal(pn_mesh_add(h->casters, &d, &added), PN_ERROR_ARGUMENT);
  snprintf(name, sizeof name, "buffer %u", buffer);
  assert_non_null(strstr(h->log.last, name));
  assert_non_null(strstr(h->log.last, "100"));
  assert_non_null(strstr(h->log.last, "144")); /* 4 + 8 * 16 + 12 */
  check_refused(PN_ERROR_ARGUMENT, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_POSITIONS);
  gl.DeleteBuffers(1, &buffer);
  end();
}

/* ---- state ------------------------------------------------------------------------------------------------------- */

static GLuint host_program(void) {
  static const char *const vertex[] = {"#version 330 core\nvoid main() { gl_Position = vec4(0); }\n"};
  static const char *const fragment[] = {"#version 330 core\nvoid main() {}\n"};
  return compile_program(vertex, 1, fragment, 1);
}

/* A program that is deleted while it is current goes when the library binds its own. */
static void test_program_deleted(void **state) {
  h = *state;
  begin("pcss", CAST_MEMORY);
  pn_receiver_desc d = description();
  free(picture(&d));
  GLuint program = host_program();
  gl.UseProgram(program);
  gl.DeleteProgram(program);
  assert_int_equal(pn_visibility(light, receiver), PN_OK);
  assert_int_equal(gl_errors(), 0);
  gl.UseProgram(0);
  end();
}

/* In another context of the library's, of that mode, a frame between two brackets, with everything that the host has
 * bound deleted in it. */
static void test_deleted_in_scope(void **state) {
  host *self = *state;
  host other = *self;
  pn_context_desc desc = host_context_desc(self);
  desc.state = PN_STATE_SCOPED;
  assert_int_equal(pn_context_create(&desc, &other.context), PN_OK);
  h = &other;
  begin("pcss", CAST_MEMORY);
  pn_receiver_desc d = description();
  free(picture(&d)); /* outside of a bracket: the library's own objects stay bound */
  GLuint program = host_program(), array, buffer, framebuffer, texture = make_color(GL_RGBA8, 4, 4), sampler;
  for (int k = 0; k < 2; k++) {
    if (k) {
      gl.GenVertexArrays(1, &array);
      gl.GenBuffers(1, &buffer);
      gl.GenFramebuffers(1, &framebuffer);
      gl.GenSamplers(1, &sampler);
      gl.UseProgram(program);
      gl.BindVertexArray(array);
      for (int i = 0; i < 4; i++) {
        static const GLenum targets[4] = {GL_ARRAY_BUFFER, GL_UNIFORM_BUFFER, GL_PIXEL_PACK_BUFFER,
                                          GL_PIXEL_UNPACK_BUFFER};
        gl.BindBuffer(targets[i], buffer);
      }
      gl.BufferData(GL_ARRAY_BUFFER, 256, NULL, GL_STATIC_DRAW);
      gl.BindBufferRange(GL_UNIFORM_BUFFER, 0, buffer, 0, 64);
      gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
      gl.BindTexture(GL_TEXTURE_2D, texture);
      gl.BindSampler(0, sampler);
    }
    assert_int_equal(pn_state_begin(other.context), PN_OK);
    if (!k) assert_int_equal(pn_reload_shaders(other.context), PN_OK);
    assert_int_equal(pn_visibility(light, receiver), PN_OK);
    if (k) {
      gl.DeleteProgram(program);
      gl.DeleteVertexArrays(1, &array);
      gl.DeleteBuffers(1, &buffer);
      gl.DeleteFramebuffers(1, &framebuffer);
      gl.DeleteTextures(1, &texture);
      gl.DeleteSamplers(1, &sampler);
    } else {
      pn_maps_update(light, other.casters, PN_GROUPS_ALL, &receiver, 1);
    }
    assert_int_equal(pn_visibility(light, receiver), PN_OK);
    assert_int_equal(pn_state_end(other.context), PN_OK);
    assert_int_equal(gl_errors(), 0);
  }
  end();
  pn_context_destroy(&other.context);
  assert_int_equal(gl_errors(), 0);
}

/* The host's stack of debug groups is full, or becomes so between two calls. */
static void test_groups(void **state) {
  host *self = *state;
  if (!gl.PushDebugGroup) skip();
  for (int mode = PN_STATE_RESTORE; mode <= PN_STATE_RESET; mode++) {
    host other = *self;
    GLint most = 0;
    pn_context_desc desc = host_context_desc(self);
    desc.state = (pn_state_mode)mode;
    assert_int_equal(pn_context_create(&desc, &other.context), PN_OK);
    h = &other;
    begin("pcss", CAST_MEMORY);
    pn_receiver_desc d = description();
    free(picture(&d));
    gl.GetIntegerv(GL_MAX_DEBUG_GROUP_STACK_DEPTH, &most);
    for (int i = 1; i < most; i++) gl.PushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 1, 1, "g");
    assert_int_equal(gl_errors(), 0);
    free(picture(&d));
    assert_int_equal(gl_errors(), 0);
    for (int i = 1; i < most; i++) gl.PopDebugGroup();
    assert_int_equal(gl_errors(), 0);
    end();
    pn_context_destroy(&other.context);
  }
}

/* ---- what one text stood for many -------------------------------------------------------------------------------- */

static void test_small_things(void **state) {
  h = *state;
  begin("pcss", CAST_MEMORY);
  pn_receiver *const none[1] = {NULL};
  check_refused(pn_maps_update(light, h->casters, PN_GROUPS_ALL, none, 1), PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT);
  check_refused(pn_debug(h->context, 4), PN_ERROR_ARGUMENT, PN_MESSAGE_DEBUG_FLAGS);
  pn_light_desc d = host_light_desc();
  d.fit = PN_FIT_GIVEN;
  check_refused(pn_light_set(light, &d), PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FIT);
  d = host_light_desc();
  d.half_u = 1e30f;
  check_refused(pn_light_set(light, &d), PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_SIZE);
  end();
}

int main(void) {
#define TEST(f) cmocka_unit_test_teardown(f, host_check)
  const struct CMUnitTest tests[] = {TEST(test_deleted),
                                     TEST(test_depth_range),
                                     TEST(test_upper_left),
                                     TEST(test_kinds),
                                     TEST(test_framebuffer_size),
                                     TEST(test_feedback),
                                     TEST(test_alpha_without_mipmaps),
                                     TEST(test_alpha_deleted),
                                     TEST(test_buffers_deleted),
                                     TEST(test_message),
                                     TEST(test_program_deleted),
                                     TEST(test_deleted_in_scope),
                                     TEST(test_groups),
                                     TEST(test_small_things)};
  return cmocka_run_group_tests_name("gone", tests, host_setup, host_teardown);
}
