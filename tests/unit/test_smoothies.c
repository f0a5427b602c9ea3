/* Smoothies on scenes with a closed form: a square over a plane, a box that stands, a slanted edge; and bad meshes. */
#include <stdio.h>
#include <stdlib.h>

#include "over_ground.h"

/* The square hangs at height h. */
static const double L = LIGHT_HEIGHT, h = 1.5, half_square = 0.6;

/* The ground seen from above, without normals, under a square. */
static void square_open(over_ground *c, int size, double half_height) {
  *c = (over_ground){.from_depth = true};
  soup_patch(&c->casters, v3(0, h, 0), v3(half_square, 0, 0), v3(0, 0, half_square));
  over_ground_open(c, size, half_height);
}

/* ---- the square over the plane ---- */

typedef struct {
  bool sun;
  double a, b; /* half extents of the light, or tangents */
  pn_fit fit;
  const char *spec;
} square_case;

/* Share of the light's extent a that the square hides from x, its other axis apart: the square's edge is seen at
 * (edge - x) / (share of the way) on the light. */
static double hidden(const square_case *c, double x, double a) {
  double k = c->sun ? h : h / L, scale = c->sun ? 1 : 1 - h / L;
  double from = (-half_square - x * scale) / k, to = (half_square - x * scale) / k;
  return (clamped(to, -a, a) - clamped(from, -a, a)) / (2 * a);
}

static pn_light_desc square_light(const square_case *c, int map) {
  pn_light_desc light = c->sun ? sun_along(v3(0, -1, 0), c->a, c->b, map) : light_over_ground(c->a, c->b, map);
  light.fit = c->fit;
  return light;
}

static double texel_of(const stage *s, bool sun) { /* on the ground */
  pn_maps_info info;
  assert_ok(pn_light_maps(s->light, &info));
  return fmax(info.s1 - info.s0, info.t1 - info.t0) / (info.width - 2) * (sun ? 1 : L);
}

/* Along x where all of the other axis is hidden: 2 V - 1 outside the hard shadow, within 0.01; 0 inside; 1 exactly
 * where V is 1. A texel at each end belongs to neither. */
static void check_square(const square_case *c) {
  enum { SIZE = 160 };
  over_ground scene;
  square_open(&scene, SIZE, 2);
  pn_light_desc light = square_light(c, 512);
  float *visibility = stage_visibility(&scene.s, &light, c->spec);
  double texel = texel_of(&scene.s, c->sun), worst = 0, scale = c->sun ? 1 : 1 - h / L;
  int inside = 0, between = 0, lit = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    vec p = view_point(&scene.v, i % SIZE, i / SIZE);
    double across[2] = {hidden(c, p.x, c->a), hidden(c, p.z, c->b)};
    double outside = fmax(fabs(p.x), fabs(p.z)) - half_square / scale;
    double V = 1 - across[0] * across[1];
    if (outside < -texel) inside += visibility[i] == 0, assert_true(visibility[i] == 0);
    double reach[2] = {(half_square + c->a * (c->sun ? h : h / L)) / scale,
                       (half_square + c->b * (c->sun ? h : h / L)) / scale};
    if (fabs(p.x) > reach[0] + texel || fabs(p.z) > reach[1] + texel)
      lit += visibility[i] == 1, assert_true(visibility[i] == 1);
    if (outside < texel || (across[0] < 1 && across[1] < 1)) continue;
    if (fabs(fabs(p.x) - reach[0]) < texel || fabs(fabs(p.z) - reach[1]) < texel) continue;
    worst = fmax(worst, fabs(visibility[i] - (2 * V - 1)));
    between += V < 1;
  }
  print_message("%s, %s of %g x %g, fit %d: off by %.4f, %d pixels in the penumbra\n", c->spec,
                c->sun ? "sun" : "rectangle", c->a, c->b, (int)c->fit, worst, between);
  assert_true(inside > 300 && between > 100 && lit > 300);
  assert_true(worst <= 0.01);
  free(visibility);
  over_ground_close(&scene);
}

static void test_square(void **state) {
  (void)state;
  static const char *const specs[] = {"smoothies", "smoothies:geometry=edges"};
  for (int i = 0; i < 2; i++)
    for (int sun = 0; sun < 2; sun++)
      for (int fit = PN_FIT_VISIBLE; fit <= PN_FIT_FRUSTUM; fit++) {
        check_square(&(square_case){sun, 0.3, 0.2, (pn_fit)fit, specs[i]});
        check_square(&(square_case){sun, sun ? 0.35 : 0.5, sun ? 0.35 : 0.5, (pn_fit)fit, specs[i]});
      }
}

