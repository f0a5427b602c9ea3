/* The receiver's options: reduced resolution, normals in every encoding, a mask, formats, and a result in the host's
 * texture. */
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
static pn_light *light;
static float *baseline;
static unsigned char *skip_pixel;

static float *image_with(const pn_receiver_desc *desc) {
  assert_int_equal(pn_receiver_set(v.receiver, desc), PN_OK);
  assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
  float *image = host_result(light, v.receiver);
  assert_non_null(image);
  return image;
}

static pn_receiver_desc plain(void) { return host_receiver_desc(&v.view, &v.target); }

/* At 1/2 and 1/4 the picture is the same within 0.02 on average, and flat faces that see the whole light stay exactly
 * 1. */
static void test_scale(void **state) {
  (void)state;
  pn_light_desc light_desc = host_light_desc();
  pn_maps_info maps;
  assert_int_equal(pn_light_maps(light, &maps), PN_OK);
  truth_light truth = truth_light_of(&light_desc, &maps);
  for (int scale = 2; scale <= 4; scale *= 2) {
    pn_receiver_desc desc = plain();
    desc.scale = scale;
    float *image = image_with(&desc);
    save_picture(scale == 2 ? "scale-2" : "scale-4", image, CAMERA_WIDTH, CAMERA_HEIGHT);
    double sum = 0;
    int surface = 0, lit = 0, wrong = 0;
    for (int i = 0; i < PIXELS; i++) {
      int object = (int)seen.position[4 * i + 3], x = i % CAMERA_WIDTH, y = i / CAMERA_WIDTH;
      if (object < 0) {
        assert_true(image[i] == 1);
        continue;
      }
      surface++;
      sum += fabs((double)image[i] - baseline[i]);
      if (x % 5 || y % 5 || (object != SCENE_FLOOR && object != SCENE_BOX) || !truth_plane_known(&seen, x, y)) continue;
      /* Samples of reduced resolution lie up to 1.5 scale pixels away: the baseline has to be lit all around. */
      if (local_range(baseline, CAMERA_WIDTH, CAMERA_HEIGHT, x, y, 2 * scale) > 0) continue;
      if (!truth_sees_all(&truth, &h.world, v3_of(seen.position + 4 * i), v3_of(seen.normal + 3 * i))) continue;
      lit++;
      wrong += image[i] != 1;
    }
    printf("scale %d: mean difference %.4f on surfaces; %d of %d lit pixels below 1\n", scale, sum / surface, wrong,
           lit);
    assert_true(sum / surface < 0.02);
    assert_true(lit > 100);
    assert_int_equal(wrong, 0);
    free(image);
  }
}

/* Octahedral map of a unit vector. */
static void octahedron(const float n[3], float out[2]) {
  float sum = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]), x = n[0] / sum, y = n[1] / sum;
  if (n[2] < 0) {
    float old = x;
    x = (1 - fabsf(y)) * (x < 0 ? -1.0f : 1.0f);
    y = (1 - fabsf(old)) * (y < 0 ? -1.0f : 1.0f);
  }
  out[0] = x, out[1] = y;
}

static GLuint normal_texture(pn_normal_encoding encoding, int in_view) {
  float *data = calloc(PIXELS * 4, sizeof *data);
  assert_non_null(data);
  const float *m = v.view.view;
  for (int i = 0; i < PIXELS; i++) {
    const float *s = seen.normal + 3 * i;
    float n[3] = {s[0], s[1], s[2]}, *out = data + 4 * i;
    if (seen.position[4 * i + 3] < 0) n[0] = n[1] = 0, n[2] = 1;
    if (in_view) {
      float e[3];
      for (int k = 0; k < 3; k++) e[k] = m[k] * n[0] + m[4 + k] * n[1] + m[8 + k] * n[2];
      memcpy(n, e, sizeof n);
    }
    if (encoding == PN_NORMAL_SIGNED) {
      /* Either sign and any length will do. */
      for (int k = 0; k < 3; k++) out[k] = (i % 2 ? -3.0f : 0.5f) * n[k];
    } else if (encoding == PN_NORMAL_UNSIGNED) {
      for (int k = 0; k < 3; k++) out[k] = 0.5f * n[k] + 0.5f;
    } else {
      octahedron(n, out);
      if (encoding == PN_NORMAL_OCTAHEDRON_UNSIGNED) out[0] = 0.5f * out[0] + 0.5f, out[1] = 0.5f * out[1] + 0.5f;
    }
  }
  GLuint texture = 0;
  gl.GenTextures(1, &texture);
  gl.BindTexture(GL_TEXTURE_2D, texture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, CAMERA_WIDTH, CAMERA_HEIGHT, 0, GL_RGBA, GL_FLOAT, data);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  free(data);
  return texture;
}

