#include "maps/fit.h"

#include <math.h>
#include <string.h>

#include "maps/texels.h"

/* Casters nearer to a rectangle than this part of the farthest caster's distance are taken to be that far: the map's
 * depth has to reach both. Such a caster is then seen a little too far from the light; what it hides, (s_Q - s_R) /
 * (w_Q - w_R), hardly changes with w_Q that large. */
static const double nearest_share = 1.0 / 256.0;
/* Under a sun w is put on a grid of at most as many steps. */
enum { snap_steps = 64 };
/* A map that opens wider than this along an axis is split there in three, the middle one at most as wide as that. */
static const double tile_opening = 120, middle_opening = 60; /* degrees */

typedef struct {
  const pni_fit_request *request;
  pni_matrix light_from_scene;
  double z_max;   /* first look: the farthest caster */
  double z_cut;   /* rectangle: boxes are cut off here, close before the light */
  double z_floor; /* rectangle: nearer casters are taken to be here */
  double w_most;  /* rectangle: what maps store of those, z_floor put outwards */
  bool any, clamped;
  double least[3], most[3]; /* of the casters that count, (s', t', w) */
} fitting;

static bool is_parallel(const pni_fit_request *request) { return request->frame->projection == PNI_PARALLEL; }

static void to_light(const fitting *f, const double corners[8][3], double out[8][3]) {
  for (int i = 0; i < 8; i++) pni_matrix_point(&f->light_from_scene, corners[i], out[i]);
}

/* ---- distances --------------------------------------------------------------------------------------------------- */

double pni_fit_range(const pni_fit_request *request) { return is_parallel(request) ? 0 : request->range; }

/* Distances snap to eighths of their power of two. */
static double snap_distance(double z, bool up) {
  int exponent;
  double mantissa = frexp(z, &exponent) * 16;
  return ldexp((up ? floor(mantissa) + 1 : ceil(mantissa) - 1) / 16, exponent);
}

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

enum { HULL_MAX = 8 + 12 }; /* corners, and where edges are cut */

typedef struct {
  double least[3], most[3];
  double hull[HULL_MAX][3]; /* before it is sheared */
  int count;
  bool any;
} span3;

static void span_add(span3 *span, const fitting *f, const double p[3]) {
  double m[3];
  pni_map_point(p, f->request->frame->projection, m);
  memcpy(span->hull[span->count++], m, sizeof m);
  for (int i = 0; i < 2; i++) m[i] -= f->request->shear[i] * m[2];
  bool too_near = !is_parallel(f->request) && m[2] >= 1 / f->z_floor;
  if (too_near) m[2] = 1 / f->z_floor;
  for (int i = 0; i < 3; i++) {
    span->least[i] = fmin(span->least[i], m[i]);
    span->most[i] = fmax(span->most[i], m[i]);
  }
  if (too_near) span->most[2] = f->w_most;
  span->any = true;
}

/* The box's part before the light: corners, and where its edges meet a plane close before it. A box that lies nearer
 * than that altogether has its own plane, as close to its farthest corner in proportion. */