/* A width in map units, as in the notes: alpha / (1 - b / r), alpha the distance in the map over the width; under a sun
 * b and r count from the nearest caster's plane. */
static void test_width(void **state) {
  (void)state;
  enum { SIZE = 96 };
  const double width = 0.1;
  for (int sun = 0; sun < 2; sun++) {
    square_case c = {sun, 0.3, 0.3, PN_FIT_VISIBLE, "smoothies:width=0.1,geometry=edges"};
    over_ground scene;
    square_open(&scene, SIZE, 1.5);
    pn_light_desc light = square_light(&c, 512);
    float *visibility = stage_visibility(&scene.s, &light, c.spec);
    pn_maps_info info;
    assert_ok(pn_light_maps(scene.s.light, &info));
    double texel = (info.s1 - info.s0) / (info.width - 2), worst = 0;
    /* A sun's w = height, its origin that of the scene. */
    double w_b = sun ? h - 0.0 : 1 / (L - h), w_r = sun ? 0 : 1 / L;
    int between = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
      vec p = view_point(&scene.v, i % SIZE, i / SIZE);
      if (fabs(p.z) > 0.4) continue;
      double d = fabs(p.x) * (sun ? 1 : w_r) - half_square * (sun ? 1 : w_b);
      double remapped = sun ? d / width * (info.w_near - w_r) / (w_b - w_r) : d / width / (1 - w_r / w_b);
      if (d < texel || fabs(remapped - 1) < 2 * texel / width) continue;
      worst = fmax(worst, fabs(visibility[i] - fmin(remapped, 1)));
      between += remapped < 1;
    }
    print_message("width=0.1, %s: off by %.4f, %d pixels in the penumbra\n", sun ? "sun" : "rectangle", worst, between);
    assert_true(between > 50);
    assert_true(worst <= 0.01);
    free(visibility);
    over_ground_close(&scene);
  }
}

/* ---- receivers at several distances ---- */

/* Steps of the ground under the square, each a strip along x. */
enum { STEPS = 3 };
static const double step_heights[STEPS] = {0, 0.5, 1};

static void stairs_open(over_ground *c, int size, double half_height) {
  *c = (over_ground){0};
  for (int i = 0; i < STEPS; i++)
    soup_patch(&c->ground, v3(0, step_heights[i], 0.3 * (i - 1)), v3(9, 0, 0), v3(0, 0, 0.15));
  soup_patch(&c->casters, v3(0, h, 0), v3(half_square, 0, 0), v3(0, 0, half_square));
  over_ground_see(c, &(camera){.width = size,
                               .height = size,
                               .eye = v3(0, 10, 0),
                               .target = v3(0, 0, 0),
                               .up = v3(0, 0, -1),
                               .orthographic = true,
                               .half_height = half_height,
                               .near = 1,
                               .far = 20});
}

static double w_at(bool sun, double height) { return sun ? height : 1 / (L - height); }

typedef struct {
  bool sun, remap;
  double width; /* 0: the light's */
} remap_case;

static const double light_half = 0.3;

/* How far from the edge in the map a receiver at w begins to see the whole light. Remapped, and of the light's width:
 * A (w_b - w). Remapped, of a fixed width: where alpha is 1 - b / r, b and r counted from w_near under a sun. Else all
 * of the smoothie: to what the farthest receiver, on the lowest step, sees; or the width itself. */
static double penumbra_width(const remap_case *c, double w, double w_near) {
  double w_b = w_at(c->sun, h), w_0 = w_at(c->sun, 0);
  if (c->width == 0) return light_half * (w_b - (c->remap ? w : w_0));
  if (!c->remap) return c->width;
  return c->width * (c->sun ? (w_b - w) / (w_near - w) : 1 - w / w_b);
}

