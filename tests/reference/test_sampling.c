/* The sampling patterns, from their definitions: nets are counted interval by interval, grids cell by cell. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "reference/reference.h"
#include "reference/sampling.h"

/* All N points of a pixel in [0, 1). */
static void pixel_points(int count, uint32_t pixel, double *x, double *y) {
  struct sampling sampling;
  struct sampling_pixel state;
  assert_true(sampling_create(&sampling, count));
  sampling_begin(&sampling, pixel, &state);
  int filled = 0;
  for (int packet = 0; packet < sampling.packets; packet++) {
    float a[SAMPLING_LANES], b[SAMPLING_LANES];
    int active = sampling_packet(&sampling, &state, packet, a, b);
    for (int i = 0; i < active; i++, filled++) {
      x[filled] = ((double)a[i] + 1) / 2;
      y[filled] = ((double)b[i] + 1) / 2;
      assert_true(x[filled] >= 0 && x[filled] < 1 && y[filled] >= 0 && y[filled] < 1);
    }
  }
  assert_int_equal(filled, count);
  sampling_free(&sampling);
}

/* Each of columns x rows equal boxes holds exactly one of columns * rows points. */
static void assert_one_in_each(const double *x, const double *y, int columns, int rows) {
  char *seen = calloc((size_t)columns * (size_t)rows, 1);
  for (int i = 0; i < columns * rows; i++) {
    int box = (int)(y[i] * rows) * columns + (int)(x[i] * columns);
    assert_int_equal(seen[box], 0);
    seen[box] = 1;
  }
  free(seen);
}

static void powers_of_two_are_nets(void **state) {
  (void)state;
  static const int counts[] = {1, 4, 16, 64, 256, 1024, 4096, 65536};
  double *x = malloc(65536 * sizeof *x), *y = malloc(65536 * sizeof *y);
  for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
    for (uint32_t pixel = 0; pixel < (counts[c] > 4096 ? 2u : 40u); pixel++) {
      pixel_points(counts[c], pixel * 7919, x, y);
      for (int columns = 1; columns <= counts[c]; columns *= 2) assert_one_in_each(x, y, columns, counts[c] / columns);
    }
  free(x);
  free(y);
}

static void other_squares_are_multi_jittered(void **state) {
  (void)state;
  static const int sides[] = {3, 5, 6, 7, 10, 31, 100, 255};
  double *x = malloc(65536 * sizeof *x), *y = malloc(65536 * sizeof *y);
  for (size_t c = 0; c < sizeof sides / sizeof *sides; c++)
    for (uint32_t pixel = 0; pixel < 3; pixel++) {
      int side = sides[c], count = side * side;
      pixel_points(count, pixel * 104729, x, y);
      assert_one_in_each(x, y, side, side);
      assert_one_in_each(x, y, count, 1);
      assert_one_in_each(x, y, 1, count);
    }
  free(x);
  free(y);
}

/* The bound that the header quotes, over boxes anchored at each corner of the light. */
static void discrepancy_is_within_six_of_1024(void **state) {
  (void)state;
  static double x[1024], y[1024];
  double worst = 0;
  for (uint32_t pixel = 0; pixel < 100; pixel++) {
    pixel_points(1024, pixel, x, y);
    for (int corner = 0; corner < 4; corner++)
      for (int a = 1; a < 24; a++)
        for (int b = 1; b < 24; b++) {
          int inside = 0;
          for (int i = 0; i < 1024; i++)
            inside += ((corner & 1 ? 1 - x[i] : x[i]) < a / 24.0) & ((corner & 2 ? 1 - y[i] : y[i]) < b / 24.0);
          double error = inside - 1024.0 * a * b / (24.0 * 24.0);
          worst = error > worst ? error : -error > worst ? -error : worst;
        }
  }
  assert_true(worst <= 10 / 3.0 + 19 / 9.0);
}

static void pixels_differ_and_repeat(void **state) {
  (void)state;
  static double x[3][1024], y[3][1024];
  pixel_points(1024, 5, x[0], y[0]);
  pixel_points(1024, 5, x[1], y[1]);
  pixel_points(1024, 6, x[2], y[2]);
  assert_memory_equal(x[0], x[1], sizeof x[0]);
  assert_memory_equal(y[0], y[1], sizeof y[0]);
  assert_true(memcmp(x[0], x[2], sizeof x[0]) != 0);
  assert_true(memcmp(y[0], y[2], sizeof y[0]) != 0);
}

static void only_squares_are_taken(void **state) {
  (void)state;
  struct sampling sampling;
  static const int bad[] = {0, -1, -4, 2, 3, 8, 1000, 1023, 65537, 256 * 257, 66049, 2147483647};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    assert_false(reference_samples_valid(bad[i]));
    assert_false(sampling_create(&sampling, bad[i]));
    assert_null(sampling.first);
  }
  for (int side = 1; side <= 256; side++) assert_true(reference_samples_valid(side * side));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(powers_of_two_are_nets),
      cmocka_unit_test(other_squares_are_multi_jittered),
      cmocka_unit_test(discrepancy_is_within_six_of_1024),
      cmocka_unit_test(pixels_differ_and_repeat),
      cmocka_unit_test(only_squares_are_taken),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
