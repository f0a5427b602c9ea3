/* Soft shadow maps (Atty et al. 2006): every texel of the occluder map scatters its shadow. */
#include "techniques/ssm/ssm.h"

#include <math.h>
#include <stdio.h>

enum { PRESET, SIDES, ACCUMULATE, EXTENTS, MERGE, SIZE, LAYERS, COUNT };
enum { SIDES_BOTH, SIDES_FRONT, SIDES_BACK };
enum { ACCUMULATE_FP32, ACCUMULATE_BATCHED, ACCUMULATE_FP16 };
enum { EXTENTS_GPU, EXTENTS_CPU };
enum { RECEIVER_LAYERS_MAX = 8 };

static const char *const presets[] = {"fast", "good", "exact", NULL};
static const char *const sides[] = {"both", "front", "back", NULL};
static const char *const accumulations[] = {"fp32", "fp16-batched", "fp16", NULL};
static const char *const extents[] = {"gpu", "cpu", NULL};

static const pn_parameter parameters[COUNT] = {
    [PRESET] = {"preset", "", "sets the others; what is named besides it goes over it", "docs/techniques/ssm.md",
                PN_CHOICE, 0, 2, 1, presets},
    [SIDES] = {"sides", "", "which surfaces cast: the nearest and the farthest, merged by maximum, or one of them",
               "Soft Shadow Maps, section 3.5", PN_CHOICE, 0, 2, SIDES_BOTH, sides},
    [ACCUMULATE] = {"accumulate", "",
                    "sums in 32-bit floats; in 16-bit floats by batches of sqrt(M) micropatches; in 16-bit floats",
                    "Soft Shadow Maps, appendix A", PN_CHOICE, 0, 2, ACCUMULATE_FP32, accumulations},
    [EXTENTS] = {"extents", "", "where penumbra extents are found; cpu reads the maps back, as the paper did",
                 "Soft Shadow Maps, sections 4.1 and 4.3", PN_CHOICE, 0, 1, EXTENTS_GPU, extents},
    [MERGE] =
        {"merge", "%",
         "blocks are one micropatch where that moves no edge by more than this part of the light; 0 = every texel",
         "Soft Shadow Maps, section 7", PN_FLOAT, 0, 50, 5, NULL},
    [SIZE] = {"size", "texels", "soft shadow map of N x N; 0 = as the occluder map", "Soft Shadow Maps, section 5.2.3",
              PN_INT, 0, PN_MAP_SIZE_MAX, 0, NULL},
    [LAYERS] = {"layers", "", "receivers told apart behind one another, as the light sees them",
                "Soft Shadow Maps, section 7", PN_INT, 1, RECEIVER_LAYERS_MAX, 4, NULL},
};

static void preset(int choice, double *values) {
  for (int i = 0; i < COUNT; i++) values[i] = parameters[i].initial;
  values[PRESET] = choice;
  if (choice == 0) { /* fast */
    values[MERGE] = 10;
    values[SIZE] = 256;
    values[LAYERS] = 3;
  }
  if (choice == 2) { /* exact */
    values[MERGE] = 1;
    values[LAYERS] = 6;
  }
}

static bool has_front(const double *values) { return values[SIDES] != SIDES_BACK; }
static bool has_back(const double *values) { return values[SIDES] != SIDES_FRONT; }

static void want(const double *values, pn_maps_want *out) {
  *out = (pn_maps_want){
      .near_layers = has_front(values), .farthest = has_back(values), .range = {.structure = PN_RANGE_PYRAMID}};
}

/* ---- programs ---------------------------------------------------------------------------------------------------- */

/* What is summed up: the shadow, the bound of its error, or how many micropatches there are. */
typedef enum { SUM_SHADOW, SUM_BOUND, SUM_COUNT } sum_kind;

static pn_result patch_program(pn_gpu *gpu, sum_kind kind, const pn_program **out) {
  static const char *const defines[] = {"PN_SUM 0\n", "PN_SUM 1\n", "PN_SUM 2\n"};
  pn_program_key key = {"techniques/ssm/patch.vert.glsl", "techniques/ssm/patch.frag.glsl", NULL, defines[kind]};
  return pn_program_get(gpu, &key, out);
}