/* Visibility grows straight over that width. The widths on the steps are also taken from the pixels alone. */
static void check_remap(const remap_case *c, const char *geometry) {
  enum { SIZE = 120 };
  over_ground scene;
  stairs_open(&scene, SIZE, 1.5);
  char spec[128];
  snprintf(spec, sizeof spec, "smoothies:geometry=%s,width=%g%s", geometry, c->width, c->remap ? "" : ",remap=off");
  pn_light_desc light =
      c->sun ? sun_along(v3(0, -1, 0), light_half, light_half, 512) : light_over_ground(light_half, light_half, 512);
  float *visibility = stage_visibility(&scene.s, &light, spec);
  pn_maps_info info;
  assert_ok(pn_light_maps(scene.s.light, &info));
  bool edge_is_nearest = c->sun && c->width > 0; /* b, which counts from that plane, is next to nothing */
  double worst = 0, distances[STEPS] = {0}, seen[STEPS] = {0}, wide[STEPS];
  for (int i = 0; i < SIZE * SIZE; i++) {
    int shown = view_shown(&scene.v, i % SIZE, i / SIZE), step = shown / 2;
    if (shown < 0) continue; /* between the steps there may be none */
    vec p = view_point(&scene.v, i % SIZE, i / SIZE);
    if (fabs(p.z - 0.3 * (step - 1)) > 0.13) continue;
    double w = w_at(c->sun, p.y), width = penumbra_width(c, w, info.w_near);
    double d = fabs(p.x) * (c->sun ? 1 : w) - half_square * (c->sun ? 1 : w_at(false, h));
    if (d < info.texel_s || fabs(d - width) < 2 * info.texel_s) continue;
    worst = fmax(worst, fabs(visibility[i] - fmin(d / width, 1)));
    if (visibility[i] == 1) continue;
    distances[step] += d;
    seen[step] += visibility[i];
  }
  for (int i = 0; i < STEPS; i++) {
    assert_true(seen[i] > 3);
    wide[i] = distances[i] / seen[i];
    double ratio = i ? wide[i] / wide[i - 1] : 1;
    if (!c->remap) assert_true(fabs(ratio - 1) < 0.01);
    if (i && c->remap && !edge_is_nearest) assert_true(ratio < 0.9);
  }
  print_message("%s, %s: off by %.4f; widths %.4f %.4f %.4f\n", spec, c->sun ? "sun" : "rectangle", worst, wide[0],
                wide[1], wide[2]);
  assert_true(worst <= 0.01);
  free(visibility);
  over_ground_close(&scene);
}

/* With remap=off a penumbra is as wide in the map on every receiver; else it widens behind the edge. */
static void test_remap(void **state) {
  (void)state;
  static const char *const geometries[] = {"edges", "cones"};
  for (int i = 0; i < 16; i++) check_remap(&(remap_case){i & 1, i >> 1 & 1, i & 4 ? 0.1 : 0}, geometries[i >> 3]);
}

/* ---- whose distance r is ---- */

/* The square over a floor that casts and receives, and beside its shadow a plate that only receives, which the light's
 * map does not show. bare: the floor does not cast either. tilt: of the light, about z; then the floor is not equally
 * far everywhere. Untilted: something seen lies deeper than the floor. */
typedef struct {
  bool sun, by_map, bare;
  double tilt, width; /* width 0: the light's */
} receiver_case;

static const double plate_height = 0.75;

static void plate_open(over_ground *c, const receiver_case *k, int size) {
  *c = (over_ground){0};
  if (!k->bare) soup_patch(&c->casters, v3(0, 0, 0), v3(2, 0, 0), v3(0, 0, 2));
  soup_patch(&c->casters, v3(0, h, 0), v3(half_square, 0, 0), v3(0, 0, half_square));
  soup_patch(&c->ground, v3(0, 0, 0), v3(2, 0, 0), v3(0, 0, 2));
  soup_patch(&c->ground, v3(0.85, plate_height, 0), v3(0.25, 0, 0), v3(0, 0, 0.2));
  if (k->tilt == 0) soup_patch(&c->ground, v3(0, -2, 0), v3(9, 0, 0), v3(0, 0, 9));
  over_ground_see(c, &(camera){.width = size,
                               .height = size,
                               .eye = v3(0, 10, 0),
                               .target = v3(0, 0, 0),
                               .up = v3(0, 0, -1),
                               .orthographic = true,
                               .half_height = 2.1,
                               .near = 1,
                               .far = 20});
}

/* The map's coordinate across the square's edges that lie along z, and w. */
static void in_map(const light_axes *l, vec p, double *s, double *w) {
  vec to = sub(p, l->origin), across = fabs(l->u.x) > fabs(l->v.x) ? l->u : l->v;
  double z = dot(to, l->z), sign = across.x > 0 ? 1 : -1;
  *s = sign * dot(to, across) / (l->sun ? 1 : z);
  *w = l->sun ? -z : 1 / z;
}

/* What a point at p sees past the nearer edge, by the notes, r being the distance of the point from. NAN inside or
 * within a margin of where that bends. */
static double seen_past(const receiver_case *c, const light_axes *l, vec p, vec from, double w_near, double margin) {
  double s, w, w_r, s_r, d = -INFINITY, w_e = 0;
  in_map(l, p, &s, &w);
  in_map(l, from, &s_r, &w_r);
  for (int side = -1; side <= 1; side += 2) {
    double s_edge, w_edge;
    in_map(l, v3(side * half_square, h, 0), &s_edge, &w_edge);
    if (side * (s - s_edge) < d) continue;
    d = side * (s - s_edge);
    w_e = w_edge;
  }
  double scale = c->sun ? (w_e - w_r) / (w_near - w_r) : 1 - w_r / w_e;
  double width = c->width == 0 ? l->half_u * (w_e - w_r) : c->width * scale;
  return d < margin || fabs(d - width) < 2 * margin ? NAN : fmin(d / width, 1);
}

