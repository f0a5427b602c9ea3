/* Accumulation (Soft Shadow Maps, sections 3.4 and 4.1, appendix A): micropatches drawn and summed up, layer by layer of
 * the soft shadow map. */
#include <math.h>

#include "techniques/ssm/ssm.h"

static pn_result patch_program(pni_gpu *gpu, ssm_sum_kind kind, const pni_program **out) {
  static const char *const defines[] = {"PN_SUM 0\n", "PN_SUM 1\n", "PN_SUM 2\n"};
  pni_program_key key = {"techniques/ssm/patch.vert.glsl", "techniques/ssm/patch.frag.glsl", NULL, defines[kind]};
  return pni_program_get(gpu, &key, out);
}

static pn_result add_program(pni_gpu *gpu, const pni_program **out) {
  pni_program_key key = {"shaders/screen.vert.glsl", "techniques/ssm/add.frag.glsl", NULL, ""};
  return pni_program_get(gpu, &key, out);
}

pn_result ssm_scatter_prepare(pni_gpu *gpu) {
  const pni_program *program;
  pn_result result = patch_program(gpu, SSM_SUM_SHADOW, &program);
  return result == PN_OK ? add_program(gpu, &program) : result;
}

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

static pn_result begin_target(const ssm_scattering *s, pni_attachment target, pni_blend blend, bool clear) {
  pni_pass pass = {.color = {target}, .width = s->soft->width, .height = s->soft->height, .blend = blend};
  pn_result result = pni_pass_begin(s->r->gpu, &pass);
  static const GLfloat zero[4] = {0, 0, 0, 0};
  if (result == PN_OK && clear) GL(s->r->gpu, ClearBufferfv)(GL_COLOR, 0, zero);
  return result;
}

/* Everything set for drawing entries of the list that lies in the work textures. */
static pn_result begin_patches(const ssm_scattering *s, const ssm_list *list, pni_attachment target, bool clear,
                               int first, int step) {
  pni_gpu *gpu = s->r->gpu;
  const pni_texture *work = s->r->pair->work;
  const pni_program *program;
  pn_result result = patch_program(gpu, s->kind, &program);
  if (result == PN_OK) result = begin_target(s, target, PNI_BLEND_ADD, clear);
  if (result != PN_OK) return result;
  GL(gpu, UseProgram)(program->id);
  GLint order[4] = {first, step, 0, 0};
  GLint place[4] = {work[SSM_LIST].width, list->map, s->soft->width, s->soft->height};
  GLint layer[4] = {list->seen_layer, list->map * s->r->maps->layers + list->layer, 0, 0};
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_order"), 1, order);
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_place"), 1, place);
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_layer"), 1, layer);
  pni_receiver_map_bind(gpu, &s->r->pair->seen, program);
  pni_bind_texture(gpu, PNI_UNIT_RANGE, s->r->maps->range.target, s->r->maps->range.id, true);
  pni_bind_texture(gpu, PNI_UNIT_WORK, work[SSM_LIST].target, work[SSM_LIST].id, false);
  pni_bind_texture(gpu, PNI_UNIT_ALPHA, work[SSM_LIMITS].target, work[SSM_LIMITS].id, false);
  return PN_OK;
}

/* Entries first, first + step, ... of the list. */
typedef struct {
  int first, step, count;
} entry_range;

static pn_result draw_entries(const ssm_scattering *s, const ssm_list *list, pni_attachment target, bool clear,
                              entry_range range) {
  pn_result result = begin_patches(s, list, target, clear, range.first, range.step);
  if (result != PN_OK) return result;
  GL(s->r->gpu, BindVertexArray)(s->r->gpu->vertex_array);
  GL(s->r->gpu, DrawArrays)(GL_TRIANGLES, 0, 6 * range.count);
  return PN_OK;
}

/* The batch and the sum so far, into the other of two images: nothing is blended. */
static pn_result add_batch(ssm_scattering *s) {
  pni_gpu *gpu = s->r->gpu;
  const pni_texture *work = s->r->pair->work, *batch = &work[SSM_BATCH];
  const pni_texture *from = &work[SSM_SUM + s->sum], *to = &work[SSM_SUM + !s->sum];
  const pni_program *program;
  pn_result result = add_program(gpu, &program);
  if (result == PN_OK) result = begin_target(s, (pni_attachment){to->id, to->target, 0, 0}, PNI_BLEND_NONE, false);
  if (result != PN_OK) return result;
  GL(gpu, UseProgram)(program->id);
  pni_bind_texture(gpu, PNI_UNIT_WORK, from->target, from->id, false);
  pni_bind_texture(gpu, PNI_UNIT_ALPHA, batch->target, batch->id, false);
  pni_draw_screen(gpu);
  s->sum = !s->sum;
  return PN_OK;
}

