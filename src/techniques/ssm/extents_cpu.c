/* Penumbra extents on the CPU (Soft Shadow Maps, section 4.1): the occluder map is read back, and a loop goes over the
 * micropatches. Unlike in the paper the receiver map is read back too, since extents reach what is seen. The same list
 * as the GPU makes, in the same order: the functions are those of node.glsl and patches.glsl, under the same names. */
#include <math.h>
#include <string.h>

#include "gl/host.h"
#include "techniques/ssm/ssm.h"

/* A pyramid of (largest, smallest) w, level after level. */
enum { LEVELS_MAX = 16 };
typedef struct {
  int width, height, levels;
  float *level[LEVELS_MAX];
} pyramid;

static int shifted(int size, int level) { return size >> level > 1 ? size >> level : 1; }

/* Numbers that it has. */
static size_t pyramid_floats(const pni_texture *texture) {
  size_t texels = 0;
  for (int i = 0; i < texture->levels; i++)
    texels += (size_t)shifted(texture->width, i) * (size_t)shifted(texture->height, i);
  return 2 * texels;
}

static void read_pyramid(pni_gpu *gpu, const pni_texture *texture, int layer, float *memory, pyramid *out) {
  *out = (pyramid){texture->width, texture->height, texture->levels, {0}};
  float *next = memory;
  for (int i = 0; i < texture->levels; i++) {
    int width = shifted(texture->width, i), height = shifted(texture->height, i);
    pni_texture_read(gpu, texture, i, layer, width, height, 2, next);
    out->level[i] = next;
    next += 2 * (size_t)width * (size_t)height;
  }
}

static const float *pyramid_at(const pyramid *p, int x, int y, int level) {
  return p->level[level] + 2 * ((size_t)y * (size_t)shifted(p->width, level) + (size_t)x);
}

/* ---- the walk ---------------------------------------------------------------------------------------------------- */

typedef struct {
  const pni_ssm_list *list;
  const pni_light_block *block;
  pyramid occluders, receivers;
  float seen_bounds[4], share;
  int seen_size[2];
  float *entries;
  int count; /* in all; those from list->first on are kept, as many as a list has */
} walk;

static float clampf(float x, float low, float high) { return fminf(fmaxf(x, low), high); }

static const pni_map_block *map_of(const walk *w) { return &w->block->maps[w->list->map]; }

static void map_st(const walk *w, float x, float y, float st[2]) {
  const pni_map_block *map = map_of(w);
  st[0] = map->origin[0] + x / map->density[0];
  st[1] = map->origin[1] + y / map->density[1];
}

/* The map whose middle is nearest, as pn_map_at. */
static int map_at(const walk *w, const float st[2]) {
  int best = 0;
  float best_distance = PNI_EVERYTHING;
  for (int index = 0; index < (int)w->block->map_count; index++) {
    const pni_map_block *map = &w->block->maps[index];
    float distance = -0.5f;
    for (int i = 0; i < 2; i++) {
      float texel = (st[i] - map->origin[i]) * map->density[i];
      distance = fmaxf(distance, fabsf(texel - 0.5f * map->size[i]) / map->size[i] - 0.5f);
    }
    if (distance < best_distance) {
      best_distance = distance;
      best = index;
    }
  }
  return best;
}

static bool node_owned(const walk *w, const float texels[4]) {
  if ((int)w->block->map_count == 1) return true;
  float low[2], high[2];
  map_st(w, texels[0] + 0.5f, texels[1] + 0.5f, low);
  map_st(w, texels[2] - 0.5f, texels[3] - 0.5f, high);
  return map_at(w, low) == w->list->map && map_at(w, high) == w->list->map;
}

static float patch_limit(const float range[2], float share) {
  float depth = range[0] - range[1];
  return depth > 0 ? range[1] - depth / (4 * share) : range[1];
}

static float node_limit(const walk *w, int x, int y, int level) {
  if (level >= w->occluders.levels || (level > 0 && w->share <= 0)) return PNI_NOTHING;
  float size = (float)(1 << level);
  float texels[4] = {(float)x * size, (float)y * size, ((float)x + 1) * size, ((float)y + 1) * size};
  if (texels[2] > map_of(w)->size[0] || texels[3] > map_of(w)->size[1]) return PNI_NOTHING;
  const float *range = pyramid_at(&w->occluders, x, y, level);
  return !pni_is_nothing(range[1]) && node_owned(w, texels) ? patch_limit(range, w->share) : PNI_NOTHING;
}

static void seen_between(const walk *w, const float low[2], const float high[2], float out[2]) {
  int a[2], b[2], extent = 0, level = 0;
  for (int i = 0; i < 2; i++) {
    const float *bounds = w->seen_bounds;
    float most = (float)(w->seen_size[i] - 1);
    a[i] = (int)clampf(floorf((low[i] - bounds[i]) * bounds[2 + i]), 0, most);
    b[i] = (int)clampf(floorf((high[i] - bounds[i]) * bounds[2 + i]), 0, most);
    if (b[i] - a[i] > extent) extent = b[i] - a[i];
  }
  while (extent >> level > 0) level++;
  if (level > w->receivers.levels - 1) level = w->receivers.levels - 1;
  out[0] = PNI_NOTHING;
  out[1] = PNI_EVERYTHING;
  for (int i = 0; i < 4; i++) {
    const float *r = pyramid_at(&w->receivers, (i & 1 ? b[0] : a[0]) >> level, (i & 2 ? b[1] : a[1]) >> level, level);
    out[0] = fmaxf(out[0], r[0]);
    out[1] = fminf(out[1], r[1]);
  }
}

