/* Searches that merge nothing, against every texel of every map taken one by one on the CPU in double, and past the
 * cap against every block. What float rounding leaves open is counted on both sides: GL's result must lie between what
 * is surely hidden and what may be. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "light.h"
#include "stage.h"

enum { PIXELS = 16, LAYERS = 4, GRID_MAX = 32 };
enum { NO, MAYBE, YES };
typedef enum { PATCH, QUAD, EXACT } primitive;

/* ---- the maps as GL drew them ---- */

typedef struct {
  const pni_light_block *block;
  float *depth[PNI_MAPS_MAX * LAYERS];
  int maps, layers, width, height;
  bool sun;
} atlas;

static atlas read_maps(const stage *s) {
  const pni_maps *maps = &s->light->maps;
  atlas a = {.block = &maps->block,
             .maps = (int)maps->block.map_count,
             .layers = pni_want_layers(&maps->want),
             .width = maps->depth.width,
             .height = maps->depth.height,
             .sun = maps->block.parallel > 0.5f};
  for (int i = 0; i < a.maps * a.layers; i++) a.depth[i] = gl_read_depth(maps->depth.id, i, a.width, a.height);
  return a;
}

static void free_maps(atlas *a) {
  for (int i = 0; i < a->maps * a->layers; i++) free(a->depth[i]);
}

typedef struct {
  double s, t, w;
} place;

/* The sample of a texel; false where there is none. */
static bool sample_of(const atlas *a, int map, int layer, int x, int y, place *out) {
  const pni_map_block *m = &a->block->maps[map];
  *out = (place){m->origin[0] + (x + 0.5) / m->density[0], m->origin[1] + (y + 0.5) / m->density[1], -1e30};
  if (x < 0 || y < 0 || x >= a->width || y >= a->height) return false;
  double depth = a->depth[map * a->layers + layer][y * a->width + x];
  if (depth <= 0 || depth >= 1) return false;
  out->w = m->w_of_depth[0] + m->w_of_depth[1] * depth;
  return true;
}

/* ---- a receiver, and what may be wrong about it ---- */

typedef struct {
  place m;
  double n[3], k, reach, half[2], texel[2];
  double error;                           /* of s and t */
  double sigma;                           /* of n, radians */
  double w_most, plane_least, plane_most; /* between which the library's own bounds on errors lie: open */
} receiver;

/* Positions come from a depth buffer of float over 8 units, so they are good to 2e-6; the library may take them to be
 * worse, up to 1e-5. */
static receiver receiver_at(const atlas *a, const light_axes *l, vec p, vec n, double sigma) {
  vec d = sub(p, l->origin);
  double z = dot(d, l->z), scale = l->sun ? 1 : 1 / z, map_error = a->block->w_error;
  receiver r = {.n = {dot(n, l->u), dot(n, l->v), dot(n, l->z)},
                .half = {l->half_u, l->half_v},
                .texel = {a->block->texel[0], a->block->texel[1]},
                .sigma = sigma};
  if (l->sun) d = p;
  r.m =
      l->sun ? (place){dot(p, l->u), dot(p, l->v), -dot(p, l->z)} : (place){dot(d, l->u) / z, dot(d, l->v) / z, 1 / z};
  r.k = l->sun ? r.n[2] : dot(n, d);
  r.reach = l->sun ? 1 : length(d);
  r.error = 2e-6 * scale * (1 + fabs(r.m.s) + fabs(r.m.t));
  r.w_most = map_error + scale * scale * 1e-5;
  r.plane_least =
      fabs(r.k) * map_error + a->block->raster_error * (fabs(r.n[0]) * r.texel[0] + fabs(r.n[1]) * r.texel[1]);
  r.plane_most = r.plane_least + scale * 1e-5 * 1.8;
  return r;
}

/* Whether a sample hides light: nearer, in front of the tangent plane, and where asked above what a crease may rise. */
static int hides(const receiver *r, const place *q, bool crease, double cell) {
  double ds = q->s - r->m.s, dt = q->t - r->m.t, dw = q->w - r->m.w, front = r->n[0] * ds + r->n[1] * dt - r->k * dw;
  double rise = crease ? fmin(fmax(fabs(ds), fabs(dt)), cell) : 0, lever = fabs(ds) + fabs(dt) + r->reach * fabs(dw);
  /* Whether the rise comes on top of the error or instead of it is left open. */
  double angle = r->sigma * lever, least = fmax(r->plane_least + angle, rise),
         most = r->plane_most + angle + 1e-5 * lever + rise, rounding = 1e-6 * (1 + r->reach);
  if (dw < -1e-6 || front < least - rounding) return NO;
  return dw > r->w_most + 1e-6 && front > most + rounding ? YES : MAYBE;
}

