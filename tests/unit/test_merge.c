/* merge: a block of the map is taken as one patch exactly if its edges move by no more than that share of the light
 * between its nearest and its farthest sample. A tilted plate that covers a map of 4 x 4 texels, seen by one receiver:
 * how many patches hide it follows from the plate's equation. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "over_ground.h"

enum { SIDE = 9, MAP = 4 };
#define HALF 0.45
#define HEIGHT 1.0 /* of the plate's middle */
#define RISE 2.0   /* a unit of x */

/* w of the plate at s = x: a sun that shines straight down has w = y there. */
static double plate(double s) { return HEIGHT + RISE * s; }

/* How far an edge at distance s from the receiver moves on the light, as a share of it, between two heights. */
static double moved(double s, double w0, double w1) { return fabs(s / w0 - s / w1) / (2 * HALF); }

/* Of a block of 2 x 2 texels, which the walk begins with: between its samples, a texel apart. The receiver is below the
 * middle, so one edge of each block lies 0.25 aside, in s and in t; the other one does not move. */
static double block_moved(int first) {
  double sample = -0.25 + (first + 0.5) * 0.5 / MAP;
  return moved(0.25, plate(sample), plate(sample + 0.5 / MAP));
}

static int patches(double merge) {
  over_ground c = {0};
  soup_patch(&c.casters, v3(0, HEIGHT, 0), v3(2, 2 * RISE, 0), v3(0, 0, 2));
  over_ground_open(&c, SIDE, 1e-3);
  pn_light_desc light = sun_along(v3(0, -1, 0), HALF, HALF, MAP);
  light.fit = PN_FIT_GIVEN;
  const float box[6] = {-0.25f + 0.013f, -1, -0.25f + 0.007f, 0.25f + 0.013f, 3, 0.25f + 0.007f};
  memcpy(light.fit_bounds, box, sizeof box);
  char spec[120];
  snprintf(spec, sizeof spec, "bitmask:primitive=patch,maps=front,hierarchy=mssm,merge=%.9g", 100 * merge);
  assert_ok(pn_debug(c.s.context, PN_DEBUG_SEARCH));
  free(stage_visibility(&c.s, &light, spec));
  pn_image image;
  const char *name;
  int found = -1;
  for (int i = 0; pn_debug_image(c.s.light, c.s.receiver, i, &name, &image); i++) {
    if (strcmp(name, "search") != 0) continue;
    float *search = gl_read_texture(image.texture, 0, -1, image.width, image.height, 4);
    const float *pixel = search + 4 * (SIDE * SIDE / 2);
    found = (int)pixel[2];
    free(search);
  }
  over_ground_close(&c);
  return found;
}

/* The two blocks below the plate's low half move by several rows of the bit field: split, they are four each. Those of
 * the other half move by less than a row, and are one each or none. */
static void test_blocks(void **state) {
  (void)state;
  double least = block_moved(2), most = block_moved(0);
  assert_true(most > 2.0 / 16 && most < 0.5 && least > 0 && least < 0.5 * most);
  assert_int_equal(patches(1.1 * most), 4);
  assert_int_equal(patches(0.9 * most), 2 + 8);
  assert_int_equal(patches(0.6 * most), 2 + 8);
  assert_int_equal(patches(1.1 * least), 2 + 8);
  assert_int_not_equal(patches(0.9 * least), 2 + 8);
  assert_int_not_equal(patches(0.6 * least), 2 + 8);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_blocks)};
  return GL_RUN("merge", tests);
}
