/* Finding a mesh's edges: vertices at one place are joined, then triangles' sides are sorted by their two ends. */
#include "silhouettes/edges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl/host.h"

static const uint32_t none = 0xffffffffu;

/* ---- joining vertices -------------------------------------------------------------------------------------------- */

typedef struct {
  const float *positions;
  uint32_t *table, *same; /* same: the first vertex at that place, or none */
  size_t mask;
} welding;

static uint64_t mix(uint64_t z) { /* splitmix64 */
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

static uint64_t hash_position(const float p[3]) {
  uint64_t hash = 0;
  for (int i = 0; i < 3; i++) {
    float value = p[i] + 0.0f; /* -0 is 0 */
    uint32_t bits;
    memcpy(&bits, &value, 4);
    hash = mix(hash + 0x9e3779b97f4a7c15u + bits);
  }
  return hash;
}

static uint32_t find_same(const welding *w, uint32_t vertex) {
  const float *p = w->positions + 3 * (size_t)vertex;
  if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2])) return none;
  for (size_t slot = hash_position(p) & w->mask;; slot = (slot + 1) & w->mask) {
    uint32_t known = w->table[slot];
    if (known == none) return w->table[slot] = vertex;
    const float *q = w->positions + 3 * (size_t)known;
    if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) return known;
  }
}

static pn_result join_vertices(pni_gpu *gpu, const float *positions, size_t vertices, uint32_t **same) {
  size_t slots = 16;
  while (slots < 2 * vertices) slots *= 2;
  welding w = {positions, pni_reallocate(gpu, NULL, slots * sizeof(uint32_t)),
               pni_reallocate(gpu, NULL, vertices * sizeof(uint32_t)), slots - 1};
  if (w.table && w.same) {
    memset(w.table, 0xff, slots * sizeof *w.table);
    for (size_t i = 0; i < vertices; i++) w.same[i] = find_same(&w, (uint32_t)i);
  }
  bool done = w.table && w.same;
  pni_free(gpu, w.table);
  if (!done) pni_free(gpu, w.same);
  *same = done ? w.same : NULL;
  return done ? PN_OK : PN_ERROR_OUT_OF_MEMORY;
}

/* ---- sides of triangles ------------------------------------------------------------------------------------------ */

typedef struct {
  uint32_t low, high, opposite;
  bool backward; /* the triangle goes from high to low */
} side;

/* The triangle's corners after joining; false: left out. */
static bool triangle_corners(const uint32_t *same, size_t vertices, const uint32_t *index, uint32_t out[3]) {
  for (int i = 0; i < 3; i++) {
    if (index[i] >= vertices) return false;
    out[i] = same[index[i]];
    if (out[i] == none) return false;
  }
  return out[0] != out[1] && out[1] != out[2] && out[2] != out[0];
}

static size_t collect_sides(const uint32_t *same, size_t vertices, const uint32_t *indices, size_t count, side *out,
                            size_t *dropped) {
  size_t sides = 0;
  for (size_t t = 0; t + 2 < count; t += 3) {
    uint32_t c[3];
    if (!triangle_corners(same, vertices, indices + t, c)) {
      ++*dropped;
      continue;
    }
    for (int i = 0; i < 3; i++) {
      uint32_t a = c[i], b = c[(i + 1) % 3];
      out[sides++] = (side){a < b ? a : b, a < b ? b : a, c[(i + 2) % 3], a > b};
    }
  }
  return sides;
}

static int compare_sides(const void *a, const void *b) {
  const side *x = a, *y = b;
  if (x->high != y->high) return x->high < y->high ? -1 : 1;
  if (x->opposite != y->opposite) return x->opposite < y->opposite ? -1 : 1;
  return x->backward - y->backward;
}

/* By the lower end in one pass, then each of those few by the rest. */
static pn_result sort_sides(pni_gpu *gpu, side **sides, size_t count, size_t vertices) {
  size_t *start = pni_allocate_zero(gpu, (vertices + 1) * sizeof *start);
  side *sorted = pni_reallocate(gpu, NULL, count * sizeof *sorted);
  if (start && sorted) {
    for (size_t i = 0; i < count; i++) start[(*sides)[i].low + 1]++;
    for (size_t v = 0; v < vertices; v++) start[v + 1] += start[v];
    for (size_t i = 0; i < count; i++) sorted[start[(*sides)[i].low]++] = (*sides)[i];
    size_t first = 0; /* start[v] has moved on to the end of v */
    for (size_t v = 0; v < vertices; first = start[v++])
      qsort(sorted + first, start[v] - first, sizeof *sorted, compare_sides);
  }
  bool done = start && sorted;
  pni_free(gpu, start);
  pni_free(gpu, done ? *sides : sorted);
  if (done) *sides = sorted;
  return done ? PN_OK : PN_ERROR_OUT_OF_MEMORY;
}