/* ---- the light's samples ---- */

typedef struct {
  int grid;
  bool jittered;
  unsigned char sure[GRID_MAX * GRID_MAX], maybe[GRID_MAX * GRID_MAX];
} field;

static void sample_place(const field *f, int i, int j, double at[2]) {
  at[0] = (i + (f->jittered ? (j & 1 ? 0.25 : 0.75) : 0.5)) / f->grid;
  at[1] = (j + (f->jittered ? (i & 1 ? 0.75 : 0.25) : 0.5)) / f->grid;
}

static int first_of(const field *f, double x) { return (int)fmin(fmax(floor(x * f->grid) - 1, 0), f->grid); }

typedef struct {
  double low[2], high[2];
} box;

/* open: by how much an edge may be wrong. */
static void cover_box(field *f, const box *b, double open, int how) {
  for (int j = first_of(f, b->low[1]); j < f->grid && (double)j / f->grid <= b->high[1] + open; j++)
    for (int i = first_of(f, b->low[0]); i < f->grid && (double)i / f->grid <= b->high[0] + open; i++) {
      double p[2];
      sample_place(f, i, j, p);
      bool inside = true, near = true;
      for (int c = 0; c < 2; c++) {
        inside = inside && p[c] > b->low[c] + open && p[c] < b->high[c] - open;
        near = near && p[c] > b->low[c] - open && p[c] < b->high[c] + open;
      }
      if (inside && how == YES) f->sure[j * f->grid + i] = 1;
      if (near) f->maybe[j * f->grid + i] = 1;
    }
}

static double edge(const double a[2], const double b[2], const double p[2]) {
  double x = b[0] - a[0], y = b[1] - a[1];
  return (x * (p[1] - a[1]) - y * (p[0] - a[0])) / fmax(hypot(x, y), 1e-12);
}

static void cover_triangle(field *f, const double *a, const double *b, const double *c, double open) {
  double turn = edge(a, b, c) >= 0 ? 1 : -1;
  for (int k = first_of(f, fmin(a[1], fmin(b[1], c[1])) - open) * f->grid; k < f->grid * f->grid; k++) {
    double p[2];
    sample_place(f, k % f->grid, k / f->grid, p);
    if (p[1] > fmax(a[1], fmax(b[1], c[1])) + 1.0 / f->grid + open) break;
    double least = fmin(fmin(turn * edge(a, b, p), turn * edge(b, c, p)), turn * edge(c, a, p));
    /* Near a sharp corner outside, the lines are all near: counted as open, which is right to do. */
    if (least > open) f->sure[k] = 1;
    if (least > -open) f->maybe[k] = 1;
  }
}

/* ---- gaps in depth: docs/space.md ---- */

/* Which of a quad's corners lie on the surface of each, a bit for each corner; how many texels the farther one goes on
 * behind the nearer; whether rounding leaves that open. */
typedef struct {
  int parts[4];
  double reach;
  bool open;
} gaps;

/* What a layer hides is in another layer of the map, in the next ones by themselves, or in none that is known. */
enum { BEHIND_NEXT = -1, BEHIND_UNKNOWN = -2 };

static double w_at(const atlas *a, int map, int layer, int x, int y) {
  place q;
  sample_of(a, map, layer, x, y, &q);
  return q.w;
}

/* A step from one sample to the next, held against the slopes on both sides, where there are any. */
static int gap_at(const atlas *a, int map, int layer, int x, int y, int dx, int dy, double turn) {
  double w[4], low = 1e30, high = -1e30, slopes = 0;
  for (int i = 0; i < 4; i++) w[i] = w_at(a, map, layer, x + (i - 1) * dx, y + (i - 1) * dy);
  if (w[1] < -1e29 || w[2] < -1e29) return NO;
  for (int i = 0; i < 3; i += 2) {
    if (w[i] < -1e29 || w[i + 1] < -1e29) continue;
    low = fmin(low, w[i + 1] - w[i]);
    high = fmax(high, w[i + 1] - w[i]);
  }
  if (low > high) low = high = 0;
  bool both = w[0] > -1e29 && w[3] > -1e29;
  slopes = both ? fabs(w[1] - w[0]) + fabs(w[3] - w[2]) : 2 * fabs(low);
  double past = fmax(low - (w[2] - w[1]), w[2] - w[1] - high) - turn - 0.25 * slopes;
  double rounding = 1e-6 * (fabs(w[1]) + fabs(w[2])) + 2e-7;
  return past > rounding ? YES : past < -rounding ? NO : MAYBE;
}