static pn_result add_program(pn_gpu *gpu, const pn_program **out) {
  pn_program_key key = {"shaders/screen.vert.glsl", "techniques/ssm/add.frag.glsl", NULL, ""};
  return pn_program_get(gpu, &key, out);
}

static pn_result lookup_program(pn_gpu *gpu, const char *receiver_defines, bool bound, const pn_program **out) {
  char defines[PN_RECEIVER_DEFINES + 16];
  snprintf(defines, sizeof defines, "%sPN_BOUND %d\n", receiver_defines, bound);
  pn_program_key key = {"shaders/screen.vert.glsl", "techniques/ssm/lookup.frag.glsl", NULL, defines};
  return pn_program_get(gpu, &key, out);
}

static pn_result prepare(pn_gpu *gpu, const double *values) {
  static const char *const receivers[] = {"PN_NORMALS 0\nPN_MASK 0\n", "PN_NORMALS 1\nPN_MASK 0\n"};
  const pn_program *program;
  pn_result result = ssm_gpu_prepare(gpu);
  if (result == PN_OK) result = patch_program(gpu, SUM_SHADOW, &program);
  if (result == PN_OK) result = add_program(gpu, &program);
  for (int i = 0; i < 2 && result == PN_OK; i++) result = lookup_program(gpu, receivers[i], false, &program);
  return result == PN_OK ? pn_receiver_map_prepare(gpu, (int)values[LAYERS]) : result;
}

/* ---- where the soft shadow map lies ------------------------------------------------------------------------------ */

/* Casters grown by the penumbra, as far as receivers are seen there. False: nothing to shadow. */
static bool place_axis(const pn_visibility_request *r, const pn_region *seen, int i, double *low, double *high) {
  const pn_fit_result *fit = &r->maps->fit;
  double reach = pn_penumbra_extent(r->frame->extent[i], fit->w_near, seen->least[2]);
  *low = fmax(fit->bounds[i] - reach, seen->least[i]);
  *high = fmin(fit->bounds[i + 2] + reach, seen->most[i]);
  if (!(*low <= *high)) return false;
  double least = fmax(1e-6 * fmax(fabs(*low), fabs(*high)), 1e-9);
  if (*high - *low < least) {
    *low -= least;
    *high += least;
  }
  pn_fit_snap(low, high);
  return true;
}

static pn_result find_receivers(const pn_visibility_request *r, pn_region *seen) {
  if (r->visible) {
    *seen = *r->visible;
    return PN_OK;
  }
  *seen = pn_region_empty();
  return pn_receiver_bounds(r->receiver, r->frame, seen);
}

static bool place(const pn_visibility_request *r, const pn_region *seen, pn_receiver_map_want *out) {
  int size = (int)r->values[SIZE];
  *out = (pn_receiver_map_want){.width = size ? size : r->desc->map_width,
                                .height = size ? size : r->desc->map_height,
                                .layers = (int)r->values[LAYERS]};
  for (int i = 0; i < 2; i++)
    if (!place_axis(r, seen, i, &out->bounds[i], &out->bounds[i + 2])) return false;
  /* Receivers in a plane that faces the light have no extent in w; the depth test needs one that floats resolve. */
  double span = fmax(seen->most[2] - seen->least[2], 1e-3 * fabs(seen->most[2]) + 1e-12);
  out->w_least = seen->least[2] - 0.1 * span;
  out->w_most = seen->most[2] + 0.1 * span;
  return true;
}

/* ---- accumulation ------------------------------------------------------------------------------------------------ */

typedef struct {
  const pn_visibility_request *r;
  int accumulate;
  sum_kind kind;
  const pn_texture *soft;
  int sum;              /* by batches: which of two images holds it */
  pn_attachment target; /* the layer of it that is summed up */
} scattering;

