/* What comes through wire netting: builtin:fence, over the floor's pixels whose lines to the whole light pass through
 * the netting and nothing else. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "exr_channel.h"
#include "vector.h"

enum { WIDTH = 320, HEIGHT = 240, PIXELS = WIDTH * HEIGHT };

/* builtin:fence: the netting hangs in z = 0 between the post at 0 and the bar along its top and sides; the light. */
static const double left = 0.025, right = 0.875, lowest = 0.05, highest = 0.8;
static const vec light = {0.5, 1.9, -1.6}, target = {0, 0.2, 0};
static const double half_size = 0.125;

static char folder[] = "/tmp/penumbra-netting-XXXXXX";
static float shadow[PIXELS], truth[PIXELS], position[3][PIXELS], counted[PIXELS];

static void read_channel(const char *name, const char *channel, float *out) {
  char path[256];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  assert_true(exr_channel_read(path, channel, WIDTH, HEIGHT, out));
}

static bool behind_netting(vec p) {
  vec along = unit(sub(target, light)), u = unit(cross(along, v3(0, 1, 0))), v = cross(u, along);
  for (int i = 0; i < 4; i++) {
    vec corner = add(light, add(mul(i & 1 ? half_size : -half_size, u), mul(i & 2 ? half_size : -half_size, v)));
    if (!(corner.z < 0 && p.z > 0)) return false;
    vec at = add(corner, mul(corner.z / (corner.z - p.z), sub(p, corner)));
    if (!(at.x >= left && at.x <= right && at.y >= lowest && at.y <= highest)) return false;
  }
  return true;
}

static void test_netting(void **state) {
  (void)state;
  char line[1024];
  assert_non_null(mkdtemp(folder));
  snprintf(line, sizeof line,
           "\"%s\" compare builtin:fence --size %dx%d --map 512 --frames 1 -t bitmask --save-dir %s >/dev/null 2>&1",
           getenv("PENUMBRA_PROGRAM"), WIDTH, HEIGHT, folder);
  assert_int_equal(system(line), 0);
  read_channel("01-bitmask.exr", "Y", shadow);
  read_channel("reference.exr", "Y", truth);
  read_channel("mask.exr", "Y", counted);
  for (int c = 0; c < 3; c++) read_channel("position.exr", c == 0 ? "X" : c == 1 ? "Y" : "Z", position[c]);
  double error = 0, seen = 0;
  int count = 0;
  for (int i = 0; i < PIXELS; i++) {
    vec p = v3(position[0][i], position[1][i], position[2][i]);
    if (!(counted[i] > 0) || fabs(p.y) > 1e-4 || !behind_netting(p)) continue;
    error += fabs(shadow[i] - truth[i]);
    seen += truth[i];
    count++;
  }
  print_message("netting: %d pixels that see %.3f of the light, off by %.4f\n", count, seen / count, error / count);
  assert_in_range(count, 5000, 10000);
  assert_true(seen / count > 0.5 && seen / count < 0.95);
  assert_true(error / count <= 0.012);
  snprintf(line, sizeof line, "rm -rf %s", folder);
  assert_int_equal(system(line), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_netting)};
  return cmocka_run_group_tests_name("netting", tests, NULL, NULL);
}
