/* What narrows a search changes what it costs, not what it finds: the same visibility with a range stack, a range
 * pyramid, a hybrid of both, and none. But for one thing: with ranges, pixels whose whole window hides are known to be
 * dark, also where primitives at different depths leave gaps. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stage.h"

enum { SIZE = 32 };

/* Sheets and blocks over a floor; all of it casts, or all but the floor. */
static void make_scene(uint64_t *seed, soup *casters, soup *seen) {
  soup_patch(seen, v3(0, 0, 0), v3(2, 0, 0), v3(0, 0, 2));
  if (random_bits(seed) & 1) soup_patch(casters, v3(0, 0, 0), v3(2, 0, 0), v3(0, 0, 2));
  int count = 1 + (int)random_in(seed, 0, 6);
  for (int i = 0; i < count; i++) {
    vec a = random_direction(seed), b = unit(cross(a, random_direction(seed))),
        centre = add(v3(0, 0.8, 0), random_point(seed, 0.6));
    for (int k = 0; k < 2; k++) {
      soup *s = k ? casters : seen;
      if (i & 1) soup_block(s, centre, mul(0.2, a), mul(0.3, b), mul(0.1, cross(a, b)));
      else soup_patch(s, centre, mul(0.5, a), mul(0.1, b));
    }
  }
}

/* Largest difference between two specs on one random scene, where the second one is not 0. */
static double difference(uint64_t seed, const char *first, const char *second) {
  static const int maps[] = {1, 2, 3, 7, 16, 31, 32, 64, 100};
  soup casters = {0}, seen = {0};
  make_scene(&seed, &casters, &seen);
  camera k = {.width = SIZE,
              .height = SIZE,
              .eye = v3(1, 3, 2.5),
              .target = v3(0, 0.4, 0),
              .up = v3(0, 1, 0),
              .half_height = 0.4,
              .near = 0.1,
              .far = 20};
  view v;
  stage s;
  view_draw(&v, &k, &seen);
  stage_open(&s);
  stage_cast(&s, &casters);
  stage_receive(&s, &v, true);
  int map = maps[(int)random_in(&seed, 0, 9)];
  vec from = unit(v3(random_in(&seed, -0.5, 0.5), 1, random_in(&seed, -0.5, 0.5)));
  double size = exp2(random_in(&seed, -5, 1));
  pn_light_desc light = random_bits(&seed) & 1 ? sun_along(mul(-1, from), fmin(size, 1), 0.3 * fmin(size, 1), map)
                                               : light_at(mul(3, from), mul(-1, from), size, size, map);
  if (random_bits(&seed) & 1) light.map_height = maps[(int)random_in(&seed, 0, 9)];
  float *a = stage_visibility(&s, &light, first), *b = stage_visibility(&s, &light, second);
  double worst = 0;
  for (int i = 0; i < SIZE * SIZE; i++)
    if (b[i] > 0) worst = fmax(worst, fabs(a[i] - b[i]));
  free(a);
  free(b);
  stage_close(&s);
  view_free(&v);
  soup_free(&casters);
  soup_free(&seen);
  return worst;
}

/* Bits are set or not, in whatever order. Areas are summed: up to 100 x 100 of them, in another order where the window
 * differs, each sum below 1 rounded by 2^-25; where the sum passes 1 the search may stop. */
static void test_hierarchies(void **state) {
  (void)state;
  static const struct {
    const char *technique;
    double allowed;
  } cases[] = {{"bitmask:primitive=patch,merge=0,hierarchy=", 0},
               {"bitmask:primitive=quad,maps=front,merge=0,hierarchy=", 0},
               {"backprojection:gaps=off,merge=0,hierarchy=", 100 * 100 * 0x1p-25}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    for (uint64_t round = 0; round < TEST_ROUNDS(16); round++) {
      char none[128], other[128];
      snprintf(none, sizeof none, "%snone", cases[k].technique);
      snprintf(other, sizeof other, "%s%s", cases[k].technique, (const char *[]){"hsm", "mssm", "hybrid"}[round % 3]);
      double found = difference(100 + round, none, other);
      if (found > cases[k].allowed) fail_msg("round %d: %s differs from %s by %g", (int)round, other, none, found);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_hierarchies)};
  return GL_RUN("search", tests);
}
