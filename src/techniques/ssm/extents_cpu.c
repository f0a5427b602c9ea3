/* Penumbra extents on the CPU, as in the paper (Soft Shadow Maps, section 4.1): occluder and receiver map are read
 * back, and a loop goes over the micropatches. The same list as the GPU makes, in the same order: the functions are
 * those of node.glsl and patches.glsl, under the same names. */
#include <math.h>
#include <string.h>

#include "gl/host.h"
#include "techniques/ssm/ssm.h"

/* A pyramid of (largest, smallest) w, level after level. */
enum { LEVELS_MAX = 16 };
typedef struct {
  int width, height, levels;
  float *level[LEVELS_MAX];
  float *memory;
} pyramid;

static int shifted(int size, int level) { return size >> level > 1 ? size >> level : 1; }

static pn_result read_pyramid(pni_gpu *gpu, const pni_texture *texture, int layer, pyramid *out) {
  size_t texels = 0;
  *out = (pyramid){texture->width, texture->height, texture->levels, {0}, NULL};
  for (int i = 0; i < texture->levels; i++)
    texels += (size_t)shifted(texture->width, i) * (size_t)shifted(texture->height, i);
  out->memory = pni_reallocate(gpu, NULL, 2 * texels * sizeof(float));
  if (!out->memory) return PN_ERROR_OUT_OF_MEMORY;
  float *next = out->memory;
  for (int i = 0; i < texture->levels; i++) {
    int width = shifted(texture->width, i), height = shifted(texture->height, i);
    pni_texture_read(gpu, texture, i, layer, width, height, 2, next);
    out->level[i] = next;
    next += 2 * (size_t)width * (size_t)height;
  }
  return PN_OK;
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
  int count, capacity;
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

static pn_result add_entry(walk *w, const float entry[8]) {
  if (w->count == w->capacity) {
    int capacity = w->capacity ? 2 * w->capacity : 4096;
    float *grown = pni_reallocate(w->list->job->gpu, w->entries, (size_t)capacity * 8 * sizeof(float));
    if (!grown) return PN_ERROR_OUT_OF_MEMORY;
    w->entries = grown;
    w->capacity = capacity;
  }
  memcpy(w->entries + 8 * (size_t)w->count++, entry, 8 * sizeof(float));
  return PN_OK;
}

/* Adds the node where it is a micropatch that some receiver needs: pn_node. */
static pn_result add_node(walk *w, int x, int y, int level) {
  const float *range = pyramid_at(&w->occluders, x, y, level), *extent = w->block->extent;
  float middle = 0.5f * (range[0] + range[1]), most = node_limit(w, x, y, level);
  if (pni_is_nothing(most)) return PN_OK;
  float above = node_limit(w, x >> 1, y >> 1, level + 1), size = (float)(1 << level), low[2], high[2];
  map_st(w, (float)x * size, (float)y * size, low);
  map_st(w, ((float)x + 1) * size, ((float)y + 1) * size, high);
  float seen[2] = {most, fmaxf(pyramid_at(&w->receivers, 0, 0, w->receivers.levels - 1)[1], above)};
  for (int i = 0; i < 2; i++) {
    float from[2], to[2];
    for (int c = 0; c < 2; c++) {
      float reach = extent[c] * fmaxf(middle - seen[1], 0);
      from[c] = low[c] - reach;
      to[c] = high[c] + reach;
    }
    seen_between(w, from, to, seen);
    if (!(seen[1] <= most && seen[0] > above)) return PN_OK;
    seen[1] = fmaxf(seen[1], above);
  }
  const float entry[8] = {(float)x * size, (float)y * size, size, middle, most, above, seen[1], 1};
  return add_entry(w, entry);
}

static pn_result visit(walk *w, int x, int y, int level) {
  const pyramid *p = &w->occluders;
  if (x >= shifted(p->width, level) || y >= shifted(p->height, level)) return PN_OK;
  if (pni_is_nothing(pyramid_at(p, x, y, level)[0])) return PN_OK; /* empty all the way down */
  pn_result result = add_node(w, x, y, level);
  for (int i = 0; i < 4 && level > 0 && result == PN_OK; i++)
    result = visit(w, 2 * x + (i & 1), 2 * y + (i >> 1), level - 1);
  return result;
}

pn_result pni_ssm_cpu_list(const pni_ssm_list *list, float **entries, int *count) {
  const pni_job *job = list->job;
  const pni_seen *seen = &list->state->seen;
  const pni_seen_want *want = &seen->want;
  int layer = list->map * pni_want_layers(&job->maps->want) + list->layer;
  const double *b = want->bounds;
  walk w = {.list = list,
            .block = &job->maps->block,
            .share = (float)list->share,
            .seen_bounds = {(float)b[0], (float)b[1], (float)(want->width / (b[2] - b[0])),
                            (float)(want->height / (b[3] - b[1]))},
            .seen_size = {want->width, want->height}};
  pn_result result = read_pyramid(job->gpu, &job->maps->range, layer, &w.occluders);
  if (result == PN_OK) result = read_pyramid(job->gpu, &seen->range, list->seen_layer, &w.receivers);
  if (result == PN_OK) result = visit(&w, 0, 0, w.occluders.levels - 1);
  pni_free(job->gpu, w.occluders.memory);
  pni_free(job->gpu, w.receivers.memory);
  if (result != PN_OK) pni_free(job->gpu, w.entries);
  *entries = result == PN_OK ? w.entries : NULL;
  *count = result == PN_OK ? w.count : 0;
  return result;
}

pn_result pni_ssm_cpu_upload(const pni_ssm_list *list, const float *entries, int count) {
  const pni_job *job = list->job;
  pni_gpu *gpu = job->gpu;
  const pni_texture *to[2] = {&list->state->list, &list->state->limits};
  int left = count - list->first, most = pni_ssm_list_size(job->maps), width = to[0]->width;
  int rows = ((left < most ? left : most) + width - 1) / width;
  float *part = pni_allocate_zero(gpu, (size_t)rows * (size_t)width * 4 * sizeof(float));
  if (!part) return PN_ERROR_OUT_OF_MEMORY;
  for (int half = 0; half < 2; half++) {
    memset(part, 0, (size_t)rows * (size_t)width * 4 * sizeof(float));
    for (int i = 0; i < left && i < most; i++)
      memcpy(part + 4 * (size_t)i, entries + 8 * (size_t)(list->first + i) + 4 * half, 4 * sizeof(float));
    pni_texture_write(gpu, to[half], part, (size_t)rows * (size_t)width);
  }
  pni_free(gpu, part);
  return PN_OK;
}
