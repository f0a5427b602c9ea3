/* Pictures read back as they were written. */
#include <math.h>
#include <openexr.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "files/image.h"
#include "files/label.h"
#include "base/names.h"

enum { W = 37, H = 41 };

/* Reads count channels of w x h pixels, each into its own part of out. */
static void read_exr(const char *name, int w, int h, int count, float *out) {
  exr_context_t context = NULL;
  assert_int_equal(exr_start_read(&context, name, NULL), 0);
  int32_t rows = 0;
  assert_int_equal(exr_get_scanlines_per_chunk(context, 0, &rows), 0);
  exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
  for (int y = 0; y < h; y += rows) {
    exr_chunk_info_t chunk;
    assert_int_equal(exr_read_scanline_chunk_info(context, 0, y, &chunk), 0);
    assert_int_equal(y ? exr_decoding_update(context, 0, &chunk, &pipeline)
                       : exr_decoding_initialize(context, 0, &chunk, &pipeline),
                     0);
    assert_int_equal(pipeline.channel_count, count);
    for (int c = 0; c < count; c++) {
      assert_int_equal(pipeline.channels[c].channel_name[0], (count == 1 ? "Y" : "XYZ")[c]);
      pipeline.channels[c].decode_to_ptr = (uint8_t *)&out[c * w * h + y * w];
      pipeline.channels[c].user_pixel_stride = 4;
      pipeline.channels[c].user_line_stride = 4 * w;
      pipeline.channels[c].user_bytes_per_element = 4;
      pipeline.channels[c].user_data_type = EXR_PIXEL_FLOAT;
    }
    if (!y) assert_int_equal(exr_decoding_choose_default_routines(context, 0, &pipeline), 0);
    assert_int_equal(exr_decoding_run(context, 0, &pipeline), 0);
  }
  exr_decoding_destroy(context, &pipeline);
  exr_finish(&context);
}

/* Bit for bit, NaN and infinities included, top row first, in every channel. */
static void test_exr(void **state) {
  (void)state;
  static float pixels[W * H * 3], back[3][W * H];
  for (int i = 0; i < W * H * 3; i++) pixels[i] = (float)sin(i * 12.9898) * 1e5f;
  pixels[0] = NAN;
  pixels[1] = INFINITY;
  pixels[2] = -0.0f;
  const struct exr_plane planes[3] = {{"X", pixels, 3}, {"Y", pixels + 1, 3}, {"Z", pixels + 2, 3}};
  char name[] = "/tmp/penumbra-exr-XXXXXX";
  assert_true(close(mkstemp(name)) == 0);
  assert_int_equal(exr_write(name, W, H, planes, 3), 0);
  read_exr(name, W, H, 3, back[0]);
  unlink(name);
  for (int i = 0; i < W * H * 3; i++) assert_memory_equal(&back[i % 3][i / 3], &pixels[i], 4);
}

/* From pictures that pack well to noise: on the way there are some that packed take exactly as many bytes as they have
 * (67 of these 600), which readers take for not packed. */
static void test_exr_of_equal_size(void **state) {
  (void)state;
  enum { SIDE = 8, COUNT = SIDE * SIDE, ROUNDS = 600 };
  float pixels[COUNT], back[COUNT];
  const struct exr_plane plane = {"Y", pixels, 1};
  char name[] = "/tmp/penumbra-exr-XXXXXX";
  assert_true(close(mkstemp(name)) == 0);
  uint32_t seed = 1;
  for (int round = 0; round < ROUNDS; round++) {
    memset(pixels, 0, sizeof pixels);
    for (int i = 0; i < COUNT * (round % 100) / 100 + round % 3; i++) {
      seed = seed * 1664525u + 1013904223u;
      pixels[i % COUNT] = (float)(seed >> 8) * 1e-4f;
    }
    assert_int_equal(exr_write(name, SIDE, SIDE, &plane, 1), 0);
    memset(back, 0xff, sizeof back);
    read_exr(name, SIDE, SIDE, 1, back);
    assert_memory_equal(back, pixels, sizeof pixels);
  }
  unlink(name);
}

static void test_png(void **state) {
  (void)state;
  static uint8_t pixels[W * H * 4], bytes[W * H * 8];
  for (int i = 0; i < W * H * 4; i++) pixels[i] = (uint8_t)(i * 37 + i / 256);
  char name[] = "/tmp/penumbra-png-XXXXXX", why[100] = "";
  assert_true(close(mkstemp(name)) == 0);
  assert_int_equal(png_write(name, W, H, 4, pixels), 0);
  FILE *file = fopen(name, "rb");
  assert_non_null(file);
  size_t size = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  unlink(name);
  int width = 0, height = 0;
  uint8_t *rgba = NULL;
  assert_int_equal(png_decode(bytes, size, &width, &height, &rgba, why, sizeof why), 0);
  assert_int_equal(width, W);
  assert_int_equal(height, H);
  assert_memory_equal(rgba, pixels, sizeof pixels);
  free(rgba);
  assert_int_not_equal(png_decode(bytes, size / 2, &width, &height, &rgba, why, sizeof why), 0);
  assert_null(rgba);
  assert_true(*why);
}

/* IEC 61966-2-1 at its corners. */
static void test_srgb(void **state) {
  (void)state;
  assert_int_equal(srgb_byte(0), 0);
  assert_int_equal(srgb_byte(1), 255);
  assert_int_equal(srgb_byte(0.5f), 188);
  assert_int_equal(srgb_byte(0.0031308f), 10);
  assert_int_equal(srgb_byte(-1), 0);
  assert_int_equal(srgb_byte(9), 255);
  assert_int_equal(srgb_byte(NAN), 0);
}

static void test_names(void **state) {
  (void)state;
  static const char *const names[] = {"hard", "pcf", "pcss", "backprojection"};
  char hint[64];
  assert_true(nearest_name("hrad", names, 4, hint, sizeof hint));
  assert_string_equal(hint, "did you mean hard?");
  assert_true(nearest_name("back", names, 4, hint, sizeof hint));
  assert_string_equal(hint, "did you mean backprojection?");
  assert_false(nearest_name("zebra", names, 4, hint, sizeof hint));
  assert_false(nearest_name("", names, 4, hint, sizeof hint));
  char *name = picture_name("builtin:boxes", "pcss:samples=16,a/b", ".png");
  assert_string_equal(name, "boxes-pcss-samples=16-a-b.png");
  free(name);
  name = picture_name("-rf", "hard", ".png");
  assert_string_equal(name, "_rf-hard.png");
  free(name);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_exr),   cmocka_unit_test(test_exr_of_equal_size),
      cmocka_unit_test(test_png),   cmocka_unit_test(test_srgb),
      cmocka_unit_test(test_names),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