static void check_receiver(const receiver_case *c) {
  enum { SIZE = 280 };
  over_ground scene;
  plate_open(&scene, c, SIZE);
  vec from = c->sun ? v3(0, 0, 0) : v3(L * sin(c->tilt), L * cos(c->tilt), 0);
  vec along = v3(-sin(c->tilt), -cos(c->tilt), 0);
  pn_light_desc light =
      c->sun ? sun_along(along, light_half, light_half, 1024) : light_at(from, along, light_half, light_half, 1024);
  light_axes l = axes_of(&light);
  char spec[128];
  snprintf(spec, sizeof spec, "smoothies:geometry=edges,receiver=%s,width=%g", c->by_map ? "map" : "pixel", c->width);
  float *visibility = stage_visibility(&scene.s, &light, spec);
  pn_maps_info info;
  assert_ok(pn_light_maps(scene.s.light, &info));
  double worst[2] = {0, 0};
  int between[2] = {0, 0};
  for (int i = 0; i < SIZE * SIZE; i++) {
    if (view_shown(&scene.v, i % SIZE, i / SIZE) < 0) continue;
    vec p = view_point(&scene.v, i % SIZE, i / SIZE), r = p;
    int shown = view_shown(&scene.v, i % SIZE, i / SIZE) / 2;
    if (shown > 1 || fabs(p.z) > 0.19 || fabs(p.x) > 1.9) continue;
    if (shown == 1 && c->by_map) { /* the floor that the light sees there */
      vec ray = c->sun ? along : sub(p, from);
      r = add(p, mul(-p.y / ray.y, ray));
    }
    double expected = seen_past(c, &l, p, r, info.w_near, info.texel_s);
    if (isnan(expected) || expected == 1) continue;
    worst[shown] = fmax(worst[shown], fabs(visibility[i] - expected));
    between[shown]++;
  }
  print_message("%s, %s%s tilted by %g: off by %.4f on %d pixels of the floor, by %.4f on %d of the plate\n", spec,
                c->bare ? "bare, " : "", c->sun ? "sun" : "rectangle", c->tilt, worst[0], between[0], worst[1],
                between[1]);
  assert_true(between[0] > 100 && (c->tilt != 0 || between[1] > 20));
  assert_true(worst[0] <= 0.01 && worst[1] <= 0.01);
  free(visibility);
  over_ground_close(&scene);
}

/* alpha / (1 - b / r): r of the floor behind the smoothie, on what the map does not show too, or of each. A floor that
 * does not cast is the plane that most of what is seen lies in. */
static void test_receiver(void **state) {
  (void)state;
  for (int i = 0; i < 16; i++)
    check_receiver(&(receiver_case){i & 1, !(i >> 1 & 1), false, i & 4 ? 0.4 : 0, i & 8 ? 0.1 : 0});
  for (int i = 0; i < 4; i++) check_receiver(&(receiver_case){i & 1, true, true, 0.4, i & 2 ? 0.1 : 0});
}

/* Two squares, of which the lower one sticks out in the map, and something seen between them in height. Least alpha
 * and nearest distance are kept each for itself, so where the two smoothies overlap it is darkened by the lower
 * square's too, which lies behind it; the pixel's own distance tells them apart. */
static void check_overlap(bool off, const char *spec) {
  enum { SIZE = 200 };
  const double upper = 2.2, lower = 1, between = 1.6, s_upper = 0.2, s_lower = 0.25, width = 0.1;
  over_ground scene = {0};
  soup_patch(&scene.casters, v3(0, upper, 0), v3(s_upper * (L - upper), 0, 0), v3(0, 0, 0.5));
  soup_patch(&scene.casters, v3(0, lower, 0), v3(s_lower * (L - lower), 0, 0), v3(0, 0, 0.5));
  soup_patch(&scene.ground, v3(0, 0, 0), v3(9, 0, 0), v3(0, 0, 9));
  soup_patch(&scene.ground, v3(0, between, 0), v3(1, 0, 0), v3(0, 0, 0.3));
  over_ground_open(&scene, SIZE, 1.1);
  pn_light_desc light = light_over_ground(0.1, 0.1, 1024);
  float *visibility = stage_visibility(&scene.s, &light, spec);
  int behind = 0, before = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    if (view_shown(&scene.v, i % SIZE, i / SIZE) < 2) continue;
    vec p = view_point(&scene.v, i % SIZE, i / SIZE);
    double s = fabs(p.x) / (L - p.y), margin = 0.004;
    if (fabs(p.z) > 0.25) continue;
    if (s < s_upper + margin || s > s_lower + width - margin) continue;
    if (fabs(s - s_lower) < margin || fabs(s - s_upper - width) < margin) continue;
    double alpha = (s - s_upper) / width, w_b = 1 / (L - upper);
    if (!off) alpha /= 1 - 1 / (L - between) / w_b;
    if (off && s > s_lower && s < s_upper + width) alpha = fmin(alpha, (s - s_lower) / width);
    if (fabs(visibility[i] - fmin(alpha, 1)) > 0.01) fail_msg("%s: %g, not %g, at %g", spec, visibility[i], alpha, s);
    behind += s > s_lower;
    before += s < s_lower;
  }
  assert_true(behind > 100 && before > 50);
  free(visibility);
  over_ground_close(&scene);
}