/* Appendix A's way round 16 bits: about sqrt(M) micropatches are summed up aside before they meet the rest. Neighbours
 * in the list cover the same texels, so a batch takes every sqrt(M)-th: what meets in a texel of it is few. */
static pn_result draw_batches(ssm_scattering *s, const ssm_list *list, int total, int count) {
  const pni_texture *batch = &s->r->pair->work[SSM_BATCH];
  pni_attachment aside = {batch->id, batch->target, 0, 0};
  int step = (int)ceil(sqrt(total));
  pn_result result = PN_OK;
  for (int first = 0; first < step && first < count && result == PN_OK; first++) {
    entry_range range = {first, step, (count - first + step - 1) / step};
    result = draw_entries(s, list, aside, true, range);
    if (result == PN_OK) result = add_batch(s);
  }
  return result;
}

/* What lies in the list's textures: total micropatches in all lists, or -1 where only the GPU knows. */
static pn_result draw_list(ssm_scattering *s, const ssm_list *list, int total) {
  const pni_visibility_request *r = s->r;
  int size = ssm_list_size(r->maps), left = total - list->first;
  if (total >= 0 && s->by_batches) return draw_batches(s, list, total, left < size ? left : size);
  if (total >= 0) return draw_entries(s, list, s->target, false, (entry_range){0, 1, left < size ? left : size});
  pn_result result = begin_patches(s, list, s->target, false, 0, 1);
  if (result == PN_OK) pni_draw_counted(r->gpu, &r->pair->arguments, SSM_DRAW_PATCHES, 6 * size);
  return result;
}

void ssm_mark(const ssm_scattering *s, const char *stage) {
  pni_clock_mark(s->r->gpu, &s->r->pair->clock, s->kind ? "debug" : stage);
}

static pn_result scatter_gpu(ssm_scattering *s, ssm_list *list) {
  int total = -1, most = ssm_list_most(s->r->maps);
  pn_result result = ssm_gpu_count(list);
  if (result == PN_OK && s->by_batches) result = ssm_gpu_total(list, &total);
  if (total >= 0) most = total;
  for (; list->first < most && result == PN_OK; list->first += ssm_list_size(s->r->maps)) {
    result = ssm_gpu_list(list);
    ssm_mark(s, "extents");
    if (result == PN_OK) result = draw_list(s, list, total);
    ssm_mark(s, "accumulate");
  }
  return result;
}

static pn_result scatter_cpu(ssm_scattering *s, ssm_list *list) {
  float *entries;
  int total;
  pn_result result = ssm_cpu_list(list, &entries, &total);
  for (; list->first < total && result == PN_OK; list->first += ssm_list_size(s->r->maps)) {
    result = ssm_cpu_upload(list, entries, total);
    ssm_mark(s, "extents");
    if (result == PN_OK) result = draw_list(s, list, total);
    ssm_mark(s, "accumulate");
  }
  pni_free(s->r->gpu, entries);
  return result;
}

static pn_result begin_sum(ssm_scattering *s) {
  const pni_texture *sum = &s->r->pair->work[SSM_SUM];
  s->sum = 0;
  pni_attachment target = s->by_batches ? (pni_attachment){sum->id, sum->target, 0, 0} : s->target;
  return begin_target(s, target, PNI_BLEND_NONE, true);
}

/* One side's shadow on one layer of receivers. */
static pn_result scatter(ssm_scattering *s, int side, int seen_layer) {
  const pni_maps *maps = s->r->maps;
  s->target = (pni_attachment){s->soft->id, s->soft->target, 0, side * s->r->pair->seen.want.layers + seen_layer};
  pn_result result = begin_sum(s);
  for (int map = 0; map < maps->fit.tiles && result == PN_OK; map++) {
    ssm_list list = {.request = s->r, .map = map, .layer = side, .seen_layer = seen_layer, .share = s->share};
    result = s->on_cpu ? scatter_cpu(s, &list) : scatter_gpu(s, &list);
  }
  if (result == PN_OK && s->by_batches)
    pni_copy_to_layer(s->r->gpu, &s->r->pair->work[SSM_SUM + s->sum], s->soft, s->target.layer);
  return result;
}

pn_result ssm_scatter(ssm_scattering *s) {
  pn_result result = PN_OK;
  for (int side = 0; side < s->r->maps->layers; side++)
    for (int layer = 0; layer < s->r->pair->seen.want.layers && result == PN_OK; layer++)
      result = scatter(s, side, layer);
  return result;
}
