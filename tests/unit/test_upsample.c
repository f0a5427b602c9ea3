/* Visibility at half and quarter resolution, brought up: each pixel is a mean of what pixels around it have that lie on
 * its own plane, or is its own; and where a shadow's edge may run between samples, it is its own. Held against full
 * resolution, whose values at the samples are the same. */
#include <stdlib.h>

#include "over_ground.h"

enum { SIZE = 96 };

static float *look(over_ground *c, const pn_light_desc *light, int scale) {
  pn_receiver_desc desc = view_desc(&c->v, true);
  desc.scale = scale;
  assert_ok(pn_receiver_set(c->s.receiver, &desc));
  return stage_visibility(&c->s, light, "backprojection");
}

/* Whether v[x, y] lies between what pixels of the same height have within distance. */
static bool within_own_plane(const over_ground *c, const float *full, double v, int x, int y, int distance) {
  double least = 2, most = -1, height = view_point(&c->v, x, y).y;
  for (int b = y - distance; b <= y + distance; b++)
    for (int a = x - distance; a <= x + distance; a++) {
      if (a < 0 || b < 0 || a >= SIZE || b >= SIZE) continue;
      if (fabs(view_point(&c->v, a, b).y - height) > 1e-3) continue;
      least = fmin(least, full[b * SIZE + a]);
      most = fmax(most, full[b * SIZE + a]);
    }
  return v >= least - 1e-5 && v <= most + 1e-5;
}

/* Floor and table, both in one wide penumbra, so that they differ by less than an edge does. */
static void test_planes(void **state) {
  (void)state;
  for (int scale = 2; scale <= 4; scale *= 2) {
    over_ground c = {0};
    soup_patch(&c.ground, v3(0, 0, 0), v3(4, 0, 0), v3(0, 0, 4));
    soup_patch(&c.ground, v3(2.01, 0.8, 0), v3(2, 0, 0), v3(0, 0, 4));
    soup_patch(&c.casters, v3(2.3, 2, 0), v3(2, 0, 0), v3(0, 0, 6));
    over_ground_open(&c, SIZE, 0.5);
    pn_light_desc light = light_over_ground(1, 1, 256);
    float *full = look(&c, &light, 1), *low = look(&c, &light, scale);
    double apart = 0;
    int mixed = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
      int x = i % SIZE, y = i / SIZE;
      if (x && view_point(&c.v, x, y).y - view_point(&c.v, x - 1, y).y > 0.5)
        apart = fmax(apart, fabs((double)full[i] - (double)full[i - 1]));
      mixed += !within_own_plane(&c, full, low[i], x, y, scale);
    }
    if (!(apart > 0.05 && apart < 0.24)) fail_msg("not the scene it should be: %g", apart);
    if (mixed) fail_msg("1/%d: %d pixels have what another plane has", scale, mixed);
    free(full);
    free(low);
    over_ground_close(&c);
  }
}

/* Along a straight edge visibility rises monotonously, so a pixel lies between its samples; where those are further
 * apart than a quarter it is computed itself. The edge is narrow, slanted, and goes from half to the whole light. */
static void test_steps(void **state) {
  (void)state;
  for (int scale = 2; scale <= 4; scale *= 2) {
    over_ground c = {0};
    soup_patch(&c.casters, v3(2.5, 0.03, 0), v3(2.5, 0, 0.2), v3(-0.4, 0, 5));
    over_ground_open(&c, SIZE, 0.5);
    pn_light_desc light = light_over_ground(1, 1, 1024);
    float *full = look(&c, &light, 1), *low = look(&c, &light, scale);
    double worst = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
      int x = i % SIZE, y = i / SIZE;
      if (x < scale || y < scale || x >= SIZE - scale || y >= SIZE - scale) continue;
      worst = fmax(worst, fabs((double)low[i] - (double)full[i]));
    }
    if (worst > 0.25) fail_msg("1/%d: off by %g across an edge", scale, worst);
    free(full);
    free(low);
    over_ground_close(&c);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_planes), cmocka_unit_test(test_steps)};
  return GL_RUN("upsample", tests);
}
