#include "maps/fit.h"

#include <math.h>
#include <string.h>

/* Casters nearer to a rectangle than this part of the farthest caster's distance are taken to be that far: the map's
 * depth has to reach both. Such a caster is then seen a little too far from the light; what it hides, (s_Q - s_R) /
 * (w_Q - w_R), hardly changes with w_Q that large. */
static const double nearest_share = 1.0 / 256.0;
/* Bounds are put on a grid of 32 to 64 steps across the map. */
static const double snap_steps = 64;
/* A map that opens wider than this is split. */
static const double tile_opening = 120, tile_angle = 60; /* degrees */

typedef struct {
  const pni_fit_request *request;
  pni_matrix light_from_scene;
  double z_max;   /* first look: the farthest caster */
  double z_cut;   /* rectangle: boxes are cut off here, close before the light */
  double z_floor; /* rectangle: nearer casters are taken to be here */
  bool any, clamped;
  double least[3], most[3]; /* of the casters that count, (s', t', w) */
} fitting;

static bool is_parallel(const pni_fit_request *request) { return request->frame->projection == PNI_PARALLEL; }

static void to_light(const fitting *f, const double corners[8][3], double out[8][3]) {
  for (int i = 0; i < 8; i++) pni_matrix_point(&f->light_from_scene, corners[i], out[i]);
}

/* ---- distances --------------------------------------------------------------------------------------------------- */

double pni_fit_range(const pni_fit_request *request) { return is_parallel(request) ? 0 : request->range; }

static bool too_far(const fitting *f, const double p[8][3]) {
  double range = pni_fit_range(f->request), least = INFINITY;
  for (int i = 0; i < 8; i++) least = fmin(least, p[i][2]);
  return range > 0 && least > range;
}

static void look_at_distance(void *user, const double corners[8][3]) {
  fitting *f = user;
  double p[8][3];
  to_light(f, corners, p);
  if (too_far(f, (const double(*)[3])p)) return;
  for (int i = 0; i < 8; i++) f->z_max = fmax(f->z_max, p[i][2]);
}

/* ---- one box ----------------------------------------------------------------------------------------------------- */

typedef struct {
  double least[3], most[3];
  bool any;
} span3;

static void span_add(span3 *span, const fitting *f, const double p[3]) {
  double m[3];
  pni_map_point(p, f->request->frame->projection, m);
  for (int i = 0; i < 2; i++) m[i] -= f->request->shear[i] * m[2];
  if (!is_parallel(f->request)) m[2] = fmin(m[2], 1 / f->z_floor);
  for (int i = 0; i < 3; i++) {
    span->least[i] = fmin(span->least[i], m[i]);
    span->most[i] = fmax(span->most[i], m[i]);
  }
  span->any = true;
}

/* The box's part before the light: corners, and where its edges meet a plane close before it. A box that lies nearer
 * than that altogether has its own plane, as close to its farthest corner in proportion. */
static span3 box_span(const fitting *f, const double p[8][3]) {
  span3 span = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, false};
  bool sun = is_parallel(f->request);
  double farthest = 0, plane = f->z_cut;
  for (int i = 0; i < 8; i++) farthest = fmax(farthest, p[i][2]);
  if (farthest <= plane) plane = nearest_share * farthest;
  if (!sun && !(plane > 0)) return span; /* behind the light */
  for (int i = 0; i < 8; i++) {
    if (sun || p[i][2] >= plane) span_add(&span, f, p[i]);
    for (int axis = 0; axis < 3 && !sun; axis++) {
      int j = i | 1 << axis;
      double a = p[i][2] - plane, b = p[j][2] - plane;
      if (j == i || (a < 0) == (b < 0)) continue;
      double t = a / (a - b), at[3];
      for (int c = 0; c < 3; c++) at[c] = p[i][c] + t * (p[j][c] - p[i][c]);
      at[2] = plane;
      span_add(&span, f, at);
    }
  }
  return span;
}

/* Cuts the span down to what can shadow the visible region: false when nothing is left. A caster at w reaches
 * receivers within A (w - w_R). */
static bool cut_to_visible(const fitting *f, span3 *span) {
  const pni_region *visible = f->request->visible;
  if (!visible) return true;
  double reach = span->most[2] - visible->least[2];
  if (!(reach > 0)) return false;
  for (int i = 0; i < 2; i++) {
    double shear = f->request->shear[i];
    /* a sheared map lies within the light's reach too */
    double grow = (f->request->emission->extent[i] + fabs(shear)) * reach;
    double low = fmin(visible->least[i] - shear * visible->least[2], visible->least[i] - shear * visible->most[2]);
    double high = fmax(visible->most[i] - shear * visible->least[2], visible->most[i] - shear * visible->most[2]);
    span->least[i] = fmax(span->least[i], low - grow);
    span->most[i] = fmin(span->most[i], high + grow);
    if (!(span->least[i] <= span->most[i])) return false;
  }
  return true;
}

