#include "receiver/grid.h"

#include <math.h>
#include <string.h>

#include "gl/host.h"

enum { N = PNI_GRID_CELLS, BLOCK = PNI_GRID_BLOCK, BLOCKS = N / BLOCK };

/* ---- making ------------------------------------------------------------------------------------------------------ */

static int cell_of(const pni_grid *g, int axis, double at) {
  double cell = floor((at - g->origin[axis]) / g->cell[axis]);
  return cell < 0 ? 0 : cell > N - 1 ? N - 1 : (int)cell;
}

typedef struct {
  int low[2], high[2]; /* both included */
} cells;

static cells cells_between(const pni_grid *g, const double low[2], const double high[2]) {
  cells c;
  for (int i = 0; i < 2; i++) {
    c.low[i] = cell_of(g, i, low[i]);
    c.high[i] = cell_of(g, i, high[i]);
  }
  return c;
}

static void place_grid(pni_grid *g, const pni_patch_list *patches) {
  g->region = pni_region_empty();
  for (int i = 0; i < patches->count; i++) {
    pni_region_add(&g->region, patches->patches[i].least);
    pni_region_add(&g->region, patches->patches[i].most);
  }
  for (int i = 0; i < 2; i++) {
    double extent = patches->count ? g->region.most[i] - g->region.least[i] : 0;
    g->origin[i] = patches->count ? g->region.least[i] : 0;
    g->cell[i] = fmax(extent, 1e-6 * fabs(g->origin[i]) + 1e-12) / N;
  }
}

/* Counts each cell's patches, or with list puts them there. */
static void each_cell(pni_grid *g, const pni_patch_list *patches, int *next, int *list) {
  for (int i = 0; i < patches->count; i++) {
    const pni_patch *p = &patches->patches[i];
    cells c = cells_between(g, p->least, p->most);
    for (int y = c.low[1]; y <= c.high[1]; y++)
      for (int x = c.low[0]; x <= c.high[0]; x++) {
        int cell = y * N + x, block = y / BLOCK * BLOCKS + x / BLOCK;
        if (list) list[next[cell]] = i;
        next[cell]++;
        g->least_w[cell] = fmin(g->least_w[cell], p->least[2]);
        g->block_w[block] = fmin(g->block_w[block], p->least[2]);
      }
  }
}

static pn_result fill_grid(pni_gpu *gpu, pni_grid *g, const pni_patch_list *patches) {
  int *next = pni_allocate_zero(gpu, (N * N + 1) * sizeof *next);
  g->first = pni_allocate_zero(gpu, (N * N + 1) * sizeof *g->first);
  if (next && g->first) {
    each_cell(g, patches, next, NULL);
    for (int i = 0; i < N * N; i++) g->first[i + 1] = g->first[i] + next[i];
    memcpy(next, g->first, (N * N + 1) * sizeof *next);
    g->list = pni_allocate_zero(gpu, (size_t)(g->first[N * N] + 1) * sizeof *g->list);
    if (g->list) each_cell(g, patches, next, g->list);
  }
  pni_free(gpu, next);
  return g->list ? PN_OK : PN_ERROR_OUT_OF_MEMORY;
}

pn_result pni_grid_make(pni_gpu *gpu, const pni_patch_list *patches, const double extent[2], pni_grid **out) {
  pni_grid *g = *out = pni_allocate_zero(gpu, sizeof *g);
  if (!g) return PN_ERROR_OUT_OF_MEMORY;
  g->patches = patches->patches;
  g->list_of = patches;
  memcpy(g->extent, extent, sizeof g->extent);
  for (int i = 0; i < N * N; i++) g->least_w[i] = INFINITY;
  for (int i = 0; i < BLOCKS * BLOCKS; i++) g->block_w[i] = INFINITY;
  place_grid(g, patches);
  pn_result result = fill_grid(gpu, g, patches);
  if (result != PN_OK) pni_grid_free(gpu, out);
  return result;
}

void pni_grid_free(pni_gpu *gpu, pni_grid **grid) {
  if (!*grid) return;
  pni_free(gpu, (*grid)->first);
  pni_free(gpu, (*grid)->list);
  pni_free(gpu, *grid);
  *grid = NULL;
}