static bool by_batches(const scattering *s) { return s->accumulate == ACCUMULATE_BATCHED && s->kind == SUM_SHADOW; }

static pn_result begin_target(const scattering *s, pn_attachment target, pn_blend blend, bool clear) {
  pn_pass pass = {.color = {target}, .width = s->soft->width, .height = s->soft->height, .blend = blend};
  pn_result result = pn_pass_begin(s->r->gpu, &pass);
  static const GLfloat zero[4] = {0, 0, 0, 0};
  if (result == PN_OK && clear) GL(s->r->gpu, ClearBufferfv)(GL_COLOR, 0, zero);
  return result;
}

/* Everything set for drawing entries of the list that lies in the work textures. */
static pn_result begin_patches(const scattering *s, const ssm_list *list, pn_attachment target, bool clear, int first,
                               int step) {
  pn_gpu *gpu = s->r->gpu;
  const pn_texture *work = s->r->pair->work;
  const pn_program *program;
  pn_result result = patch_program(gpu, s->kind, &program);
  if (result == PN_OK) result = begin_target(s, target, PN_BLEND_ADD, clear);
  if (result != PN_OK) return result;
  GL(gpu, UseProgram)(program->id);
  GLint order[4] = {first, step, 0, 0};
  GLint place[4] = {work[SSM_LIST].width, list->map, s->soft->width, s->soft->height};
  GLint layer[4] = {list->seen_layer, list->map * s->r->maps->layers + list->layer, 0, 0};
  GL(gpu, Uniform4iv)(pn_uniform(program, "pn_order"), 1, order);
  GL(gpu, Uniform4iv)(pn_uniform(program, "pn_place"), 1, place);
  GL(gpu, Uniform4iv)(pn_uniform(program, "pn_layer"), 1, layer);
  pn_receiver_map_bind(gpu, &s->r->pair->seen, program);
  pn_bind_texture(gpu, PN_UNIT_RANGE, s->r->maps->range.target, s->r->maps->range.id, true);
  pn_bind_texture(gpu, PN_UNIT_WORK, work[SSM_LIST].target, work[SSM_LIST].id, false);
  pn_bind_texture(gpu, PN_UNIT_ALPHA, work[SSM_LIMITS].target, work[SSM_LIMITS].id, false);
  return PN_OK;
}

/* Entries first, first + step, ... of the list. */
typedef struct {
  int first, step, count;
} entry_range;

static pn_result draw_entries(const scattering *s, const ssm_list *list, pn_attachment target, bool clear,
                              entry_range range) {
  pn_result result = begin_patches(s, list, target, clear, range.first, range.step);
  if (result != PN_OK) return result;
  GL(s->r->gpu, BindVertexArray)(s->r->gpu->vertex_array);
  GL(s->r->gpu, DrawArrays)(GL_TRIANGLES, 0, 6 * range.count);
  return PN_OK;
}

/* The batch and the sum so far, into the other of two images: nothing is blended. */
static pn_result add_batch(scattering *s) {
  pn_gpu *gpu = s->r->gpu;
  const pn_texture *work = s->r->pair->work, *batch = &work[SSM_BATCH];
  const pn_texture *from = &work[SSM_SUM + s->sum], *to = &work[SSM_SUM + !s->sum];
  const pn_program *program;
  pn_result result = add_program(gpu, &program);
  if (result == PN_OK) result = begin_target(s, (pn_attachment){to->id, to->target, 0, 0}, PN_BLEND_NONE, false);
  if (result != PN_OK) return result;
  GL(gpu, UseProgram)(program->id);
  pn_bind_texture(gpu, PN_UNIT_WORK, from->target, from->id, false);
  pn_bind_texture(gpu, PN_UNIT_ALPHA, batch->target, batch->id, false);
  pn_draw_screen(gpu);
  s->sum = !s->sum;
  return PN_OK;
}

/* Appendix A's way round 16 bits: about sqrt(M) micropatches are summed up aside before they meet the rest. Neighbours
 * in the list cover the same texels, so a batch takes every sqrt(M)-th: what meets in a texel of it is few. */
