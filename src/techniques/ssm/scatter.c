/* Accumulation (Soft Shadow Maps, sections 3.4 and 4.1): micropatches drawn and summed up, layer by layer of the soft
 * shadow map. */
#include <math.h>

#include "gl/host.h"
#include "techniques/ssm/ssm.h"

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

static const float zero[4] = {0, 0, 0, 0};

static pni_pass sum_pass(const pni_ssm_scattering *s, const char *name, pni_image target) {
  return (pni_pass){.name = name, .color = {target}, .width = s->soft->width, .height = s->soft->height};
}

static pni_image soft_layer(const pni_ssm_scattering *s) { return pni_image_of(s->soft, 0, s->target); }

static pn_result clear_sum(const pni_ssm_scattering *s, pni_image target) {
  pni_pass pass = sum_pass(s, "soft shadow map, cleared", target);
  pass.clear = zero;
  return pni_pass_begin(s->job->gpu, &pass);
}

/* Everything set for drawing entries first, first + step, ... of the list that lies in the textures. */
static pn_result begin_patches(const pni_ssm_scattering *s, const pni_ssm_list *list, pni_pass *pass, int first,
                               int step) {
  static const char *const defines[] = {"PN_SUM 0\n", "PN_SUM 1\n", "PN_SUM 2\n"};
  pni_gpu *gpu = s->job->gpu;
  const pni_ssm_state *state = s->state;
  pass->program =
      (pni_program_key){"techniques/ssm/patch.vert.glsl", "techniques/ssm/patch.frag.glsl", NULL, defines[s->kind]};
  pass->blend = PNI_BLEND_ADD;
  pn_result result = pni_pass_begin(gpu, pass);
  if (result != PN_OK) return result;
  int layer = list->map * pni_want_layers(&s->job->maps->want) + list->layer;
  pni_set_ints(gpu, "pn_order", first, step, 0, 0);
  pni_set_ints(gpu, "pn_place", state->list.width, list->map, s->soft->width, s->soft->height);
  pni_set_ints(gpu, "pn_layer", list->seen_layer, layer, 0, 0);
  pni_seen_set(gpu, &state->seen);
  pni_set_texture(gpu, "pn_range", &s->job->maps->range);
  pni_set_texture(gpu, "pn_list", &state->list);
  pni_set_texture(gpu, "pn_limits", &state->limits);
  return PN_OK;
}

/* The batch and the sum so far, into the other of two images: nothing is blended. */
static pn_result add_batch(pni_ssm_scattering *s) {
  pni_gpu *gpu = s->job->gpu;
  pni_pass pass = sum_pass(s, "sum of batches", pni_image_of(&s->state->sums[!s->sum], 0, 0));
  pass.program.fragment = "techniques/ssm/add.frag.glsl";
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  pni_set_texture(gpu, "pn_sum", &s->state->sums[s->sum]);
  pni_set_texture(gpu, "pn_batch", &s->state->batch);
  pni_draw_screen(gpu);
  s->sum = !s->sum;
  return PN_OK;
}

/* About sqrt(M) micropatches are summed up aside before they meet the rest, so that small numbers meet small ones.
 * Neighbours in the list cover the same texels; so of a batch that takes every sqrt(M)-th few meet in a texel, and of a
 * consecutive one nearly all. */
static pn_result draw_batches(pni_ssm_scattering *s, const pni_ssm_list *list, int total, int count) {
  int root = (int)ceil(sqrt(total)), step = s->consecutive ? 1 : root, stride = s->consecutive ? root : 1;
  int batches = s->consecutive ? (count + root - 1) / root : root;
  pn_result result = PN_OK;
  for (int i = 0; i < batches && i * stride < count && result == PN_OK; i++) {
    int first = i * stride, entries = (count - first + step - 1) / step;
    pni_pass pass = sum_pass(s, "batch of micropatches", pni_image_of(&s->state->batch, 0, 0));
    pass.clear = zero;
    result = begin_patches(s, list, &pass, first, step);
    if (result != PN_OK) return result;
    pni_draw_triangles(s->job->gpu, 6 * (entries < root ? entries : root));
    result = add_batch(s);
  }
  return result;
}