static void add_box(void *user, const double corners[8][3]) {
  fitting *f = user;
  double p[8][3];
  to_light(f, corners, p);
  if (too_far(f, (const double(*)[3])p)) return;
  span3 span = box_span(f, (const double(*)[3])p);
  if (!span.any || !cut_to_visible(f, &span)) return;
  for (int i = 0; i < 3; i++) {
    f->least[i] = fmin(f->least[i], span.least[i]);
    f->most[i] = fmax(f->most[i], span.most[i]);
  }
  f->any = true;
}

/* ---- the given box ----------------------------------------------------------------------------------------------- */

static void fit_given(fitting *f) {
  const float *g = f->request->given;
  double corners[8][3], p[8][3];
  for (int i = 0; i < 8; i++)
    for (int c = 0; c < 3; c++) corners[i][c] = i >> c & 1 ? g[3 + c] : g[c];
  to_light(f, (const double(*)[3])corners, p);
  span3 span = box_span(f, (const double(*)[3])p);
  for (int i = 0; i < 2 && span.any; i++) {
    f->least[i] = span.least[i];
    f->most[i] = span.most[i];
  }
}

/* ---- snapping ---------------------------------------------------------------------------------------------------- */

/* The step for a range: a power of two, so that steps of neighbouring extents share their grid; chosen by the extent
 * after snapping, so that whatever fills the snapped bounds keeps them. */
static double snap_step(double low, double high) {
  double step = exp2(ceil(log2((high - low) / snap_steps)));
  return ceil(high / step) - floor(low / step) > snap_steps ? 2 * step : step;
}

void pni_fit_snap(double *low, double *high) {
  if (!(*high > *low)) return;
  double step = snap_step(*low, *high);
  *low = floor(*low / step) * step;
  *high = ceil(*high / step) * step;
}

/* Distances snap to eighths of their power of two. */
static double snap_distance(double z, bool up) {
  int exponent;
  double mantissa = frexp(z, &exponent) * 16;
  return ldexp((up ? floor(mantissa) + 1 : ceil(mantissa) - 1) / 16, exponent);
}

/* w_near above, w_far strictly below every caster. */
static void snap_depth(const fitting *f, pni_fit_result *out) {
  double w_low = f->least[2], w_high = f->most[2];
  if (is_parallel(f->request)) {
    double extent = fmax(w_high - w_low, 1e-6 * (fabs(w_high) + fabs(w_low)) + 1e-30),
           step = snap_step(w_high - extent, w_high);
    out->w_near = (ceil(w_high / step) + 1) * step;
    out->w_far = (floor(w_low / step) - 1) * step;
  } else {
    out->w_near = 1 / snap_distance(1 / w_high, false);
    out->w_far = 1 / snap_distance(1 / w_low, true);
  }
}

/* ---- borders and tiles ------------------------------------------------------------------------------------------- */

/* One empty texel on each side, as far as the map has that many. */
static void add_border(double *low, double *high, int texels) {
  double border = texels > 2 ? (*high - *low) / (texels - 2) : 0;
  *low -= border;
  *high += border;
}

static int tiles_along(double low, double high) {
  const double degree = 0.017453292519943295;
  double opening = (atan(high) - atan(low)) / degree;
  return opening > tile_opening ? (int)ceil(opening / tile_angle) : 1;
}

/* Tiles open by equal angles. */
static double tile_edge(double low, double high, int i, int count) {
  if (i == 0) return low;
  if (i == count) return high;
  return tan(atan(low) + (atan(high) - atan(low)) * i / count);
}

static void make_tiles(const pni_fit_request *request, pni_fit_result *out) {
  const double *b = out->bounds;
  bool split = !is_parallel(request) && !request->given;
  int columns = split ? tiles_along(b[0], b[2]) : 1, rows = split ? tiles_along(b[1], b[3]) : 1;
  out->tiles = columns * rows;
  for (int i = 0; i < out->tiles; i++) {
    double *tile = out->tile[i];
    int x = i % columns, y = i / columns;
    tile[0] = tile_edge(b[0], b[2], x, columns);
    tile[2] = tile_edge(b[0], b[2], x + 1, columns);
    tile[1] = tile_edge(b[1], b[3], y, rows);
    tile[3] = tile_edge(b[1], b[3], y + 1, rows);
    if (request->given) continue;
    add_border(&tile[0], &tile[2], request->width);
    add_border(&tile[1], &tile[3], request->height);
  }
}

/* ---- reach ------------------------------------------------------------------------------------------------------- */

/* A w that no receiver lies below. Behind a rectangle w > 0 however far a receiver is. Under a sun it is not known
 * without visible receivers: then four times as far behind the casters as these are wide, or as far as it takes for
 * the map to grow by a quarter of that width. */
static double least_receiver(const fitting *f) {
  const pni_fit_request *r = f->request;
  double w = r->visible ? r->visible->least[2] : -INFINITY;
  if (!is_parallel(r)) return fmin(fmax(w, 0), f->most[2]);
  double wide = fmax(f->most[0] - f->least[0], f->most[1] - f->least[1]);
  double behind = wide * fmax(4, 0.25 / fmax(r->emission->extent[0], r->emission->extent[1]));
  return fmin(!pni_is_nothing(w) ? w : f->least[2] - behind, f->most[2]);
}