static void test_overlap(void **state) {
  (void)state;
  check_overlap(true, "smoothies:geometry=edges,width=0.1,remap=off");
  check_overlap(false, "smoothies:geometry=edges,width=0.1");
}

/* ---- a corner of many edges ---- */

/* A cone that lies at height h and points along x, seen from above: the tip is a corner between two of its many edges,
 * about a quarter and three quarters around from the first, which lies below. Beyond the tip only the corner's own
 * piece is in the light's way. */
static const double tip = 0.6, cone_length = 1, cone_radius = 0.4;

static void cone(soup *out, int sides) {
  vec rim[2] = {{0}};
  for (int i = 0; i <= sides; i++) {
    double angle = 2 * M_PI * i / sides;
    rim[i & 1] = v3(tip - cone_length, h - cone_radius * cos(angle), cone_radius * sin(angle));
    if (i) soup_triangle(out, v3(tip, h, 0), rim[(i + 1) & 1], rim[i & 1]);
    if (i) soup_triangle(out, v3(tip - cone_length, h, 0), rim[i & 1], rim[(i + 1) & 1]);
  }
}

/* Rounded, of a fixed width: alpha = |o| / width between the normals of the two edges, o counted from the tip in the
 * map. Of the light's size: a piece of pyramid between its corners (A, A) and (A, -A), where visibility is
 * o_s / (A (w - w_R)). The edges run along the tangents from the light to the cone, within a facet's angle. */
static void check_ring(int sides, double width) {
  enum { SIZE = 200 };
  over_ground scene = {0};
  cone(&scene.casters, sides);
  double w_tip = 1 / (L - h), s_tip = tip * w_tip, w_r = 1 / L;
  over_ground_see(&scene, &(camera){.width = SIZE,
                                    .height = SIZE,
                                    .eye = v3(s_tip * L, 10, 0),
                                    .target = v3(s_tip * L, 0, 0),
                                    .up = v3(0, 0, -1),
                                    .orthographic = true,
                                    .half_height = 0.4,
                                    .near = 1,
                                    .far = 20});
  pn_light_desc light = light_over_ground(light_half, light_half, 1024);
  char spec[64];
  snprintf(spec, sizeof spec, "smoothies:width=%g", width);
  float *visibility = stage_visibility(&scene.s, &light, spec);
  pn_maps_info info;
  assert_ok(pn_light_maps(scene.s.light, &info));
  /* where the plane through the light's centre and the tip's edge touches the cone: cosine of the angle from above */
  double touch = (tip / (L - h)) * cone_radius / cone_length, y = h + cone_radius * touch;
  vec end = v3((tip - cone_length) / (L - y), cone_radius * sqrt(1 - touch * touch) / (L - y), 0);
  vec along = unit(v3(s_tip - end.x, end.y, 0));
  double worst = 0;
  int between = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    vec p = view_point(&scene.v, i % SIZE, i / SIZE);
    double s = p.x * w_r - s_tip, t = fabs(p.z) * w_r, margin = info.texel_s + 0.1 * s;
    double seen = width > 0 ? hypot(s, t) / width / (1 - w_r / w_tip) : s / (light_half * (w_tip - w_r));
    double inside = width > 0 ? along.x * s - along.y * t : s - t; /* past both edges' ends */
    if (s < margin || inside < margin || (seen > 0.95 && seen < 1.05)) continue;
    worst = fmax(worst, fabs(visibility[i] - fmin(seen, 1)));
    between += seen < 1;
  }
  print_message("%s, %d edges at the tip: off by %.4f on %d pixels\n", spec, sides, worst, between);
  assert_true(between > 100);
  assert_true(worst <= 0.01);
  free(visibility);
  over_ground_close(&scene);
}

static void test_ring(void **state) {
  (void)state;
  static const int sides[] = {12, 300, 20000};
  for (size_t i = 0; i < sizeof sides / sizeof *sides; i++) {
    check_ring(sides[i], 0);
    check_ring(sides[i], 0.1);
  }
}