static double reach_behind(const atlas *a, int map, int behind, int x, int y, int dx, int dy, double far, double near,
                           bool *open) {
  if (behind < 0) return behind == BEHIND_NEXT ? 0 : 255;
  double reach = 0;
  for (int step = 1; step <= 128; step *= 2) {
    double w = w_at(a, map, behind, x + step * dx, y + step * dy);
    if (w > -1e29 && fabs(w - (far + near) / 2) < 1e-6) *open = true;
    if (w < -1e29 || w >= (far + near) / 2) break;
    reach = 2 * step - 1;
  }
  return reach;
}

/* Corners on the same side of every gap, found by spreading along the quad's four sides. */
static gaps gaps_of(const atlas *a, int map, int layer, int behind, int x, int y) {
  static const int sides[4][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}};
  gaps g = {{1, 2, 4, 8}, 255, false};
  double w[4], most = -1e30, reach = 255;
  for (int i = 0; i < 4; i++) most = fmax(most, w[i] = w_at(a, map, layer, x + (i & 1), y + (i >> 1)));
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i < 4; i++) {
      int p = sides[i][0], q = sides[i][1], dx = i < 2, dy = i >= 2, px = x + (p & 1), py = y + (p >> 1);
      double texel = 1 / a->block->maps[map].density[dy], turn = texel * (a->sun ? 1 : most) + 6 * a->block->w_error;
      int gap = gap_at(a, map, layer, px, py, dx, dy, turn);
      g.open = g.open || gap == MAYBE;
      if (gap == NO)
        for (int k = 0, both = g.parts[p] | g.parts[q]; k < 4; k++)
          if (both >> k & 1) g.parts[k] |= both;
      if (gap == NO || pass) continue;
      bool up = w[p] < w[q]; /* from the farther to the nearer */
      double found = reach_behind(a, map, behind, up ? px : px + dx, up ? py : py + dy, up ? dx : -dx, up ? dy : -dy,
                                  fmin(w[p], w[q]), fmax(w[p], w[q]), &g.open);
      reach = fmin(reach, found);
    }
  if (g.parts[0] != 15) g.reach = reach;
  return g;
}

/* Whether what lies beyond a gap is hidden by what goes on behind it, for lines to this receiver. */
static int bridged(const atlas *a, const receiver *r, int map, const gaps *g, const place q[4], const bool there[4]) {
  if (g->reach >= 255) return YES;
  double lever = 0, near = -1e30, far = 1e30;
  for (int i = 0; i < 4; i++) {
    lever = fmax(lever, fabs(q[i].s - r->m.s) * a->block->maps[map].density[0]);
    lever = fmax(lever, fabs(q[i].t - r->m.t) * a->block->maps[map].density[1]);
    if (!there[i]) continue;
    near = fmax(near, q[i].w - r->m.w);
    far = fmin(far, q[i].w - r->m.w);
  }
  if (near <= 2 * r->w_most) return MAYBE;
  double shift = lever * (1 - fmax(far, 0) / near), rounding = 1e-4 * (1 + lever);
  if (far < 2 * r->w_most) rounding += lever * 2 * r->w_most / near;
  return shift < g->reach - rounding ? YES : shift > g->reach + rounding ? NO : MAYBE;
}

/* ---- one primitive ---- */

static double on_light(const receiver *r, int axis, double at, double dw) {
  return 0.5 + 0.5 * (at - (axis ? r->m.t : r->m.s)) / (dw * r->half[axis]);
}

/* Edges on the light near it are wrong by the error of s, t and of w, which is no larger, over dw. */
static double open_at(const receiver *r, double dw) {
  double half = fmin(r->half[0], r->half[1]);
  return (r->error + 1e-6 * (r->half[0] + r->half[1])) / (dw * half) + 1e-6;
}

typedef struct {
  bool edges;
  primitive primitive;
  bool two_sided; /* the last layer has the farthest surfaces */
  int cap;
} shape;

