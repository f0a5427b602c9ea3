/* The part of the light above a receiver's horizon: gather/horizon.glsl against a polygon clipped in double. */
#include <stdlib.h>
#include <string.h>

#include "glsl_call.h"

typedef struct {
  double x, y;
} point;

/* Share of [-a, a] x [-b, b] where n_x x + n_y y > k: Sutherland and Hodgman's clip, then the shoelace formula. */
static double share_above(double a, double b, double nx, double ny, double k) {
  const point corners[4] = {{-a, -b}, {a, -b}, {a, b}, {-a, b}};
  point kept[8];
  int count = 0;
  double twice = 0;
  for (int i = 0; i < 4; i++) {
    point p = corners[i], q = corners[(i + 1) % 4];
    double hp = nx * p.x + ny * p.y - k, hq = nx * q.x + ny * q.y - k;
    if (hp > 0) kept[count++] = p;
    if ((hp > 0) != (hq > 0))
      kept[count++] = (point){p.x + (q.x - p.x) * hp / (hp - hq), p.y + (q.y - p.y) * hp / (hp - hq)};
  }
  for (int i = 0; i < count; i++) {
    point p = kept[i], q = kept[(i + 1) % count];
    twice += p.x * q.y - p.y * q.x;
  }
  return twice / (8 * a * b);
}

enum { COUNT = 16384 };
static float in[COUNT][8]; /* extent, n, k */

static void fill(void) {
  uint64_t seed = 1;
  for (int i = 0; i < COUNT; i++) {
    float *v = in[i];
    for (int c = 0; c < 2; c++) v[c] = (float)exp2(random_in(&seed, -7, 5));
    for (int c = 2; c < 4; c++) v[c] = (float)random_in(&seed, -1, 1);
    if (i % 8 == 1) v[2 + (i >> 3 & 1)] = 0;                                       /* parallel to an edge */
    if (i % 8 == 2) v[2 + (i >> 3 & 1)] *= (float)exp2(random_in(&seed, -20, -3)); /* nearly so */
    if (i % 8 == 3) v[2] = v[3] * v[1] / v[0];                                     /* along a diagonal */
    if (i % 8 == 4) v[2] = v[3] = 0;
    double most = fabs((double)v[0] * v[2]) + fabs((double)v[1] * v[3]);
    v[4] = (float)(random_in(&seed, -1.1, 1.1) * most);
    if (i % 8 == 5) v[4] = (float)most; /* through a corner */
    if (i % 8 == 6) v[4] = 0;
    if (i % 8 == 4) v[4] = (float)random_in(&seed, -1, 1);
  }
}

static double compare(double allowed) {
  static const char *const paths[] = {"shaders/precision.glsl", "gather/horizon.glsl", NULL};
  static const char text[] =
      "void call() { results[0].x = floatBitsToUint(pn_area_above(taken(0).xy, taken(0).zw, taken(1).x)); }";
  stage s;
  stage_open(&s);
  fill();
  uint32_t *out = glsl_call(&s, &(glsl_function){paths, "", text}, in[0], 2, COUNT);
  double worst = 0;
  for (int i = 0; i < COUNT; i++) {
    const float *v = in[i];
    double found = as_float(out[32 * i]), want = share_above(v[0], v[1], v[2], v[3], v[4]);
    if (!(fabs(found - want) <= allowed))
      fail_msg("%.9g, not %.9g: extent %.9g %.9g, n %.9g %.9g, k %.9g", found, want, v[0], v[1], v[2], v[3], v[4]);
    worst = fmax(worst, fabs(found - want));
  }
  free(out);
  stage_close(&s);
  return worst;
}

/* The mean of a clamped line over its values from h0 to h1 is (F(h1) - F(h0)) / (h1 - h0). F up to 3/2 is rounded by
 * less than 2^-22 at each end, values by 2^-22; below h1 - h0 = 1e-4 the middle is taken, off by an eighth of that
 * where the line bends. */
static void test_area(void **state) {
  (void)state;
  print_message("off by %g\n", compare(2 * 0x1p-22 / 1e-4 + 0x1p-22));
}

/* Exactly nothing and exactly everything, where the whole light is below or above by more than rounding. */
static void test_ends(void **state) {
  (void)state;
  assert_true(share_above(1, 2, 1, 0, -1.5) == 1 && share_above(1, 2, 1, 0, 1.5) == 0 &&
              share_above(1, 2, 0, 1, 0) == 0.5);
  assert_true(fabs(share_above(1, 1, 1, 1, 1) - 0.125) < 1e-15);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_ends), cmocka_unit_test(test_area)};
  return GL_RUN("horizon", tests);
}
