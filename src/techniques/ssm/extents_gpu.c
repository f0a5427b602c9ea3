/* Penumbra extents without reading anything back (Soft Shadow Maps, section 4.3): micropatches are counted in a
 * pyramid, listed from the counts, and drawn as many as there are. */
#include "techniques/ssm/ssm.h"

/* ---- shapes ------------------------------------------------------------------------------------------------------ */

static size_t least(size_t a, size_t b) { return a < b ? a : b; }

int pni_ssm_list_most(const pni_maps *maps) {
  size_t texels = (size_t)maps->depth.width * (size_t)maps->depth.height;
  return (int)(texels + texels / 3 + 1); /* every node of the pyramid */
}

int pni_ssm_list_size(const pni_maps *maps) { return (int)least((size_t)pni_ssm_list_most(maps), PNI_SSM_LIST_MOST); }

pn_result pni_ssm_gpu_shape(const pni_job *job) {
  pni_ssm_state *state = job->pair_state;
  pni_gpu *gpu = job->gpu;
  const pni_texture *range = &job->maps->range;
  int size = pni_ssm_list_size(job->maps), width = (int)least((size_t)size, PNI_SSM_LIST_WIDTH);
  int height = (size + width - 1) / width;
  pn_result result = pni_texture_shape(gpu, &state->counts, "micropatch counts", PNI_R32UI, range->width, range->height,
                                       0, range->levels);
  if (result == PN_OK) result = pni_texture_shape(gpu, &state->list, "micropatches", PNI_RGBA32F, width, height, 0, 1);
  if (result == PN_OK)
    result = pni_texture_shape(gpu, &state->limits, "micropatch limits", PNI_RGBA32F, width, height, 0, 1);
  if (result != PN_OK) return result;
  return pni_texture_shape(gpu, &state->totals, "micropatch totals", PNI_RGBA32UI, PNI_SSM_DRAWS, 1, 0, 1);
}

/* ---- passes ------------------------------------------------------------------------------------------------------ */

/* Several maps for a light: a node belongs to one of them. */
static bool has_tiles(const pni_ssm_list *list) { return list->job->maps->block.map_count > 1; }

/* What node.glsl reads. */
static void set_nodes(const pni_ssm_list *list, int level) {
  const pni_job *job = list->job;
  pni_gpu *gpu = job->gpu;
  const pni_seen *seen = &list->state->seen;
  int layer = list->map * pni_want_layers(&job->maps->want) + list->layer;
  pni_set_ints(gpu, "pn_source", layer, level, list->seen_layer, list->map);
  pni_set_ints(gpu, "pn_levels", job->maps->range.levels, seen->range.levels, seen->want.width, seen->want.height);
  pni_set_floats(gpu, "pn_share", (const float[4]){(float)list->share, list->pairs});
  pni_set_texture(gpu, "pn_range", &job->maps->range);
  pni_seen_set(gpu, seen);
}

static int shifted(int size, int level) { return size >> level > 1 ? size >> level : 1; }

/* Of the counts a pass reads the level below: never the one it draws. */
static pn_result count_level(const pni_ssm_list *list, int level) {
  static const char *const defines[2][2] = {{"PN_FIRST 1\nPN_TILES 0\n", "PN_FIRST 1\nPN_TILES 1\n"},
                                            {"PN_FIRST 0\nPN_TILES 0\n", "PN_FIRST 0\nPN_TILES 1\n"}};
  pni_gpu *gpu = list->job->gpu;
  const pni_texture *counts = &list->state->counts;
  pni_pass pass = {
      .name = "micropatch counts",
      .program = {.fragment = "techniques/ssm/nodes.frag.glsl", .defines = defines[level > 0][has_tiles(list)]},
      .color = {pni_image_of(counts, level, 0)},
      .clear_integer = true,
      .width = shifted(counts->width, level),
      .height = shifted(counts->height, level)};
  if (level) pni_texture_limit(gpu, counts, level - 1, level - 1);
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  set_nodes(list, level);
  if (level) pni_set_texture(gpu, "pn_counted", counts);
  pni_draw_screen(gpu);
  return PN_OK;
}

pn_result pni_ssm_gpu_count(const pni_ssm_list *list) {
  const pni_texture *counts = &list->state->counts;
  pn_result result = PN_OK;
  for (int level = 0; level < counts->levels && result == PN_OK; level++) result = count_level(list, level);
  pni_texture_limit(list->job->gpu, counts, 0, counts->levels - 1);
  return result;
}

static pn_result draw_list(const pni_ssm_list *list) {
  pni_gpu *gpu = list->job->gpu;
  const pni_ssm_state *state = list->state;
  const pni_texture *entries = &state->list;
  pni_pass pass = {.name = "micropatches",
                   .program = {"techniques/ssm/list.vert.glsl", "techniques/ssm/list.frag.glsl", NULL,
                               has_tiles(list) ? "PN_TILES 1\n" : "PN_TILES 0\n"},
                   .color = {pni_image_of(entries, 0, 0), pni_image_of(&state->limits, 0, 0)},
                   .width = entries->width,
                   .height = entries->height};
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  pni_set_ints(gpu, "pn_place", list->first, entries->width, entries->height, 0);
  set_nodes(list, 0);
  pni_set_texture(gpu, "pn_counted", &state->counts);
  pni_draw_counted(gpu, &state->arguments, PNI_SSM_DRAW_ROWS, 6 * entries->height);
  return PN_OK;
}

static pn_result draw_arguments(const pni_ssm_list *list) {
  pni_gpu *gpu = list->job->gpu;
  pni_ssm_state *state = list->state;
  pni_pass pass = {.name = "micropatch totals",
                   .program = {.fragment = "techniques/ssm/arguments.frag.glsl"},
                   .color = {pni_image_of(&state->totals, 0, 0)},
                   .width = PNI_SSM_DRAWS,
                   .height = 1};
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  int most = pni_ssm_list_size(list->job->maps);
  pni_set_ints(gpu, "pn_place", list->first, most, state->counts.levels - 1, state->list.width);
  pni_set_texture(gpu, "pn_counted", &state->counts);
  pni_draw_screen(gpu);
  return pni_counts_take(gpu, &state->totals, &state->arguments);
}

pn_result pni_ssm_gpu_list(const pni_ssm_list *list) {
  pn_result result = draw_arguments(list);
  return result == PN_OK ? draw_list(list) : result;
}

int pni_ssm_gpu_total(const pni_ssm_list *list) {
  const pni_texture *counts = &list->state->counts;
  uint32_t top[4] = {1}; /* while the call is planned nothing is read */
  pni_texture_read(list->job->gpu, counts, counts->levels - 1, 0, 1, 1, 4, top);
  return (int)(top[0] & 0x7fffffffu); /* the highest bit: whether the top node is one itself */
}