static void add_patch(const atlas *a, const receiver *r, int map, int layer, int x, int y, field *f) {
  place q;
  if (!sample_of(a, map, layer, x, y, &q)) return;
  int how = hides(r, &q, true, fmax(r->texel[0], r->texel[1]));
  double dw = q.w - r->m.w;
  if (how == NO || dw <= 0) return;
  box b;
  for (int c = 0; c < 2; c++) {
    double at = c ? q.t : q.s;
    b.low[c] = on_light(r, c, at - 0.5 * r->texel[c], dw);
    b.high[c] = on_light(r, c, at + 0.5 * r->texel[c], dw);
  }
  cover_box(f, &b, open_at(r, dw), how);
}

/* Points beside the light move to its nearest edge (Fig. 6, left). */
static double clamped(double at) { return at < 0 ? 0 : at > 1 ? 1 : at; }

/* The mean of what a side's hiding corners project to, all taken to lie at there. False: none of them hides. */
static bool side_at(const receiver *r, int axis, double there, const int hide[4], const double dw[4],
                    const int corners[2], double *out) {
  double projected[2];
  int count = 0;
  for (int i = 0; i < 2; i++)
    if (hide[corners[i]] == YES) projected[count++] = clamped(on_light(r, axis, there, dw[corners[i]]));
  if (count) *out = count == 1 ? projected[0] : 0.5 * (projected[0] + projected[1]);
  return count > 0;
}

/* The rectangle through the middles of the edges of the projected quad, or of the row of it that hides: a side without
 * a corner that does lies in the middle of the cell, as far away as the other side's corners. */
static box quad_box(const receiver *r, const place q[4], const int hide[4], const double dw[4]) {
  static const int corners[2][2][2] = {{{0, 2}, {1, 3}}, {{0, 1}, {2, 3}}};
  box b;
  for (int c = 0; c < 2; c++) {
    double low = c ? q[0].t : q[0].s, high = c ? q[3].t : q[3].s, middle = 0.5 * (low + high), from, to;
    const int *near = corners[c][0], *far = corners[c][1];
    if (!side_at(r, c, low, hide, dw, near, &from)) side_at(r, c, middle, hide, dw, far, &from);
    if (!side_at(r, c, high, hide, dw, far, &to)) side_at(r, c, middle, hide, dw, near, &to);
    b.low[c] = fmin(from, to);
    b.high[c] = fmax(from, to);
  }
  return b;
}

/* Everything that the corners could span, for quads of which it is open whether their corners hide. */
static void maybe_quad(const receiver *r, const place q[4], const int hide[4], const double dw[4], field *f) {
  box b = {{1e30, 1e30}, {-1e30, -1e30}};
  double least = 1e30;
  for (int i = 0; i < 4; i++) {
    if (hide[i] == NO) continue;
    least = fmin(least, fmax(dw[i], 1e-7));
    for (int k = 0; k < 4; k++)
      for (int c = 0; c < 2; c++) {
        double at = on_light(r, c, c ? q[k].t : q[k].s, fmax(dw[i], 1e-7));
        b.low[c] = fmin(b.low[c], at);
        b.high[c] = fmax(b.high[c], at);
      }
  }
  cover_box(f, &b, open_at(r, least), MAYBE);
}

/* What is left of a quad: surface by surface, and row by row of it. */
static void add_parts(const receiver *r, const place q[4], const int hide[4], const double dw[4], const gaps *g,
                      field *f) {
  int left = 0;
  for (int i = 0; i < 4; i++) left |= (hide[i] == YES) << i;
  for (int first = 0; first < 4; first++) {
    int part = left & g->parts[first] & (first < 2 ? 3 : 12), kept[4];
    if (!(left >> first & 1)) continue;
    left &= ~part;
    double least = 1e30;
    for (int i = 0; i < 4; i++) {
      kept[i] = part >> i & 1 ? YES : NO;
      if (kept[i]) least = fmin(least, dw[i]);
    }
    box b = quad_box(r, q, kept, dw);
    cover_box(f, &b, open_at(r, least), YES);
  }
}