static pn_result draw_batches(scattering *s, const ssm_list *list, int total, int count) {
  const pn_texture *batch = &s->r->pair->work[SSM_BATCH];
  pn_attachment aside = {batch->id, batch->target, 0, 0};
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
static pn_result draw_list(scattering *s, const ssm_list *list, int total) {
  const pn_visibility_request *r = s->r;
  int size = ssm_list_size(r->maps), left = total - list->first;
  if (total >= 0 && by_batches(s)) return draw_batches(s, list, total, left < size ? left : size);
  if (total >= 0) return draw_entries(s, list, s->target, false, (entry_range){0, 1, left < size ? left : size});
  pn_result result = begin_patches(s, list, s->target, false, 0, 1);
  if (result == PN_OK) pn_draw_counted(r->gpu, &r->pair->arguments, SSM_DRAW_PATCHES, 6 * size);
  return result;
}

static void mark(const scattering *s, const char *stage) {
  pn_clock_mark(s->r->gpu, &s->r->pair->clock, s->kind ? "debug" : stage);
}

static pn_result scatter_gpu(scattering *s, ssm_list *list) {
  int total = -1, most = ssm_list_most(s->r->maps);
  pn_result result = ssm_gpu_count(list);
  if (result == PN_OK && by_batches(s)) result = ssm_gpu_total(list, &total);
  if (total >= 0) most = total;
  for (; list->first < most && result == PN_OK; list->first += ssm_list_size(s->r->maps)) {
    result = ssm_gpu_list(list);
    mark(s, "extents");
    if (result == PN_OK) result = draw_list(s, list, total);
    mark(s, "accumulate");
  }
  return result;
}

static pn_result scatter_cpu(scattering *s, ssm_list *list) {
  float *entries;
  int total;
  pn_result result = ssm_cpu_list(list, &entries, &total);
  for (; list->first < total && result == PN_OK; list->first += ssm_list_size(s->r->maps)) {
    result = ssm_cpu_upload(list, entries, total);
    mark(s, "extents");
    if (result == PN_OK) result = draw_list(s, list, total);
    mark(s, "accumulate");
  }
  pn_free(s->r->gpu, entries);
  return result;
}

static pn_result begin_sum(scattering *s) {
  const pn_texture *sum = &s->r->pair->work[SSM_SUM];
  s->sum = 0;
  pn_attachment target = by_batches(s) ? (pn_attachment){sum->id, sum->target, 0, 0} : s->target;
  return begin_target(s, target, PN_BLEND_NONE, true);
}

static void end_sum(const scattering *s) {
  pn_gpu *gpu = s->r->gpu;
  if (!by_batches(s)) return;
  pn_read_from(gpu, &s->r->pair->work[SSM_SUM + s->sum], 0, 0);
  GL(gpu, ActiveTexture)(GL_TEXTURE0 + PN_UNIT_WORK);
  GL(gpu, BindTexture)(s->soft->target, s->soft->id);
  GL(gpu, CopyTexSubImage3D)(s->soft->target, 0, 0, 0, s->target.layer, 0, 0, s->soft->width, s->soft->height);
}

/* One side's shadow on one layer of receivers. */
static pn_result scatter(scattering *s, int side, int seen_layer) {
  const pn_maps *maps = s->r->maps;
  s->target = (pn_attachment){s->soft->id, s->soft->target, 0, side * s->r->pair->seen.want.layers + seen_layer};
  pn_result result = begin_sum(s);
  for (int map = 0; map < maps->fit.tiles && result == PN_OK; map++) {
    ssm_list list = {.request = s->r,
                     .map = map,
                     .layer = side,
                     .seen_layer = seen_layer,
                     .share = s->kind == SUM_BOUND ? 0 : s->r->values[MERGE] / 100};
    result = s->r->values[EXTENTS] == EXTENTS_CPU ? scatter_cpu(s, &list) : scatter_gpu(s, &list);
  }
  if (result == PN_OK) end_sum(s);
  return result;
}

static pn_result scatter_all(scattering *s) {
  pn_result result = PN_OK;
  for (int side = 0; side < s->r->maps->layers; side++)
    for (int layer = 0; layer < s->r->pair->seen.want.layers && result == PN_OK; layer++)
      result = scatter(s, side, layer);
  return result;
}

/* ---- the lookup -------------------------------------------------------------------------------------------------- */

static pn_result look_up(const scattering *s, pn_attachment target) {
  const pn_visibility_request *r = s->r;
  char defines[PN_RECEIVER_DEFINES];
  const pn_program *program;
  pn_receiver_defines(r->receiver, defines);
  pn_result result = lookup_program(r->gpu, defines, s->kind == SUM_BOUND, &program);
  if (result != PN_OK) return result;
  pn_pass pass = {.color = {target}, .width = r->receiver->desc.width, .height = r->receiver->desc.height};
  result = pn_screen_begin(r->gpu, &pass, program);
  if (result != PN_OK) return result;
  GLint layers[4] = {r->pair->seen.want.layers, r->maps->layers, 0, 0};
  pn_receiver_bind(r->receiver, program, r->frame, 1);
  pn_receiver_map_bind(r->gpu, &r->pair->seen, program);
  GL(r->gpu, Uniform4iv)(pn_uniform(program, "pn_layer"), 1, layers);
  pn_bind_texture(r->gpu, PN_UNIT_WORK, s->soft->target, s->soft->id, false);
  pn_draw_screen(r->gpu);
  return PN_OK;
}

/* ---- precision --------------------------------------------------------------------------------------------------- */

/* Appendix A, Eq. 4: beside a sum near 1, 16 bits keep nothing below 2^-10, and the smallest thing a micropatch hides
 * is its area on the light as the farthest receiver sees it. */
static void warn_of_loss(const pn_visibility_request *r, const pn_region *seen) {
  const pn_fit_result *fit = &r->maps->fit;
  const double *tile = fit->tile[0], *extent = r->frame->extent;
  double depth = fit->w_near - seen->least[2];
  double share = (tile[2] - tile[0]) / r->desc->map_width * (tile[3] - tile[1]) / r->desc->map_height /
                 (4 * extent[0] * extent[1] * depth * depth);
  bool loses = share < 0x1p-10;
  if (loses && !r->pair->warned)
    pn_note(r->gpu, PN_LOG_WARNING, PN_MESSAGE_ACCUMULATION,
            "micropatches may hide as little as %.2g of the light: sums in 16 bits lose what is below 2^-10 of them",
            share);
  r->pair->warned = loses;
}

static int accumulation(const pn_visibility_request *r) {
  if (r->values[ACCUMULATE] != ACCUMULATE_FP32 || r->gpu->can.float_blend) return (int)r->values[ACCUMULATE];
  if (!r->pair->warned)
    pn_note(r->gpu, PN_LOG_INFO, PN_MESSAGE_FALLBACK,
            "this device does not blend 32-bit floats: soft shadow maps are summed up in 16 bits, by batches");
  r->pair->warned = true;
  return ACCUMULATE_BATCHED;
}

/* ---- what it leaves for the host --------------------------------------------------------------------------------- */

static void hand_out(const scattering *s) {
  pn_pair *pair = s->r->pair;
  const pn_receiver_map_want *w = &pair->seen.want;
  pair->soft = (pn_soft_shadow_map){.sides = s->r->maps->layers,
                                    .layers = w->layers,
                                    .s0 = (float)w->bounds[0],
                                    .t0 = (float)w->bounds[1],
                                    .s1 = (float)w->bounds[2],
                                    .t1 = (float)w->bounds[3]};
  pn_texture_image(s->soft, &pair->soft.image);
}

/* Eq. 3 instead of the shadow: how far the sums may be off because neighbouring micropatches overlap or part. */
static pn_result draw_bound(const pn_visibility_request *r) {
  pn_texture *soft = &r->pair->work[SSM_BOUND], *image = &r->pair->bound;
  const pn_receiver_map_want *w = &r->pair->seen.want;
  const pn_receiver_desc *view = &r->receiver->desc;
  scattering s = {.r = r, .kind = SUM_BOUND, .soft = soft};
  pn_result result = pn_texture_shape(r->gpu, soft, GL_R32F, w->width, w->height, r->maps->layers * w->layers, 1);
  if (result == PN_OK) result = pn_texture_shape(r->gpu, image, GL_R32F, view->width, view->height, 0, 1);
  if (result == PN_OK) result = scatter_all(&s);
  if (result == PN_OK) result = look_up(&s, (pn_attachment){image->id, image->target, 0, 0});
  mark(&s, "bound");
  return result;
}

/* How many micropatches each texel was asked about. */
static pn_result draw_counts(const pn_visibility_request *r) {
  pn_texture *covered = &r->pair->covered;
  const pn_receiver_map_want *w = &r->pair->seen.want;
  scattering s = {.r = r, .kind = SUM_COUNT, .soft = covered};
  pn_result result = pn_texture_shape(r->gpu, covered, GL_R32F, w->width, w->height, r->maps->layers * w->layers, 1);
  if (result == PN_OK) result = scatter_all(&s);
  mark(&s, "counts");
  return result;
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static pn_result shape(const pn_visibility_request *r, const pn_receiver_map_want *w, int accumulate) {
  pn_texture *work = r->pair->work;
  GLenum format = accumulate == ACCUMULATE_FP16 ? GL_R16F : GL_R32F;
  pn_result result =
      pn_texture_shape(r->gpu, &work[SSM_SOFT], format, w->width, w->height, r->maps->layers * w->layers, 1);
  for (int i = SSM_BATCH; i < SSM_SOFT && result == PN_OK && accumulate == ACCUMULATE_BATCHED; i++)
    result = pn_texture_shape(r->gpu, &work[i], i == SSM_BATCH ? GL_R16F : GL_R32F, w->width, w->height, 0, 1);
  return result == PN_OK ? ssm_gpu_shape(r) : result;
}

static pn_result all_lit(const pn_visibility_request *r) {
  pn_pass pass = {.color = {r->target}, .width = r->receiver->desc.width, .height = r->receiver->desc.height};
  pn_result result = pn_pass_begin(r->gpu, &pass);
  if (result == PN_OK) pn_fill(r->gpu, r->receiver->desc.width, r->receiver->desc.height, 1);
  return result;
}

static pn_result draw(const pn_visibility_request *r) {
  pn_region seen;
  pn_receiver_map_want where;
  pn_result result = find_receivers(r, &seen);
  if (result != PN_OK) return result;
  if (!place(r, &seen, &where)) return all_lit(r);
  scattering s = {.r = r, .accumulate = accumulation(r), .soft = &r->pair->work[SSM_SOFT]};
  if (r->values[ACCUMULATE] == ACCUMULATE_FP16) warn_of_loss(r, &seen);
  result = shape(r, &where, s.accumulate);
  if (result == PN_OK) result = pn_receiver_map_draw(r->receiver, r->frame, &where, &r->pair->seen);
  mark(&s, "receiver_map");
  if (result == PN_OK) result = scatter_all(&s);
  if (result == PN_OK) result = look_up(&s, r->target);
  mark(&s, "visibility");
  if (result == PN_OK) hand_out(&s);
  if (result == PN_OK && r->gpu->debug & PN_DEBUG_SEARCH) result = draw_counts(r);
  if (result == PN_OK && r->gpu->debug & PN_DEBUG_BOUND) result = draw_bound(r);
  return result;
}

const pn_technique_class pn_technique_ssm = {
    .table = {.name = "ssm",
              .title = "soft shadow maps",
              .help = "every texel of the occluder map scatters what it hides of the light into a map of the shadow",
              .parameters = parameters,
              .parameter_count = COUNT,
              .self_shadows = 1},
    .want = want,
    .preset = preset,
    .draw = draw,
    .prepare = prepare,
};