/* Around the casters by their longest shadow, and of that what visible receivers can ask for. */
static bool extend_to_reach(fitting *f, pni_fit_result *out) {
  const pni_fit_request *r = f->request;
  out->w_reach = least_receiver(f);
  for (int i = 0; i < 2; i++) {
    double grow = r->reach_width > 0 ? r->reach_width : r->emission->extent[i] * (f->most[2] - out->w_reach);
    f->least[i] -= grow;
    f->most[i] += grow;
    if (!r->visible) continue;
    f->least[i] = fmax(f->least[i], r->visible->least[i]);
    f->most[i] = fmin(f->most[i], r->visible->most[i]);
    if (!(f->least[i] <= f->most[i])) return false;
  }
  return true;
}

/* A caster seen exactly from its side has no extent along one axis; the map needs one. */
static void widen_flat(double *low, double *high, double other_extent) {
  double least = fmax(1e-6 * fmax(fabs(*low), fabs(*high)), fmax(1e-4 * other_extent, 1e-9));
  if (*high - *low >= least) return;
  double middle = 0.5 * (*low + *high);
  *low = middle - 0.5 * least;
  *high = middle + 0.5 * least;
}

/* Whether anything was cut off. */
static bool clamp_opening(const fitting *f, pni_fit_result *out) {
  bool cut = false;
  for (int i = 0; i < 4 && !is_parallel(f->request); i++) {
    double clamped = fmin(fmax(out->bounds[i], -PNI_TANGENT_MAX), PNI_TANGENT_MAX);
    cut = cut || clamped != out->bounds[i];
    out->bounds[i] = clamped;
  }
  return cut;
}

/* All of it has to be floats, and their products with the size of a map. */
static void keep_finite(pni_fit_result *out) {
  const double most = 1e30;
  double *numbers[] = {&out->bounds[0], &out->bounds[1], &out->bounds[2], &out->bounds[3], &out->w_reach, &out->w_near};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) *numbers[i] = fmin(fmax(*numbers[i], -most), most);
  for (int i = 0; i < 2; i++)
    if (!(out->bounds[i] < out->bounds[i + 2])) out->bounds[i] = out->bounds[i + 2] - 1e-3 * most;
  out->w_far = fmin(fmax(out->w_far, -most), most);
  double wide = 1e-6 * fmax(fabs(out->w_near), fabs(out->w_far));
  if (!(out->w_near - out->w_far > 0)) out->w_far = out->w_near - fmin(fmax(wide, 1e-30), fabs(out->w_near) / 2);
}

void pni_fit_maps(const pn_casters *casters, uint32_t groups, const pni_fit_request *request, pni_fit_result *out) {
  fitting f = {.request = request, .light_from_scene = pni_light_from_scene(request->frame)};
  for (int i = 0; i < 3; i++) {
    f.least[i] = INFINITY;
    f.most[i] = -INFINITY;
  }
  memset(out, 0, sizeof *out);
  pni_casters_each_box(casters, groups, look_at_distance, &f);
  f.z_cut = nearest_share * f.z_max;
  f.z_floor = fmax(request->near_distance, f.z_cut);
  pni_casters_each_box(casters, groups, add_box, &f);
  out->empty = !f.any;
  if (out->empty) return;
  if (request->given) fit_given(&f);
  if (request->reach && !extend_to_reach(&f, out)) {
    out->empty = true;
    return;
  }
  for (int i = 0; i < 2; i++) {
    out->bounds[i] = f.least[i];
    out->bounds[i + 2] = f.most[i];
  }
  out->clamped = clamp_opening(&f, out);
  for (int i = 0; i < 2; i++) {
    widen_flat(&out->bounds[i], &out->bounds[i + 2], f.most[1 - i] - f.least[1 - i]);
    if (!request->given) pni_fit_snap(&out->bounds[i], &out->bounds[i + 2]);
  }
  clamp_opening(&f, out); /* what snapping put beyond the limit is empty */
  snap_depth(&f, out);
  keep_finite(out);
  make_tiles(request, out);
}

/* ---- the part that later layers hold ----------------------------------------------------------------------------- */

pni_part pni_fit_focus(const pni_fit_request *request, const pni_fit_result *fit, int tile, double share) {
  int texels[2] = {request->width, request->height}, low[2], high[2];
  for (int i = 0; i < 2; i++) {
    double least = fit->bounds[i], most = fit->bounds[i + 2], half = 0.5 * share * (most - least);
    double middle = is_parallel(request) ? 0.5 * (least + most) : fmin(fmax(0, least + half), most - half);
    double from = fit->tile[tile][i], to_texel = texels[i] / (fit->tile[tile][i + 2] - from);
    low[i] = (int)fmin(fmax(floor((middle - half - from) * to_texel), 0), texels[i]);
    high[i] = (int)fmin(fmax(ceil((middle + half - from) * to_texel), low[i]), texels[i]);
  }
  return (pni_part){low[0], low[1], high[0] - low[0], high[1] - low[1]};
}