static void add_quad(const atlas *a, const receiver *r, int map, int layer, int x, int y, const shape *how, field *f) {
  static const gaps none = {{15, 15, 15, 15}, 255, false};
  place q[4];
  bool there[4], open = false;
  int hide[4], count[3] = {0};
  double dw[4], cell = fmax(r->texel[0], r->texel[1]), least = 1e30;
  for (int i = 0; i < 4; i++) {
    there[i] = sample_of(a, map, layer, x + (i & 1), y + (i >> 1), &q[i]);
    dw[i] = q[i].w - r->m.w;
    hide[i] = there[i] ? hides(r, &q[i], false, 0) : NO;
    count[hide[i]]++;
  }
  if (count[NO] == 4 || (count[NO] && !how->edges)) return;
  int last = a->layers - 1, behind = how->two_sided  ? (layer == last ? BEHIND_NEXT : last)
                                     : layer == last ? BEHIND_UNKNOWN
                                                     : BEHIND_NEXT;
  gaps g = gaps_of(a, map, layer, behind, x, y);
  int whole = count[NO] ? NO : bridged(a, r, map, &g, q, there), kept = bridged(a, r, map, &g, q, there);
  if (kept == YES && !g.open) g = none;
  if (whole == NO && !how->edges && !count[MAYBE] && !g.open) return;
  for (int i = 0; i < 4 && whole != YES; i++) /* single corners must rise above a crease */
    hide[i] = hide[i] == NO ? NO : hides(r, &q[i], true, cell);
  for (int i = 0; i < 4; i++) open = open || hide[i] == MAYBE;
  if (hide[0] + hide[1] + hide[2] + hide[3] == NO) return;
  if (open || g.open || kept == MAYBE) {
    int any[4];
    for (int i = 0; i < 4; i++) any[i] = there[i] && dw[i] > -1e-6 && hides(r, &q[i], false, 0) != NO ? MAYBE : NO;
    maybe_quad(r, q, any, dw, f);
    return;
  }
  if (whole == NO) {
    add_parts(r, q, hide, dw, &g, f);
    return;
  }
  for (int i = 0; i < 4; i++) least = fmin(least, dw[i]);
  if (how->primitive == QUAD) {
    box b = quad_box(r, q, hide, dw);
    cover_box(f, &b, open_at(r, least), YES);
    return;
  }
  double p[4][2];
  for (int i = 0; i < 4; i++)
    for (int c = 0; c < 2; c++) p[i][c] = on_light(r, c, c ? q[i].t : q[i].s, dw[i]);
  cover_triangle(f, p[0], p[1], p[2], open_at(r, least));
  cover_triangle(f, p[1], p[3], p[2], open_at(r, least));
}

/* ---- past the cap ---- */

/* The nearest sample of a block of size x size texels, put at the middle of the block; where in the block it was is not
 * known: between low and high. */
typedef struct {
  place q;
  bool there;
  double low[2], high[2];
} block;

static block block_of(const atlas *a, int map, int layer, int size, int x, int y, double margin) {
  const pni_map_block *m = &a->block->maps[map];
  const int at[2] = {x, y}, count[2] = {a->width, a->height};
  block b = {
      .q = {m->origin[0] + (x + 0.5) * size / m->density[0], m->origin[1] + (y + 0.5) * size / m->density[1], -1e30}};
  for (int c = 0; c < 2; c++) {
    b.low[c] = m->origin[c] + (at[c] * size + 0.5 - margin) / m->density[c];
    b.high[c] = m->origin[c] + (fmin((at[c] + 1) * size, count[c]) - 0.5 + margin) / m->density[c];
  }
  for (int i = 0; i < size * size; i++) {
    place q;
    if (!sample_of(a, map, layer, x * size + i % size, y * size + i / size, &q)) continue;
    b.q.w = fmax(b.q.w, q.w);
    b.there = true;
  }
  return b;
}

/* Whether it hides light, wherever in its block it lies: the receiver's own plane, which has its nearest point at a
 * corner of the block, must not. What uncertain normals do is taken at the farthest corner. */
static int block_hides(const receiver *r, const block *b) {
  double lever[2] = {fmax(fabs(b->low[0] - r->m.s), fabs(b->high[0] - r->m.s)),
                     fmax(fabs(b->low[1] - r->m.t), fabs(b->high[1] - r->m.t))};
  int least = b->there ? YES : NO;
  for (int i = 0; i < 4 && least; i++) {
    receiver at = *r;
    place q = {i & 1 ? b->high[0] : b->low[0], i & 2 ? b->high[1] : b->low[1], b->q.w};
    double more = r->sigma * (lever[0] + lever[1] - fabs(q.s - r->m.s) - fabs(q.t - r->m.t));
    at.plane_least += more;
    at.plane_most += more;
    int how = hides(&at, &q, false, 0);
    if (how < least) least = how;
  }
  return least;
}

static void add_block_patch(const atlas *a, const receiver *r, int map, int layer, int size, int x, int y, field *f) {
  block k = block_of(a, map, layer, size, x, y, 0.5);
  int how = block_hides(r, &k);
  double dw = k.q.w - r->m.w;
  if (how == NO || dw <= 0) return;
  box b;
  for (int c = 0; c < 2; c++) {
    b.low[c] = on_light(r, c, k.low[c], dw);
    b.high[c] = on_light(r, c, k.high[c], dw);
  }
  cover_box(f, &b, open_at(r, dw), how);
}