/* With the true normals the picture is the one whose planes came from depth: on flat faces only the rejection of
 * blockers next to the plane could differ. */
static void test_normals(void **state) {
  (void)state;
  double delta = view_error(&v.view, &seen), sample = 1.0 / 64;
  for (int k = 0; k < 8; k++) {
    pn_receiver_desc desc = plain();
    desc.normal_encoding = (pn_normal_encoding)(k / 2);
    desc.normal_in_view = k % 2;
    desc.normal_texture = normal_texture(desc.normal_encoding, k % 2);
    float *image = image_with(&desc);
    agreement a = agree(baseline, CAMERA_WIDTH, CAMERA_HEIGHT, 0, 0, image, CAMERA_WIDTH, CAMERA_HEIGHT, skip_pixel);
    printf("encoding %d, %s: %d pixels differ, mean %.2g, worst %.2g\n", k / 2, k % 2 ? "eye" : "scene", a.differing,
           a.sum / a.pixels, a.worst);
    assert_true(a.sum / sample <= allowed_changes(a.range * delta / sample));
    gl.DeleteTextures(1, &desc.normal_texture);
    free(image);
  }
}

/* Where the mask is 0 visibility is 1; elsewhere nothing changes. */
static void test_mask(void **state) {
  (void)state;
  unsigned char *data = malloc(PIXELS);
  GLuint texture = 0;
  assert_non_null(data);
  for (int i = 0; i < PIXELS; i++) data[i] = (i / 7 + i / CAMERA_WIDTH) % 2 ? 255 : 0;
  gl.GenTextures(1, &texture);
  gl.BindTexture(GL_TEXTURE_2D, texture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, CAMERA_WIDTH, CAMERA_HEIGHT, 0, GL_RED, GL_UNSIGNED_BYTE, data);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  pn_receiver_desc desc = plain();
  desc.mask_texture = texture;
  float *image = image_with(&desc);
  for (int i = 0; i < PIXELS; i++) assert_true(image[i] == (data[i] ? baseline[i] : 1));
  gl.DeleteTextures(1, &texture);
  free(image), free(data);
}

/* Stored with less precision: within half a step, and 1 stays 1. */
static void test_formats(void **state) {
  (void)state;
  static const struct {
    pn_format format;
    GLenum internal;
    double step;
  } formats[] = {{PN_FORMAT_R16F, GL_R16F, 1.0 / 2048}, {PN_FORMAT_R32F, GL_R32F, 0}, {PN_FORMAT_R8, GL_R8, 1.0 / 255}};
  for (int k = 0; k < 3; k++) {
    pn_receiver_desc desc = plain();
    pn_image info;
    desc.format = formats[k].format;
    float *image = image_with(&desc);
    assert_int_equal(pn_result_image(light, v.receiver, &info), PN_OK);
    assert_int_equal(info.format, formats[k].internal);
    assert_int_equal(info.width, CAMERA_WIDTH);
    assert_int_equal(info.height, CAMERA_HEIGHT);
    assert_int_equal(info.channels, 1);
    for (int i = 0; i < PIXELS; i++) {
      /* Rounding to the nearest, or towards zero, which GL allows too. */
      assert_true(fabs((double)image[i] - baseline[i]) <= formats[k].step);
      assert_true((baseline[i] == 1) <= (image[i] == 1));
    }
    free(image);
  }
}