/* What lies in the list's textures: total micropatches in all lists, or -1 where only the GPU knows. */
static pn_result draw_list(pni_ssm_scattering *s, const pni_ssm_list *list, int total) {
  pni_gpu *gpu = s->job->gpu;
  int size = pni_ssm_list_size(s->job->maps), left = total - list->first, count = left < size ? left : size;
  if (total >= 0 && s->by_batches) return draw_batches(s, list, total, count);
  pni_pass pass = sum_pass(s, "micropatches summed", soft_layer(s));
  pn_result result = begin_patches(s, list, &pass, 0, 1);
  if (result != PN_OK) return result;
  if (total >= 0) pni_draw_triangles(gpu, 6 * count);
  else pni_draw_counted(gpu, &s->state->arguments, PNI_SSM_DRAW_PATCHES, 6 * size);
  return PN_OK;
}

void pni_ssm_mark(const pni_ssm_scattering *s, const char *stage) { pni_job_mark(s->job, s->kind ? "debug" : stage); }

static pn_result scatter_gpu(pni_ssm_scattering *s, pni_ssm_list *list) {
  const pni_maps *maps = s->job->maps;
  int total = -1, most = pni_ssm_list_most(maps);
  pn_result result = pni_ssm_gpu_count(list);
  if (result == PN_OK && s->by_batches) total = pni_ssm_gpu_total(list);
  if (total >= 0) most = total;
  for (; list->first < most && result == PN_OK; list->first += pni_ssm_list_size(maps)) {
    result = pni_ssm_gpu_list(list);
    pni_ssm_mark(s, "extents");
    if (result == PN_OK) result = draw_list(s, list, total);
    pni_ssm_mark(s, "accumulate");
  }
  return result;
}

static pn_result scatter_cpu(pni_ssm_scattering *s, pni_ssm_list *list) {
  int total = 1;
  pn_result result = PN_OK;
  for (; list->first < total && result == PN_OK; list->first += pni_ssm_list_size(s->job->maps)) {
    result = pni_ssm_cpu_list(list, &total);
    pni_ssm_mark(s, "extents");
    if (result == PN_OK && list->first < total) result = draw_list(s, list, total);
    pni_ssm_mark(s, "accumulate");
  }
  return result;
}

/* One side's shadow on one layer of receivers. */
static pn_result scatter(pni_ssm_scattering *s, int side, int seen_layer) {
  const pni_maps *maps = s->job->maps;
  s->target = side * s->state->seen.want.layers + seen_layer;
  s->sum = 0;
  pn_result result = clear_sum(s, s->by_batches ? pni_image_of(&s->state->sums[0], 0, 0) : soft_layer(s));
  for (int map = 0; map < (int)maps->block.map_count && result == PN_OK; map++) {
    pni_ssm_list list = {.job = s->job,
                         .state = s->state,
                         .map = map,
                         .layer = side,
                         .seen_layer = seen_layer,
                         .share = s->share,
                         .pairs = s->kind == PNI_SSM_SUM_BOUND};
    result = s->on_cpu ? scatter_cpu(s, &list) : scatter_gpu(s, &list);
  }
  if (result == PN_OK && s->by_batches) pni_copy_to_layer(s->job->gpu, &s->state->sums[s->sum], s->soft, s->target);
  return result;
}

pn_result pni_ssm_scatter(pni_ssm_scattering *s) {
  int sides = pni_want_layers(&s->job->maps->want);
  pn_result result = PN_OK;
  for (int side = 0; side < sides; side++)
    for (int layer = 0; layer < s->state->seen.want.layers && result == PN_OK; layer++)
      result = scatter(s, side, layer);
  return result;
}