/* A microquad between the middles of four blocks, all of which must hide; what lies between them is bridged. */
static void add_block_quad(const atlas *a, const receiver *r, int map, int layer, int size, int x, int y, field *f) {
  place q[4];
  int hide[4], count[3] = {0};
  double dw[4], least = 1e30;
  for (int i = 0; i < 4; i++) {
    block k = block_of(a, map, layer, size, x + (i & 1), y + (i >> 1), 0);
    q[i] = k.q;
    dw[i] = q[i].w - r->m.w;
    hide[i] = block_hides(r, &k);
    count[hide[i]]++;
    least = fmin(least, dw[i]);
  }
  if (count[NO]) return;
  if (count[MAYBE]) maybe_quad(r, q, hide, dw, f);
  else {
    box b = quad_box(r, q, hide, dw);
    cover_box(f, &b, open_at(r, least), YES);
  }
}

/* How many primitives of blocks of that size meet what the search looks at along an axis: all that casters could need
 * who are as near to the light as one may be, rounded out to whole primitives of single texels, inside the map. Less
 * than 0: rounding leaves it open. */
static int primitives_across(const atlas *a, const receiver *r, int axis, int size, const shape *how) {
  const pni_map_block *m = &a->block->maps[0];
  double reach = r->half[axis] * (a->block->w_near - r->m.w), middle = axis ? r->m.t : r->m.s,
         begin = how->primitive == PATCH ? 0 : 0.5,
         from = (middle - reach - m->origin[axis]) * m->density[axis] - begin,
         to = (middle + reach - m->origin[axis]) * m->density[axis] - begin, last = (axis ? a->height : a->width) - 1;
  const double rounding = 1e-3;
  if (fabs(from - round(from)) < rounding || fabs(to - round(to)) < rounding) return -1;
  from = fmax(floor(from), 0) + begin;
  to = fmin(floor(to), last) + 1 + begin;
  int count = 0;
  for (int i = -2; i * size <= last + 1; i++)
    count += (i + begin) * size < to && (i + 1 + begin) * size > from && from < to;
  return count;
}

/* Texels a side of the smallest blocks that the cap admits; 0: rounding leaves it open. */
static int block_size(const atlas *a, const receiver *r, const shape *how) {
  for (int size = 1;; size *= 2) {
    int across = primitives_across(a, r, 0, size, how), up = primitives_across(a, r, 1, size, how);
    if (across < 0 || up < 0) return 0;
    if (how->cap == 0 || (across <= how->cap && up <= how->cap)) return size;
  }
}

static void cover_blocks(const atlas *a, const receiver *r, int size, const shape *how, field *f) {
  for (int layer = 0; layer < a->layers; layer++)
    for (int y = -1; y * size < a->height; y++)
      for (int x = -1; x * size < a->width; x++) {
        if (how->primitive == PATCH) add_block_patch(a, r, 0, layer, size, x, y, f);
        else add_block_quad(a, r, 0, layer, size, x, y, f);
      }
}

static void cover_all(const atlas *a, const receiver *r, const shape *how, field *f) {
  for (int map = 0; map < a->maps; map++)
    for (int layer = 0; layer < a->layers; layer++)
      for (int y = 0; y < a->height; y++)
        for (int x = 0; x < a->width; x++) {
          if (how->primitive == PATCH) add_patch(a, r, map, layer, x, y, f);
          else add_quad(a, r, map, layer, x, y, how, f);
        }
}

/* ---- comparing ---- */

typedef struct {
  int compared, hidden, open, outside, coarse, searched;
  double worst;
} tally;

/* The point that the stored depth says, on the pixel's line through the exact one. */
static vec stored_point(const view *v, int pixel) {
  const camera *k = &v->camera;
  vec p = view_point(v, pixel % PIXELS, pixel / PIXELS), forward = unit(sub(k->target, k->eye));
  return add(p, mul(k->near + v->depths[pixel] * (k->far - k->near) - dot(sub(p, k->eye), forward), forward));
}