/* The same bits in the host's own texture; what lies beyond the view stays. */
static void test_into(void **state) {
  (void)state;
  enum { W = CAMERA_WIDTH + 5, HEIGHT = CAMERA_HEIGHT + 3 };
  float *data = malloc(2 * W * HEIGHT * sizeof *data);
  GLuint texture = 0;
  assert_non_null(data);
  for (int i = 0; i < 2 * W * HEIGHT; i++) data[i] = 7;
  gl.GenTextures(1, &texture);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, texture);
  gl.TexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_R32F, W, HEIGHT, 2, 0, GL_RED, GL_FLOAT, data);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, 0);
  pn_receiver_desc desc = plain();
  assert_int_equal(pn_receiver_set(v.receiver, &desc), PN_OK);
  assert_int_equal(pn_visibility_into(light, v.receiver, &(pn_target){texture, 1, 0}), PN_OK);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, texture);
  gl.GetTexImage(GL_TEXTURE_2D_ARRAY, 0, GL_RED, GL_FLOAT, data);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, 0);
  for (int i = 0; i < 2 * W * HEIGHT; i++) {
    int x = i % W, y = i / W % HEIGHT, inside = i >= W * HEIGHT && x < CAMERA_WIDTH && y < CAMERA_HEIGHT;
    assert_true(data[i] == (inside ? baseline[y * CAMERA_WIDTH + x] : 7));
  }
  gl.DeleteTextures(1, &texture);
  free(data);
}

/* The host's depth texture compares, as a shadow map would, and is bound with mipmaps it does not have: the numbers are
 * read all the same, and its parameters stay. */
static void test_compare_mode(void **state) {
  (void)state;
  GLint mode = 0, filter = 0;
  gl.BindTexture(GL_TEXTURE_2D, v.target.depth);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  pn_receiver_desc desc = plain();
  float *image = image_with(&desc);
  gl.BindTexture(GL_TEXTURE_2D, v.target.depth);
  gl.GetTexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, &mode);
  gl.GetTexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, &filter);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_NONE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  assert_int_equal(mode, GL_COMPARE_REF_TO_TEXTURE);
  assert_int_equal(filter, GL_LINEAR_MIPMAP_LINEAR);
  assert_memory_equal(image, baseline, PIXELS * sizeof *image);
  free(image);
}

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  pn_light_desc desc = host_light_desc();
  camera view = camera_at(0);
  if (host_context(&h) != PN_OK || host_cast(&h, CAST_MEMORY) != PN_OK) return -1;
  if (host_light(&h, &desc, "pcss", &light) != PN_OK || host_view(&h, &view, &v) != PN_OK) return -1;
  baseline = host_visibility(&h, light, &v);
  skip_pixel = calloc(PIXELS, 1);
  if (!baseline || dark_pixels(baseline, CAMERA_WIDTH, CAMERA_HEIGHT) < 1000) return -1;
  if (!skip_pixel || !surfaces_draw(&seen, &h.draw, &h.world, &view)) return -1;
  for (int i = 0; i < PIXELS; i++) {
    skip_pixel[i] = seen.position[4 * i + 3] >= 0 && !truth_plane_known(&seen, i % CAMERA_WIDTH, i / CAMERA_WIDTH);
  }
  return 0;
}

static int teardown(void **state) {
  (void)state;
  free(baseline), free(skip_pixel);
  surfaces_free(&seen);
  host_view_close(&v);
  host_close(&h);
  return 0;
}

int main(void) {
#define TEST(f) cmocka_unit_test_teardown(f, host_check)
  const struct CMUnitTest tests[] = {TEST(test_scale),   TEST(test_normals), TEST(test_mask),
                                     TEST(test_formats), TEST(test_into),    TEST(test_compare_mode)};
  return cmocka_run_group_tests_name("receiver", tests, setup, teardown);
}