static void add_entry(walk *w, const float entry[8]) {
  int at = w->count++ - w->list->first;
  if (at >= 0 && at < pni_ssm_list_size(w->list->job->maps))
    memcpy(w->entries + 8 * (size_t)at, entry, 8 * sizeof(float));
}

static float pairs_reach(const walk *w, int x, int y, float own) {
  const pyramid *p = &w->occluders;
  const float *right = pyramid_at(p, x + 1 < p->width ? x + 1 : x, y, 0);
  const float *upper = pyramid_at(p, x, y + 1 < p->height ? y + 1 : y, 0);
  return fmaxf(own, fmaxf(right[0], upper[0]));
}

/* Adds the node where it is a micropatch that some receiver needs: pn_node. */
static void add_node(walk *w, int x, int y, int level) {
  const float *range = pyramid_at(&w->occluders, x, y, level), *extent = w->block->extent;
  float middle = 0.5f * (range[0] + range[1]), most = node_limit(w, x, y, level);
  if (pni_is_nothing(most)) return;
  float above = node_limit(w, x >> 1, y >> 1, level + 1), size = (float)(1 << level), low[2], high[2];
  map_st(w, (float)x * size, (float)y * size, low);
  map_st(w, ((float)x + 1) * size, ((float)y + 1) * size, high);
  float farthest = w->list->pairs ? pairs_reach(w, x, y, middle) : middle;
  float seen[2] = {most, fmaxf(pyramid_at(&w->receivers, 0, 0, w->receivers.levels - 1)[1], above)};
  for (int i = 0; i < 2; i++) {
    float from[2], to[2];
    for (int c = 0; c < 2; c++) {
      float reach = extent[c] * fmaxf(farthest - seen[1], 0);
      from[c] = low[c] - reach;
      to[c] = high[c] + reach;
    }
    seen_between(w, from, to, seen);
    if (!(seen[1] <= most && seen[0] > above)) return;
    seen[1] = fmaxf(seen[1], above);
  }
  const float entry[8] = {(float)x * size, (float)y * size, size, middle, most, above, seen[1], 1};
  add_entry(w, entry);
}

static void visit(walk *w, int x, int y, int level) {
  const pyramid *p = &w->occluders;
  if (x >= shifted(p->width, level) || y >= shifted(p->height, level)) return;
  if (pni_is_nothing(pyramid_at(p, x, y, level)[0])) return; /* empty all the way down */
  add_node(w, x, y, level);
  for (int i = 0; i < 4 && level > 0; i++) visit(w, 2 * x + (i & 1), 2 * y + (i >> 1), level - 1);
}

/* ---- the list ---------------------------------------------------------------------------------------------------- */

/* What the walk works in: both pyramids, and a list. */
static size_t scratch_floats(const pni_ssm_list *list) {
  return pyramid_floats(&list->job->maps->range) + pyramid_floats(&list->state->seen.range) +
         8 * (size_t)pni_ssm_list_size(list->job->maps);
}

static pn_result take_scratch(const pni_ssm_list *list) {
  pni_ssm_state *state = list->state;
  size_t wanted = scratch_floats(list);
  if (state->scratch_floats >= wanted) return PN_OK;
  float *grown = pni_reallocate(list->job->gpu, state->scratch, wanted * sizeof *grown);
  if (!grown) return PN_ERROR_OUT_OF_MEMORY;
  state->scratch = grown;
  state->scratch_floats = wanted;
  return PN_OK;
}

/* Half of each entry goes to either texture. */
static void upload(const pni_ssm_list *list, const float *entries, int count) {
  const pni_texture *to[2] = {&list->state->list, &list->state->limits};
  int width = to[0]->width;
  float row[4 * PNI_SSM_LIST_WIDTH];
  for (int half = 0; half < 2; half++)
    for (int first = 0; first < count; first += width) {
      int some = count - first < width ? count - first : width;
      for (int i = 0; i < some; i++)
        memcpy(row + 4 * i, entries + 8 * (size_t)(first + i) + 4 * half, 4 * sizeof(float));
      pni_texture_write_row(list->job->gpu, to[half], first / width, row, some);
    }
}

pn_result pni_ssm_cpu_list(const pni_ssm_list *list, int *total) {
  const pni_job *job = list->job;
  const pni_seen *seen = &list->state->seen;
  const pni_seen_want *want = &seen->want;
  int layer = list->map * pni_want_layers(&job->maps->want) + list->layer, size = pni_ssm_list_size(job->maps);
  const double *b = want->bounds;
  *total = 1;
  pn_result result = take_scratch(list);
  if (result != PN_OK || job->gpu->plan.on) return result;
  float *receivers = list->state->scratch + pyramid_floats(&job->maps->range);
  walk w = {.list = list,
            .block = &job->maps->block,
            .share = (float)list->share,
            .seen_bounds = {(float)b[0], (float)b[1], (float)(want->width / (b[2] - b[0])),
                            (float)(want->height / (b[3] - b[1]))},
            .seen_size = {want->width, want->height},
            .entries = receivers + pyramid_floats(&seen->range)};
  read_pyramid(job->gpu, &job->maps->range, layer, list->state->scratch, &w.occluders);
  read_pyramid(job->gpu, &seen->range, list->seen_layer, receivers, &w.receivers);
  visit(&w, 0, 0, w.occluders.levels - 1);
  *total = w.count;
  int left = w.count - list->first;
  upload(list, w.entries, left < size ? left : size);
  return PN_OK;
}