/* Samples above the horizon that are hidden, over all above. */
static void compare_pixel(const receiver *r, const field *f, double visibility, tally *t) {
  int total = 0, sure = 0, maybe = 0;
  for (int k = 0; k < f->grid * f->grid; k++) {
    double p[2];
    sample_place(f, k % f->grid, k / f->grid, p);
    double u = r->n[0] * r->half[0], v = r->n[1] * r->half[1], h = (2 * p[0] - 1) * u + (2 * p[1] - 1) * v - r->k;
    if (fabs(h) < 1e-5 * (fabs(u) + fabs(v) + fabs(r->k) + 1)) return; /* open which samples there are */
    if (h < 0) continue;
    total++;
    sure += f->sure[k];
    maybe += f->maybe[k];
  }
  double hidden = total ? (1 - visibility) * total : 0;
  t->compared++;
  t->hidden += sure > 0;
  t->open += maybe - sure;
  if (total == 0 ? visibility == 1 : hidden > sure - 0.01 && hidden < maybe + 0.01) return;
  t->outside++;
  t->worst = fmax(t->worst, fmax(sure - hidden, hidden - maybe) / fmax(total, 1));
}

static void make_scene(uint64_t *seed, soup *casters, soup *seen) {
  vec tilt = v3(2, random_in(seed, -0.6, 0.6), 0);
  soup_patch(seen, v3(0, 0, 0), tilt, v3(0, 0, 2));
  if (random_bits(seed) & 1) soup_patch(casters, v3(0, 0, 0), tilt, v3(0, 0, 2));
  int count = 1 + (int)random_in(seed, 0, 5);
  for (int i = 0; i < count; i++) {
    vec a = random_direction(seed), b = unit(cross(a, random_direction(seed))),
        centre = add(v3(0, 0.8, 0), random_point(seed, 0.5));
    for (int k = 0; k < 2; k++) {
      soup *s = k ? casters : seen;
      if (i & 1) soup_block(s, centre, mul(0.3, a), mul(0.2, b), mul(0.15, cross(a, b)));
      else soup_patch(s, centre, mul(0.5, a), mul(0.2, b));
    }
  }
}

static pn_light_desc pick_light(uint64_t *seed, int round) {
  static const int maps[] = {1, 2, 3, 9, 16, 24};
  vec from = unit(v3(random_in(seed, -0.4, 0.4), 1, random_in(seed, -0.4, 0.4)));
  double size = exp2(random_in(seed, -4, 0.5));
  int map = maps[(int)random_in(seed, 0, 6)];
  pn_light_desc light = round & 1 ? sun_along(mul(-1, from), fmin(size, 1), 0.4 * fmin(size, 1), map)
                                  : light_at(mul(round % 4 == 2 ? 1.7 : 3, from), mul(-1, from), size, 0.6 * size, map);
  if (round % 3 == 0) light.map_height = maps[(int)random_in(seed, 0, 6)];
  return light;
}

/* A debug image's floats, channels of them a pixel. */
static float *debug_image(const stage *s, const char *wanted, int channels) {
  pn_image image;
  const char *name;
  for (int i = 0; pn_debug_image(s->light, s->receiver, i, &name, &image); i++)
    if (strcmp(name, wanted) == 0) return gl_read_texture(image.texture, 0, -1, PIXELS, PIXELS, channels);
  return NULL;
}

/* What a pixel that looked at primitives says of their level. */
static void compare_level(const float *search, const float *levels, int size, tally *t) {
  enum { PENUMBRA = 3 };
  if (!search || search[0] != PENUMBRA) return;
  t->searched++;
  assert_int_equal(1 << (int)levels[0], size);
}