/* ---- asking ------------------------------------------------------------------------------------------------------ */

typedef struct {
  const pni_grid *grid;
  const double (*points)[3];
  int count;
  const pni_caster_error *error;
  double least[2], most[2], w; /* bounds of the points; the largest w */
} question;

/* How far apart two ranges are, in widths of the light's window for a difference of 1 in w. */
static double apart(const question *q, const double least[2], const double most[2]) {
  double far = 0;
  for (int i = 0; i < 2; i++) {
    double gap = fmax(fmax(q->least[i] - most[i], least[i] - q->most[i]), 0) - q->error->place[i];
    far = fmax(far, gap > 0 ? gap / q->grid->extent[i] : 0);
  }
  return far;
}

/* docs/space.md: a point h above a plane that is below all of a patch can shadow only what lies within h / (1 - k). */
static bool shadows_patch(const question *q, const pni_patch *p) {
  const double *slope = p->slope;
  double above = -INFINITY;
  for (int i = 0; i < q->count; i++)
    above = fmax(above, q->points[i][2] - slope[0] * q->points[i][0] - slope[1] * q->points[i][1]);
  above -= p->offset;
  double k = fabs(slope[0]) * q->grid->extent[0] + fabs(slope[1]) * q->grid->extent[1];
  /* the plane itself is found from points that are off, in either direction */
  double error = 3 * p->error + q->error->w + fabs(slope[0]) * q->error->place[0] + fabs(slope[1]) * q->error->place[1];
  return above > error && q->w > p->least[2] && apart(q, p->least, p->most) * (1 - k) <= above;
}

static bool near_enough(const question *q, int x, int y, int size, double least_w) {
  const pni_grid *g = q->grid;
  if (!(q->w > least_w)) return false;
  double low[2] = {g->origin[0] + x * g->cell[0], g->origin[1] + y * g->cell[1]};
  double high[2] = {low[0] + size * g->cell[0], low[1] + size * g->cell[1]};
  return apart(q, low, high) <= (q->w - least_w) * (1 + 1e-9);
}

static bool shadows_block(const question *q, const cells *c, int bx, int by) {
  const pni_grid *g = q->grid;
  if (!near_enough(q, bx * BLOCK, by * BLOCK, BLOCK, g->block_w[by * BLOCKS + bx])) return false;
  for (int y = by * BLOCK; y < (by + 1) * BLOCK; y++)
    for (int x = bx * BLOCK; x < (bx + 1) * BLOCK; x++) {
      int cell = y * N + x;
      if (x < c->low[0] || y < c->low[1] || x > c->high[0] || y > c->high[1]) continue;
      if (!near_enough(q, x, y, 1, g->least_w[cell])) continue;
      for (int i = g->first[cell]; i < g->first[cell + 1]; i++)
        if (shadows_patch(q, &g->patches[g->list[i]])) return true;
    }
  return false;
}

bool pni_grid_shadowed(const pni_grid *grid, const double (*points)[3], int count, const pni_caster_error *error) {
  question q = {grid, points, count, error, {INFINITY, INFINITY}, {-INFINITY, -INFINITY}, -INFINITY};
  for (int k = 0; k < count; k++) {
    for (int i = 0; i < 2; i++) {
      q.least[i] = fmin(q.least[i], points[k][i]);
      q.most[i] = fmax(q.most[i], points[k][i]);
    }
    q.w = fmax(q.w, points[k][2]);
  }
  double reach = q.w - grid->region.least[2], low[2], high[2];
  if (!(reach > 0)) return false;
  for (int i = 0; i < 2; i++) {
    double grow = grid->extent[i] * reach + error->place[i];
    low[i] = q.least[i] - grow;
    high[i] = q.most[i] + grow;
    if (low[i] > grid->region.most[i] || high[i] < grid->region.least[i]) return false;
  }
  cells c = cells_between(grid, low, high);
  for (int by = c.low[1] / BLOCK; by <= c.high[1] / BLOCK; by++)
    for (int bx = c.low[0] / BLOCK; bx <= c.high[0] / BLOCK; bx++)
      if (shadows_block(&q, &c, bx, by)) return true;
  return false;
}