/* ---- to the end ---- */

/* A square turned by the angle at which rectangles reach farthest along u under an oblong light: n_u (A_u n_u + A_v
 * n_v) is largest where the tangent of twice the angle is A_v / A_u, and (A_u + |A|) / 2 there. Beyond what sheets
 * reach, the corner's place and A_u, no smoothie is cut off, whatever grid the map is on. */
static void check_turned(bool sun, pn_fit fit, int map, bool along_v) {
  enum { SIZE = 200 };
  const double narrow = 0.1, wide = 0.8, low = sun ? 1.3 : h;
  double angle = 0.5 * atan2(wide, narrow), a[2] = {along_v ? wide : narrow, along_v ? narrow : wide};
  if (along_v) angle = 0.5 * M_PI - angle;
  const vec normals[2] = {v3(cos(angle), 0, sin(angle)), v3(-sin(angle), 0, cos(angle))};
  over_ground scene = {0};
  soup_patch(&scene.casters, v3(0, low, 0), mul(half_square, normals[0]), mul(half_square, normals[1]));
  over_ground_open(&scene, SIZE, 2.6);
  pn_light_desc light = sun ? sun_along(v3(0, -1, 0), a[0], a[1], map) : light_over_ground(a[0], a[1], map);
  light.fit = fit;
  float *visibility = stage_visibility(&scene.s, &light, "smoothies:geometry=edges");
  pn_maps_info info;
  assert_ok(pn_light_maps(scene.s.light, &info));
  double w_b = w_at(sun, low), w_r = w_at(sun, 0), half = half_square * (sun ? 1 : w_b), margin = 2 * info.texel_s;
  double corner = half * (cos(angle) + sin(angle)), worst = 0, box = corner + narrow * (w_b - w_r);
  margin = fmax(margin, 2 * info.texel_t);
  int far = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    vec o = mul(sun ? 1 : w_r, view_point(&scene.v, i % SIZE, i / SIZE));
    o.y = 0;
    for (int side = 0; side < 4; side++) {
      vec n = normals[side & 1], along = normals[~side & 1];
      double d = (side & 2 ? -1 : 1) * dot(o, n) - half, end = (a[0] * fabs(n.x) + a[1] * fabs(n.z)) * (w_b - w_r);
      if (fabs(dot(o, along)) > half - margin || d < margin || d > end - margin) continue;
      worst = fmax(worst, fabs(visibility[i] - d / end));
      far += fabs(along_v ? o.z : o.x) > box + margin;
    }
  }
  print_message("%s of %g x %g, fit %d, map of %d: off by %.4f, %d pixels beyond the light's own reach\n",
                sun ? "sun" : "rectangle", a[0], a[1], (int)fit, map, worst, far);
  assert_true(far > 50);
  assert_true(worst <= 0.01);
  free(visibility);
  over_ground_close(&scene);
}

static void test_turned(void **state) {
  (void)state;
  static const int maps[] = {512, 560, 608, 664}; /* one of them is hardly larger than what it has to cover */
  for (int i = 0; i < 16; i++)
    check_turned(i & 1, i & 2 ? PN_FIT_FRUSTUM : PN_FIT_VISIBLE, maps[i >> 2], (i & 1) == (i >> 1 & 1));
}

/* ---- contact ---- */

/* Whether a vertical line from the ground at p up to the light's centre passes the box [-e, e] x [0, top] x [-e, e],
 * moved in by margin. */
static bool box_hides(vec p, vec light, double e, double top, double margin) {
  double low = 0, high = 1;
  const double from[3] = {p.x, p.y, p.z}, to[3] = {light.x, light.y, light.z};
  const double least[3] = {-e + margin, -1, -e + margin}, most[3] = {e - margin, top - margin, e - margin};
  for (int i = 0; i < 3; i++) {
    double a = (least[i] - from[i]) / (to[i] - from[i]), b = (most[i] - from[i]) / (to[i] - from[i]);
    low = fmax(low, fmin(a, b));
    high = fmin(high, fmax(a, b));
  }
  return low < high && low * length(sub(light, p)) > 1e-6;
}

/* A box that stands on the ground: the shadow of the light's centre is dark right up to it, whatever the light's
 * size, and its top is lit right up to the edges that smoothies grow from. */