/* s: kept from round to round, since compiling takes longer than looking. */
static void look(stage *s, const char *spec, const shape *how, int code, int round, tally *t) {
  uint64_t seed = 500 + (uint64_t)round;
  soup casters = {0}, seen = {0};
  make_scene(&seed, &casters, &seen);
  camera k = {.width = PIXELS,
              .height = PIXELS,
              .eye = v3(0.8, 3, 1.5),
              .target = v3(0, 0.3, 0),
              .up = v3(0, 1, 0),
              .orthographic = true,
              .half_height = 1.3,
              .near = 0.5,
              .far = 8};
  view v;
  view_draw(&v, &k, &seen);
  pn_casters_destroy(&s->casters);
  assert_ok(pn_casters_create(s->context, &s->casters));
  stage_cast(s, &casters);
  stage_receive(s, &v, true);
  /* Exact normals, of which the library believes in every other round that they are off by up to a degree. */
  if (round & 2) s->receiver->normal_error = 0.02f;
  pn_light_desc light = pick_light(&seed, round);
  light_axes axes = axes_of(&light);
  float *visibility = stage_visibility(s, &light, spec);
  pn_maps_info info;
  assert_ok(pn_light_maps(s->light, &info));
  atlas a = read_maps(s);
  int outside = t->outside;
  float *search = debug_image(s, "search", 4), *levels = debug_image(s, "levels", 2);
  for (int i = 0; i < PIXELS * PIXELS && !info.empty && a.maps == 1; i++) {
    if (v.shown[i] < 0) continue;
    vec p = stored_point(&v, i);
    if (!axes.sun && dot(sub(p, axes.origin), axes.z) < 0.05) continue;
    receiver r = receiver_at(&a, &axes, p, view_normal(&v, i % PIXELS, i / PIXELS), (double)s->receiver->normal_error);
    field f = {.grid = code == 17 ? 16 : code, .jittered = code == 17};
    int size = how->cap ? block_size(&a, &r, how) : 1;
    if (size == 0) continue;
    t->coarse += size > 1;
    compare_level(search ? search + 4 * i : NULL, levels + 2 * i, size, t);
    if (size > 1) cover_blocks(&a, &r, size, how, &f);
    else cover_all(&a, &r, how, &f);
    compare_pixel(&r, &f, visibility[i], t);
  }
  if (t->outside > outside)
    print_message("%s, round %d: %d of %d pixels outside, by up to %g\n", spec, round, t->outside - outside,
                  PIXELS * PIXELS, t->worst);
  free_maps(&a);
  free(search);
  free(levels);
  free(visibility);
  view_free(&v);
  soup_free(&casters);
  soup_free(&seen);
}

static void check_cap(const char *primitive_name, primitive p, bool edges, const char *samples, int code,
                      const char *maps, int cap, int rounds) {
  char spec[128];
  tally t = {0};
  shape how = {edges, p, strcmp(maps, "two-sided") == 0, cap};
  snprintf(spec, sizeof spec, "bitmask:merge=0,hierarchy=none,primitive=%s,edges=%s,samples=%s,maps=%s,cap=%d",
           primitive_name, edges ? "on" : "off", samples, maps, cap);
  stage s;
  stage_open(&s);
  if (cap) assert_ok(pn_debug(s.context, PN_DEBUG_SEARCH));
  for (int round = 0; round < rounds; round++) look(&s, spec, &how, code, round, &t);
  stage_close(&s);
  print_message("%s: %d pixels, %d in shadow, %d by blocks, %.3f samples open a pixel, %d outside\n", spec, t.compared,
                t.hidden, t.coarse, (double)t.open / t.compared, t.outside);
  assert_true(t.compared > 64 * rounds && t.hidden > t.compared / 20);
  assert_true(t.open < 0.02 * code * code * t.compared); /* else the comparison says little */
  assert_true(cap == 0 || (t.coarse > t.compared / 4 && t.searched > t.compared / 4));
  assert_int_equal(t.outside, 0);
}

static void check(const char *primitive_name, primitive p, bool edges, const char *samples, int code, const char *maps,
                  int rounds) {
  check_cap(primitive_name, p, edges, samples, code, maps, 0, rounds);
}

static void test_patches(void **state) {
  (void)state;
  check("patch", PATCH, true, "16j", 17, "front", 10);
  check("patch", PATCH, true, "8", 8, "two-sided", 10);
  check("patch", PATCH, true, "32", 32, "layers,layers=3", 6);
}

static void test_quads(void **state) {
  (void)state;
  check("quad", QUAD, true, "16j", 17, "two-sided", 10);
  check("quad", QUAD, false, "16", 16, "front", 10);
  check("quad", QUAD, true, "32", 32, "layers,layers=4", 6);
}

static void test_exact_quads(void **state) {
  (void)state;
  check("quad-exact", EXACT, true, "16j", 17, "front", 10);
  check("quad-exact", EXACT, true, "32", 32, "two-sided", 6);
}

/* Coarse blocks hide the more the less the cap is: patches grow to their nearest sample's w. */
static void test_cap(void **state) {
  (void)state;
  check_cap("patch", PATCH, true, "16j", 17, "front", 4, 10);
  check_cap("patch", PATCH, true, "16", 16, "two-sided", 3, 10);
  check_cap("quad", QUAD, false, "16j", 17, "front", 4, 10);
  check_cap("quad", QUAD, true, "32", 32, "two-sided", 3, 10);
  check_cap("quad", QUAD, true, "16", 16, "layers,layers=2", 2, 10);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_patches), cmocka_unit_test(test_quads),
                                     cmocka_unit_test(test_exact_quads), cmocka_unit_test(test_cap)};
  return GL_RUN("searches against every texel", tests);
}