/* ---- the plane of most ------------------------------------------------------------------------------------------- */

static void middle_of(const pni_patch *p, double out[3]) {
  for (int i = 0; i < 2; i++) out[i] = 0.5 * (p->least[i] + p->most[i]);
  out[2] = p->offset + p->slope[0] * out[0] + p->slope[1] * out[1];
}

/* a x + b y = c in both rows; false where the rows are parallel. */
static bool solve2(const double a[2], const double b[2], const double c[2], double out[2]) {
  double det = a[0] * b[1] - a[1] * b[0];
  if (!(fabs(det) > 1e-9 * (fabs(a[0] * b[1]) + fabs(a[1] * b[0])))) return false;
  out[0] = (c[0] * b[1] - c[1] * b[0]) / det;
  out[1] = (a[0] * c[1] - a[1] * c[0]) / det;
  return true;
}

/* Through the middles of three patches: over more than one patch, slopes are so much more exact. */
static bool slopes_through(const pni_patch_list *patches, const int index[3], double slope[2]) {
  double m[3][3], a[2], b[2], c[2];
  for (int i = 0; i < 3; i++) middle_of(&patches->patches[index[i]], m[i]);
  for (int i = 0; i < 2; i++) {
    a[i] = m[i + 1][0] - m[0][0];
    b[i] = m[i + 1][1] - m[0][1];
    c[i] = m[i + 1][2] - m[0][2];
  }
  return solve2(a, b, c, slope);
}

static bool in_plane(const pni_patch *p, const double m[3], const double plane[3]) {
  return fabs(m[2] - plane[2] - plane[0] * m[0] - plane[1] * m[1]) <= 8 * p->error;
}

static int count_in_plane(const pni_patch_list *patches, const double plane[3]) {
  int count = 0;
  for (int i = 0; i < patches->count; i++) {
    double m[3];
    middle_of(&patches->patches[i], m);
    count += in_plane(&patches->patches[i], m, plane);
  }
  return count;
}

/* The least squares of the patches that lie in the plane as far as they can tell, each weighing as its error says. */
static bool fit_plane(const pni_patch_list *patches, double plane[3]) {
  double sum[3] = {0}, weight = 0, a[2] = {0}, b[2] = {0}, c[2] = {0}, m[3];
  for (int i = 0; i < 2 * patches->count; i++) { /* the middle first, then around it */
    const pni_patch *p = &patches->patches[i % patches->count];
    double own = 1 / (p->error * p->error);
    middle_of(p, m);
    if (!in_plane(p, m, plane)) continue;
    for (int k = 0; k < 3 && i < patches->count; k++) sum[k] += own * m[k];
    if (i < patches->count) weight += own;
    if (i < patches->count) continue;
    for (int k = 0; k < 3; k++) m[k] -= sum[k] / weight;
    for (int k = 0; k < 2; k++) {
      a[k] += own * m[k] * m[0];
      b[k] += own * m[k] * m[1];
      c[k] += own * m[k] * m[2];
    }
  }
  if (!(weight > 0) || !solve2(a, b, c, plane)) return false;
  plane[2] = (sum[2] - plane[0] * sum[0] - plane[1] * sum[1]) / weight;
  return true;
}

bool pni_grid_plane(const pni_grid *g, double plane[3]) {
  enum { TRIES = 64 };
  const pni_patch_list *patches = g->list_of;
  uint32_t random = 1;
  int most = 0;
  for (int i = 0; i < TRIES && patches->count >= 3; i++) {
    int index[3];
    double m[3], tried[3];
    for (int k = 0; k < 3; k++) {
      random = random * 1664525u + 1013904223u;
      index[k] = (int)((random >> 8) % (uint32_t)patches->count);
    }
    if (!slopes_through(patches, index, tried)) continue;
    middle_of(&patches->patches[index[0]], m);
    tried[2] = m[2] - tried[0] * m[0] - tried[1] * m[1];
    int count = count_in_plane(patches, tried);
    if (count <= most) continue;
    most = count;
    memcpy(plane, tried, sizeof tried);
  }
  return most >= 3 && fit_plane(patches, plane) && fabs(plane[0]) * g->extent[0] + fabs(plane[1]) * g->extent[1] < 1;
}
