/* The post-filter (Bitmask Soft Shadows, section 3.1): areas against closed forms, a pass against what the paper says
 * of one, and what it is for: smaller steps, nearer to the truth. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "over_ground.h"

enum { SIZE = 64 };

/* What the pass reads: visibility, area, axes (1 x, 2 y), visibility at first. Freed by the caller. */
static float *smoothed_image(const stage *s) {
  const char *name;
  pn_image image;
  for (int i = 0; pn_debug_image(s->light, s->receiver, i, &name, &image); i++) {
    if (strcmp(name, "smoothed") != 0) continue;
    assert_int_equal(image.width * image.height, SIZE * SIZE);
    float *out = malloc((size_t)4 * SIZE * SIZE * sizeof *out);
    glBindTexture(GL_TEXTURE_2D, image.texture);
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_FLOAT, out);
    return out;
  }
  fail_msg("no image of what is smoothed");
  return NULL;
}

/* ---- areas ------------------------------------------------------------------------------------------------------- */

/* Two square plates one above the other: what they leave together is 1 less each one's share, also below 0. The search
 * must not end when all sample points are hidden, nor leave out blocks whose points are. */
static void areas_add_up(void **state) {
  (void)state;
  static const char *const searches[] = {"merge=0", "merge=1", "merge=4", "merge=1,primitive=patch"};
  for (int k = 0; k < 4; k++) {
    over_ground c = {0};
    soup_patch(&c.casters, v3(0, 1, 0), v3(0.8, 0, 0), v3(0, 0, 0.8));
    soup_patch(&c.casters, v3(0, 2, 0), v3(0.5, 0, 0), v3(0, 0, 0.5));
    over_ground_open(&c, SIZE, 2);
    pn_light_desc light = light_over_ground(1, 1, 128);
    char spec[120];
    snprintf(spec, sizeof spec, "bitmask:smooth=1,maps=layers,layers=2,%s", searches[k]);
    float *seen = stage_visibility(&c.s, &light, spec), *image = smoothed_image(&c.s);
    double worst = 0, least = 1;
    for (int i = 0; i < SIZE * SIZE; i++) {
      vec p = view_point(&c.v, i % SIZE, i / SIZE);
      double lower = hidden_by_plate(p.x, 1, 0.8, 1) * hidden_by_plate(p.z, 1, 0.8, 1);
      double upper = hidden_by_plate(p.x, 1, 0.5, 2) * hidden_by_plate(p.z, 1, 0.5, 2);
      worst = fmax(worst, fabs((double)image[4 * i + 1] - (1 - lower - upper)));
      least = fmin(least, image[4 * i + 1]);
    }
    /* The map's texels are 3 % of the light wide, seen past the lower plate, and each plate has four edges. */
    if (worst > 0.1 || least > -0.8) fail_msg("%s: areas off by %g; the least is %g", spec, worst, least);
    free(seen);
    free(image);
    over_ground_close(&c);
  }
}

/* ---- one pass ---------------------------------------------------------------------------------------------------- */

/* What the paper has along one axis: B between its neighbours as A is; NAN where that is not asked for. */
static double paper_value(const float *at, const float *before, const float *after) {
  double da = (double)after[1] - (double)before[1], db = (double)after[0] - (double)before[0];
  double t = ((double)at[1] - (double)before[1]) / da;
  return (da > 0) == (db > 0) && (da < 0) == (db < 0) && da != 0 && t > 0 && t < 1
             ? (double)before[0] * (1 - t) + (double)after[0] * t
             : NAN;
}

static double paper_pass(const float *image, int i) {
  const float *at = image + 4 * i;
  int x = i % SIZE, y = i / SIZE;
  double b = (double)at[0], bx = NAN, by = NAN;
  if (x > 0 && x < SIZE - 1) bx = paper_value(at, at - 4, at + 4);
  if (y > 0 && y < SIZE - 1) by = paper_value(at, at - 4 * SIZE, at + 4 * SIZE);
  if (isnan(bx)) bx = by;
  if (isnan(by)) by = bx;
  return isnan(bx) ? b : fabs(bx - b) < fabs(by - b) ? bx : by;
}

static void open_slanted(over_ground *c) {
  soup_patch(&c->casters, v3(0, 2, 0), v3(0.7, 0, 0.1), v3(-0.2, 0, 0.5));
  soup_patch(&c->casters, v3(0.2, 1, 0.4), v3(0.5, 0, -0.2), v3(0.2, 0, 0.5));
  over_ground_open(c, SIZE, 2);
}

static void a_pass_is_the_papers(void **state) {
  (void)state;
  over_ground c = {0};
  open_slanted(&c);
  pn_light_desc light = light_over_ground(1, 1, 128);
  float *seen = stage_visibility(&c.s, &light, "bitmask:smooth=1,pass=paper"), *image = smoothed_image(&c.s);
  int changed = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    double wanted = paper_pass(image, i);
    /* Results have 16 bits. */
    if (fabs((double)seen[i] - wanted) > 1e-3)
      fail_msg("pixel %d, %d: %g, not %g", i % SIZE, i / SIZE, (double)seen[i], wanted);
    changed += fabs(wanted - (double)image[4 * i]) > 1e-3;
  }
  if (changed < SIZE * SIZE / 10) fail_msg("%d pixels changed only", changed);
  free(seen);
  free(image);
  over_ground_close(&c);
}