static void test_contact(void **state) {
  (void)state;
  enum { SIZE = 128 };
  static const double sizes[] = {0.02, 0.2, 1, 2};
  static const char *const specs[] = {"smoothies", "smoothies:geometry=edges", "smoothies:receiver=map",
                                      "smoothies:geometry=edges,width=0.05,receiver=map", "smoothies:remap=off"};
  const double e = 0.5, top = 0.8;
  soup surfaces = {0}, box = {0};
  soup_box(&surfaces, v3(-e, 0, -e), v3(e, top, e));
  soup_box(&box, v3(-e, 0, -e), v3(e, top, e));
  int box_triangles = surfaces.count;
  soup_patch(&surfaces, v3(0, 0, 0), v3(9, 0, 0), v3(0, 0, 9));
  camera k = {.width = SIZE,
              .height = SIZE,
              .eye = v3(5, 6, 3),
              .target = v3(1, 0, 0.3),
              .up = v3(0, 1, 0),
              .half_height = 0.25,
              .near = 1,
              .far = 30};
  view v;
  view_draw(&v, &k, &surfaces);
  vec centre = v3(-2.1, 3, 0.4);
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
    for (size_t j = 0; j < sizeof specs / sizeof *specs; j++) {
      stage s;
      stage_open(&s);
      stage_cast(&s, &box);
      stage_receive(&s, &v, true);
      pn_light_desc light = light_at(centre, mul(-1, centre), sizes[i], sizes[i], 512);
      light.fit = PN_FIT_VISIBLE;
      float *visibility = stage_visibility(&s, &light, specs[j]);
      double texel = 3 * texel_of(&s, true) * length(centre);
      int dark = 0, close = 0, lit = 0;
      for (int p = 0; p < SIZE * SIZE; p++) {
        vec at = view_point(&v, p % SIZE, p / SIZE);
        if (fabs(at.y - top) < 1e-6) {
          if (visibility[p] != 1) fail_msg("%s, light %g: %g on the box", specs[j], sizes[i], visibility[p]);
          lit++;
        }
        if (v.shown[p] < box_triangles) continue;
        if (!box_hides(at, centre, e, top, texel)) continue;
        if (visibility[p] != 0) fail_msg("%s, light %g: %g at %g, %g", specs[j], sizes[i], visibility[p], at.x, at.z);
        dark++;
        close += at.x < e + 3 * texel;
      }
      assert_true(dark > 500 && close > 20 && lit > 500);
      free(visibility);
      stage_close(&s);
    }
  view_free(&v);
  soup_free(&surfaces);
  soup_free(&box);
}

/* ---- a slanted edge ---- */

/* Where the light that is seen along a line across the edge would begin, if it began at once, in texels; its standard
 * deviation over many lines. The camera looks straight down with the edge as its vertical. */
static double deviation(const char *spec, double *width) {
  enum { ACROSS = 400, ALONG = 160 };
  const double angle = 0.23;
  over_ground scene = {.from_depth = true};
  vec x = v3(cos(angle), 0, -sin(angle)), z = v3(sin(angle), 0, cos(angle));
  soup_patch(&scene.casters, v3(0, h, 0), mul(half_square, x), mul(half_square, z));
  vec middle = mul(half_square / (1 - h / L), x);
  camera k = {.width = ACROSS,
              .height = ALONG,
              .eye = add(middle, v3(0, 10, 0)),
              .target = middle,
              .up = mul(-1, z),
              .orthographic = true,
              .half_height = 0.2,
              .near = 1,
              .far = 20};
  over_ground_see(&scene, &k);
  pn_light_desc light = light_over_ground(0.25, 0.25, 256);
  float *visibility = stage_visibility(&scene.s, &light, spec);
  double texel = texel_of(&scene.s, false), pixel = 2 * k.half_height / ALONG, sum = 0, squares = 0;
  for (int y = 0; y < ALONG; y++) {
    double dark = 0;
    for (int i = 0; i < ACROSS; i++) dark += (1 - visibility[y * ACROSS + i]) * pixel / texel;
    sum += dark;
    squares += dark * dark;
  }
  *width = sum / ALONG;
  free(visibility);
  over_ground_close(&scene);
  return sqrt(fmax(squares / ALONG - sum / ALONG * (sum / ALONG), 0));
}

static void test_edge(void **state) {
  (void)state;
  double at, bicubic = deviation("pcf:filter=bicubic", &at), hard = deviation("hard", &at);
  print_message("standard deviation, texels: hard %.3f, bicubic pcf %.3f\n", hard, bicubic);
  static const char *const specs[] = {"smoothies", "smoothies:geometry=edges"};
  for (int i = 0; i < 2; i++) {
    double smoothies = deviation(specs[i], &at);
    print_message("%s %.3f\n", specs[i], smoothies);
    assert_true(smoothies <= 0.25 * bicubic);
  }
}

/* ---- bad meshes ---- */