static span3 box_span(const fitting *f, const double p[8][3]) {
  span3 span = {.least = {INFINITY, INFINITY, INFINITY}, .most = {-INFINITY, -INFINITY, -INFINITY}};
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

/* What lies in front of nothing that is seen is left out: by its box, and by what was drawn, where that tells so much
 * of a box. */
static bool cut_to_kept(const fitting *f, span3 *span) {
  static const pni_caster_error exact = {0};
  static const double cells_least = 4;
  const pni_fit_request *r = f->request;
  if (r->grid && !pni_grid_shadowed(r->grid, (const double(*)[3])span->hull, span->count, &exact)) return false;
  const pni_fit_kept *kept = r->kept;
  if (!kept) return true;
  for (int i = 0; i < 2; i++)
    if (span->most[i] - span->least[i] < cells_least * kept->cell[i]) return true;
  for (int i = 0; i < 2; i++) {
    double a = r->shear[i] * span->least[2], b = r->shear[i] * span->most[2];
    span->least[i] = fmax(span->least[i], kept->bounds[i] - fmax(a, b));
    span->most[i] = fmin(span->most[i], kept->bounds[i + 2] - fmin(a, b));
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
  if (!span.any || !cut_to_visible(f, &span) || !cut_to_kept(f, &span)) return;
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

/* w_near above, w_far strictly below every caster. */
static void snap_depth(const fitting *f, pni_fit_result *out) {
  double w_low = f->least[2], w_high = f->most[2];
  if (is_parallel(f->request)) {
    double extent = fmax(w_high - w_low, 1e-6 * (fabs(w_high) + fabs(w_low)) + 1e-30), margin = extent / snap_steps;
    out->w_far = w_high - extent - margin;
    out->w_near = w_high + margin;
    pni_steps_around(&out->w_far, &out->w_near, snap_steps);
  } else {
    out->w_near = fmin(1 / snap_distance(1 / w_high, false), f->w_most);
    out->w_far = 1 / snap_distance(1 / w_low, true);
  }
}

/* ---- tiles ------------------------------------------------------------------------------------------------------- */

static const double degree = 0.017453292519943295;

/* The maps along one axis: one, or three that meet in angles of their own, so that what moves does not move them. */
typedef struct {
  int count;
  pni_axis axis[3];
} row;

static row split_axis(const pni_fit_request *request, double low, double high, int texels) {
  row r = {.count = 1, .axis[0] = {low, high, low, high}};
  if (request->given) return r;
  bool split = !is_parallel(request) && (atan(high) - atan(low)) / degree > tile_opening;
  if (!split) {
    r.axis[0] = pni_texels_around(low, high, texels);
    return r;
  }
  double edge = pni_texels_half(tan(0.5 * middle_opening * degree), texels);
  r.count = 3;
  r.axis[0] = pni_texels_from(-edge, low, -edge, texels);
  r.axis[1] = pni_texels_from(-edge, -edge, edge, texels);
  r.axis[2] = pni_texels_from(edge, edge, high, texels);
  return r;
}

static void make_tiles(const pni_fit_request *request, pni_fit_result *out) {
  row rows[2];
  for (int i = 0; i < 2; i++) {
    rows[i] = split_axis(request, out->bounds[i], out->bounds[i + 2], i ? request->height : request->width);
    out->bounds[i] = rows[i].axis[0].low;
    out->bounds[i + 2] = rows[i].axis[rows[i].count - 1].high;
  }
  out->tiles = rows[0].count * rows[1].count;
  for (int i = 0; i < out->tiles; i++) {
    const pni_axis *s = &rows[0].axis[i % rows[0].count], *t = &rows[1].axis[i / rows[0].count];
    memcpy(out->tile[i], (const double[4]){s->from, t->from, s->to, t->to}, sizeof out->tile[i]);
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

/* The least w that a map shows of receivers: a rectangle's map has an end, they may have none. */
static double seen_depth(const fitting *f) {
  double w = least_receiver(f);
  return is_parallel(f->request) ? w : fmax(w, 0x1p-20 * f->most[2]);
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
  if (request->kept) out->kept = *request->kept;
  pni_casters_each_box(casters, groups, look_at_distance, &f);
  f.z_cut = nearest_share * f.z_max;
  f.z_floor = fmax(request->near_distance, f.z_cut);
  f.w_most = 1 / snap_distance(f.z_floor, false);
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
  if (request->receivers && request->visible) f.least[2] = fmin(f.least[2], seen_depth(&f));
  out->clamped = clamp_opening(&f, out);
  for (int i = 0; i < 2; i++) widen_flat(&out->bounds[i], &out->bounds[i + 2], f.most[1 - i] - f.least[1 - i]);
  snap_depth(&f, out);
  keep_finite(out);
  make_tiles(request, out);
  clamp_opening(&f, out); /* what whole texels put beyond the limit is empty */
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