/* ---- edges ------------------------------------------------------------------------------------------------------- */

/* Sides with the same ends make one edge, or, where their faces are three and more, one edge for each: a smoothie that
 * another face covers is covered by that face's own, so that nothing is lost. Faces drawn twice count once. */
static void add_edge(pni_edge_list *list, const side *s, size_t count) {
  size_t faces = 1;
  for (size_t i = 1; i < count; i++) faces += s[i].opposite != s[i - 1].opposite;
  if (faces == 2) {
    const side *last = &s[count - 1];
    list->opposed += count == 2 && s[0].backward == last->backward;
    list->edges[list->count++] = (pni_edge){{s->low, s->high}, {s->opposite, last->opposite}};
    return;
  }
  list->open += faces == 1;
  list->crowded += faces > 2;
  for (size_t i = 0; i < count; i++)
    if (i == 0 || s[i].opposite != s[i - 1].opposite)
      list->edges[list->count++] = (pni_edge){{s[i].low, s[i].high}, {s[i].opposite, s[i].opposite}};
}

static void add_edges(pni_edge_list *list, const side *sides, size_t count) {
  for (size_t first = 0, end; first < count; first = end) {
    end = first + 1;
    while (end < count && sides[end].low == sides[first].low && sides[end].high == sides[first].high) end++;
    add_edge(list, sides + first, end - first);
  }
}

static void add_rings(pni_edge_list *list) {
  for (size_t e = 0; e < list->count; e++)
    for (int i = 0; i < 2; i++) list->rings[list->edges[e].ends[i]].count++;
  uint32_t first = 0;
  for (size_t v = 0; v < list->vertices; v++) {
    list->rings[v].first = first;
    first += list->rings[v].count;
    list->rings[v].count = 0;
  }
  for (size_t e = 0; e < list->count; e++)
    for (int i = 0; i < 2; i++) {
      pni_ring *ring = &list->rings[list->edges[e].ends[i]];
      list->entries[ring->first + ring->count++] = (pni_ring_entry){(uint32_t)e, list->edges[e].ends[1 - i]};
    }
}

/* Software GL ends a shader's loops after 65535 turns, and drivers give up on a draw that takes too many in all. */
static uint32_t ring_most(const pni_edge_list *list) {
  const uint64_t turns_max = (uint64_t)1 << 32;
  for (uint32_t most = 65535;; most /= 2) {
    uint64_t turns = 0;
    for (size_t v = 0; v < list->vertices; v++) {
      uint64_t count = list->rings[v].count;
      turns += count * (count < most ? count : most);
    }
    if (turns <= turns_max || most < 128) return most;
  }
}

static pn_result build_list(pni_gpu *gpu, side *sides, size_t count, size_t vertices, pni_edge_list *out) {
  out->vertices = vertices;
  out->edges = pni_reallocate(gpu, NULL, (count + 1) * sizeof *out->edges);
  out->entries = pni_reallocate(gpu, NULL, (2 * count + 1) * sizeof *out->entries);
  out->rings = pni_allocate_zero(gpu, vertices * sizeof *out->rings);
  if (!out->edges || !out->entries || !out->rings) return PN_ERROR_OUT_OF_MEMORY;
  add_edges(out, sides, count);
  add_rings(out);
  out->ring_most = ring_most(out);
  return PN_OK;
}

pn_result pni_edges_find(pni_gpu *gpu, const float *positions, size_t vertices, const uint32_t *indices,
                         size_t index_count, pni_edge_list *out) {
  memset(out, 0, sizeof *out);
  uint32_t *same = NULL;
  side *sides = NULL;
  pn_result result = join_vertices(gpu, positions, vertices, &same);
  if (result == PN_OK) sides = pni_reallocate(gpu, NULL, (index_count + 1) * sizeof *sides);
  if (!sides) result = PN_ERROR_OUT_OF_MEMORY;
  size_t count = 0;
  if (result == PN_OK) count = collect_sides(same, vertices, indices, index_count, sides, &out->dropped);
  if (result == PN_OK && count) result = sort_sides(gpu, &sides, count, vertices);
  if (result == PN_OK) result = build_list(gpu, sides, count, vertices, out);
  pni_free(gpu, same);
  pni_free(gpu, sides);
  if (result != PN_OK) pni_edges_free(gpu, out);
  return result;
}

void pni_edges_free(pni_gpu *gpu, pni_edge_list *list) {
  pni_free(gpu, list->edges);
  pni_free(gpu, list->rings);
  pni_free(gpu, list->entries);
  memset(list, 0, sizeof *list);
}