/* Numbers in range and some shadow, in two frames; the mesh's report comes once. */
static void check_mesh(const char *name, const soup *casters, bool told) {
  enum { SIZE = 48 };
  soup ground = {0};
  soup_patch(&ground, v3(0, 0, 0), v3(9, 0, 0), v3(0, 0, 9));
  view v;
  stage s;
  camera k = camera_over_ground(SIZE, 3);
  view_draw(&v, &k, &ground);
  for (int geometry = 0; geometry < 2; geometry++) {
    stage_open(&s);
    stage_cast(&s, casters);
    stage_receive(&s, &v, false);
    pn_light_desc light = light_over_ground(0.4, 0.4, 128);
    light.fit = PN_FIT_VISIBLE;
    int dark = 0, soft = 0;
    for (int frame = 0; frame < 2; frame++) {
      float *visibility = stage_visibility(&s, &light, geometry ? "smoothies:geometry=edges" : "smoothies");
      for (int p = 0; p < SIZE * SIZE; p++) {
        assert_true(visibility[p] >= 0 && visibility[p] <= 1);
        dark += visibility[p] == 0;
        soft += visibility[p] > 0 && visibility[p] < 1;
      }
      free(visibility);
    }
    if (dark < 20 || soft < 20) fail_msg("%s: %d dark, %d soft", name, dark, soft);
    assert_int_equal(s.messages[PN_MESSAGE_MESH_EDGES], told);
    stage_close(&s);
  }
  view_free(&v);
  soup_free(&ground);
}

static void test_bad_meshes(void **state) {
  (void)state;
  soup s = {0};
  soup_triangle(&s, v3(-0.5, 1, -0.4), v3(0.6, 1.2, 0), v3(0, 1, 0.7));
  check_mesh("one triangle", &s, true);
  soup_triangle(&s, v3(-0.5, 1, -0.4), v3(0.6, 1.2, 0), v3(0.1, 2, 0));
  soup_triangle(&s, v3(-0.5, 1, -0.4), v3(0.6, 1.2, 0), v3(0.3, 1.1, -0.8));
  check_mesh("three faces at an edge", &s, true);
  soup_triangle(&s, v3(0, 1, 0), v3(1, 1, 0), v3(2, 1, 0));
  soup_triangle(&s, v3(0, 1, 0), v3(0, 1, 0), v3(2, 1, 0));
  soup_triangle(&s, v3(NAN, 1, 0), v3(0, 1, 1), v3(2, 1, 0));
  check_mesh("triangles without area or numbers", &s, true);
  soup_free(&s);
  soup_box(&s, v3(-0.5, 0.5, -0.5), v3(0.5, 1, 0.5));
  check_mesh("a closed box, every corner an own vertex", &s, false);
  soup_box(&s, v3(2, 1, -0.1), v3(2.2, L + 3, 0.1));
  check_mesh("a pillar past the light's plane", &s, false);
  soup_triangle(&s, v3(-3, L + 1, -3), v3(3, L + 1, 2), v3(0, L + 4, 3));
  check_mesh("a triangle behind the light", &s, true);
  soup_triangle(&s, v3(0, L, 0), v3(0.1, L - 0.1, 0), v3(0, L - 0.1, 0.1));
  check_mesh("a triangle in the light", &s, true);
  soup_free(&s);
}

static void draw_nothing(void *user, const pn_caster_pass *pass) {
  (void)pass;
  ++*(int *)user;
}

/* Callbacks have no mesh: told once, and their depth counts as before. */
static void test_callbacks(void **state) {
  (void)state;
  enum { SIZE = 32 };
  over_ground scene;
  int calls = 0;
  const float bounds[6] = {-1, 0.5f, -1, 1, 1, 1};
  square_open(&scene, SIZE, 2);
  assert_ok(pn_casters_draw(scene.s.casters, 3, draw_nothing, &calls, bounds));
  pn_light_desc light = light_over_ground(0.4, 0.4, 128);
  light.fit = PN_FIT_CASTERS; /* which calls nothing to find out where casters are */
  for (int frame = 0; frame < 3; frame++) free(stage_visibility(&scene.s, &light, "smoothies"));
  assert_int_equal(calls, 3);
  assert_int_equal(scene.s.messages[PN_MESSAGE_CASTER_MESHES], 1);
  over_ground_close(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_square),     cmocka_unit_test(test_width),     cmocka_unit_test(test_remap),
      cmocka_unit_test(test_receiver),   cmocka_unit_test(test_overlap),   cmocka_unit_test(test_ring),
      cmocka_unit_test(test_turned),     cmocka_unit_test(test_contact),   cmocka_unit_test(test_edge),
      cmocka_unit_test(test_bad_meshes), cmocka_unit_test(test_callbacks),
  };
  return GL_RUN("smoothies", tests);
}