/* Bounded, no number of passes changes a pixel by more than half a row of sample points. */
static void changes_are_bounded(void **state) {
  (void)state;
  static const struct {
    const char *samples;
    double most;
  } all[] = {{"8", 1 / 16.0}, {"16", 1 / 32.0}, {"16j", 1 / 32.0}, {"32", 1 / 64.0}};
  over_ground c = {0};
  open_slanted(&c);
  pn_light_desc light = light_over_ground(1, 1, 128);
  for (int k = 0; k < 4; k++) {
    char spec[120];
    snprintf(spec, sizeof spec, "bitmask:samples=%s", all[k].samples);
    float *before = stage_visibility(&c.s, &light, spec);
    snprintf(spec, sizeof spec, "bitmask:samples=%s,smooth=16", all[k].samples);
    float *after = stage_visibility(&c.s, &light, spec);
    double most = 0;
    for (int i = 0; i < SIZE * SIZE; i++) most = fmax(most, fabs((double)after[i] - (double)before[i]));
    if (most > all[k].most + 1e-3 || most < 0.25 * all[k].most) fail_msg("%s: changes up to %g", spec, most);
    free(before);
    free(after);
  }
  over_ground_close(&c);
}

/* ---- what it is for ---------------------------------------------------------------------------------------------- */

/* Pixels at the view's border lack a neighbour and stay. */
static void measure_steps(const over_ground *c, const float *seen, double *step, double *error) {
  *step = *error = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    double x = view_point(&c->v, i % SIZE, i / SIZE).x;
    *error += fabs((double)seen[i] - clamped(0.5 + 0.5 * x, 0, 1)) / (SIZE * SIZE);
    if (i % SIZE > 1 && i % SIZE < SIZE - 1) *step = fmax(*step, fabs((double)seen[i] - (double)seen[i - 1]));
  }
}

/* An edge parallel to the light's crosses a row of sample points at once (the paper's Fig. 9). The floor's penumbra is
 * two wide, and the view within it. */
static void steps_fall_to_a_half(void **state) {
  (void)state;
  static const char *const searches[] = {"merge=0", "merge=1", "merge=1,samples=8"};
  for (int k = 0; k < 3; k++) {
    over_ground c = {0};
    soup_patch(&c.casters, v3(-3, 2, 0), v3(3, 0, 0), v3(0, 0, 6));
    over_ground_open(&c, SIZE, 0.6);
    pn_light_desc light = light_over_ground(1, 1, 128);
    char spec[120];
    double before, after, error_before, error_after;
    snprintf(spec, sizeof spec, "bitmask:%s", searches[k]);
    float *seen = stage_visibility(&c.s, &light, spec);
    measure_steps(&c, seen, &before, &error_before);
    free(seen);
    snprintf(spec, sizeof spec, "bitmask:%s,smooth=5", searches[k]);
    seen = stage_visibility(&c.s, &light, spec);
    measure_steps(&c, seen, &after, &error_after);
    free(seen);
    if (before < 1 / 40.0 || after > 0.5 * before || error_after > error_before)
      fail_msg("%s: steps %g, before %g; errors %g, before %g", spec, after, before, error_after, error_before);
    over_ground_close(&c);
  }
}

/* A table's edge in the view: next to it no pixel is smoothed across it, on the floor or on the table. */
static void steps_of_surfaces_stay(void **state) {
  (void)state;
  over_ground c = {0};
  soup_patch(&c.ground, v3(0, 0, 0), v3(4, 0, 0), v3(0, 0, 4));
  soup_patch(&c.ground, v3(2.01, 0.8, 0), v3(2, 0, 0), v3(0, 0, 4));
  soup_patch(&c.casters, v3(2.3, 2, 0), v3(2, 0, 0), v3(0, 0, 6));
  over_ground_open(&c, SIZE, 0.5);
  pn_light_desc light = light_over_ground(1, 1, 128);
  float *seen = stage_visibility(&c.s, &light, "bitmask:smooth=1"), *image = smoothed_image(&c.s);
  int beside = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    int x = i % SIZE, y = i / SIZE, axes = (int)image[4 * i + 2];
    if (x == 0 || y == 0 || x == SIZE - 1 || y == SIZE - 1) continue;
    double here = view_point(&c.v, x, y).y, before = view_point(&c.v, x - 1, y).y, after = view_point(&c.v, x + 1, y).y;
    bool step = fabs(here - before) > 0.5 || fabs(here - after) > 0.5;
    assert_int_equal(axes, step ? 2 : 3);
    beside += step;
  }
  assert_true(beside >= SIZE);
  free(seen);
  free(image);
  over_ground_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(areas_add_up), cmocka_unit_test(a_pass_is_the_papers),
                                     cmocka_unit_test(changes_are_bounded), cmocka_unit_test(steps_fall_to_a_half),
                                     cmocka_unit_test(steps_of_surfaces_stay)};
  return GL_RUN("smooth", tests);
}
