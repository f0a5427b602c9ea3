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

static void want(const double *values, pni_maps_want *out) {
  *out = (pni_maps_want){
      .near_layers = has_front(values), .farthest = has_back(values), .range = {.structure = PNI_RANGE_PYRAMID}};
}

/* ---- programs ---------------------------------------------------------------------------------------------------- */

static pn_result lookup_program(pni_gpu *gpu, const char *receiver_defines, bool bound, const pni_program **out) {
  char defines[PNI_RECEIVER_DEFINES + 16];
  snprintf(defines, sizeof defines, "%sPN_BOUND %d\n", receiver_defines, bound);
  pni_program_key key = {"shaders/screen.vert.glsl", "techniques/ssm/lookup.frag.glsl", NULL, defines};
  return pni_program_get(gpu, &key, out);
}

static pn_result prepare(pni_gpu *gpu, const double *values) {
  static const char *const receivers[] = {"PN_NORMALS 0\nPN_MASK 0\n", "PN_NORMALS 1\nPN_MASK 0\n"};
  const pni_program *program;
  pn_result result = ssm_gpu_prepare(gpu);
  if (result == PN_OK) result = ssm_scatter_prepare(gpu);
  for (int i = 0; i < 2 && result == PN_OK; i++) result = lookup_program(gpu, receivers[i], false, &program);
  return result == PN_OK ? pni_receiver_map_prepare(gpu, (int)values[LAYERS]) : result;
}

/* ---- where the soft shadow map lies ------------------------------------------------------------------------------ */

/* Casters grown by the penumbra, as far as receivers are seen there. False: nothing to shadow. */
static bool place_axis(const pni_visibility_request *r, const pni_region *seen, int i, double *low, double *high) {
  const pni_fit_result *fit = &r->maps->fit;
  double reach = pni_penumbra_extent(r->frame->extent[i], fit->w_near, seen->least[2]);
  *low = fmax(fit->bounds[i] - reach, seen->least[i]);
  *high = fmin(fit->bounds[i + 2] + reach, seen->most[i]);
  if (!(*low <= *high)) return false;
  double least = fmax(1e-6 * fmax(fabs(*low), fabs(*high)), 1e-9);
  if (*high - *low < least) {
    *low -= least;
    *high += least;
  }
  pni_fit_snap(low, high);
  return true;
}

static pn_result find_receivers(const pni_visibility_request *r, pni_region *seen) {
  if (r->visible) {
    *seen = *r->visible;
    return PN_OK;
  }
  *seen = pni_region_empty();
  return pni_receiver_bounds(r->receiver, r->frame, seen);
}

static bool place(const pni_visibility_request *r, const pni_region *seen, pni_receiver_map_want *out) {
  int size = (int)r->values[SIZE];
  *out = (pni_receiver_map_want){.width = size ? size : r->desc->map_width,
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

/* ---- the lookup -------------------------------------------------------------------------------------------------- */

static pn_result look_up(const ssm_scattering *s, pni_attachment target) {
  const pni_visibility_request *r = s->r;
  char defines[PNI_RECEIVER_DEFINES];
  const pni_program *program;
  pni_receiver_defines(r->receiver, defines);
  pn_result result = lookup_program(r->gpu, defines, s->kind == SSM_SUM_BOUND, &program);
  if (result != PN_OK) return result;
  pni_pass pass = {.color = {target}, .width = r->receiver->desc.width, .height = r->receiver->desc.height};
  result = pni_screen_begin(r->gpu, &pass, program);
  if (result != PN_OK) return result;
  GLint layers[4] = {r->pair->seen.want.layers, r->maps->layers, 0, 0};
  pni_receiver_bind(r->receiver, program, r->frame, 1);
  pni_receiver_map_bind(r->gpu, &r->pair->seen, program);
  GL(r->gpu, Uniform4iv)(pni_uniform(program, "pn_layer"), 1, layers);
  pni_bind_texture(r->gpu, PNI_UNIT_WORK, s->soft->target, s->soft->id, false);
  pni_bind_texture(r->gpu, PNI_UNIT_MAPS, r->maps->depth.target, r->maps->depth.id, false);
  pni_draw_screen(r->gpu);
  return PN_OK;
}

/* ---- precision --------------------------------------------------------------------------------------------------- */

/* Appendix A, Eq. 4: beside a sum near 1, 16 bits keep nothing below 2^-10, and the smallest thing a micropatch hides
 * is its area on the light as the farthest receiver sees it. */
static void warn_of_loss(const pni_visibility_request *r, const pni_region *seen) {
  const pni_fit_result *fit = &r->maps->fit;
  const double *tile = fit->tile[0], *extent = r->frame->extent;
  double depth = fit->w_near - seen->least[2];
  double share = (tile[2] - tile[0]) / r->desc->map_width * (tile[3] - tile[1]) / r->desc->map_height /
                 (4 * extent[0] * extent[1] * depth * depth);
  bool loses = share < 0x1p-10;
  if (loses && !r->pair->warned)
    pni_note(r->gpu, PN_LOG_WARNING, PN_MESSAGE_ACCUMULATION,
             "micropatches may hide as little as %.2g of the light: sums in 16 bits lose what is below 2^-10 of them",
             share);
  r->pair->warned = loses;
}

static int accumulation(const pni_visibility_request *r) {
  if (r->values[ACCUMULATE] != ACCUMULATE_FP32 || r->gpu->can.float_blend) return (int)r->values[ACCUMULATE];
  if (!r->pair->warned)
    pni_note(r->gpu, PN_LOG_INFO, PN_MESSAGE_FALLBACK,
             "this device does not blend 32-bit floats: soft shadow maps are summed up in 16 bits, by batches");
  r->pair->warned = true;
  return ACCUMULATE_BATCHED;
}

/* ---- what it leaves for the host --------------------------------------------------------------------------------- */

static void hand_out(const ssm_scattering *s) {
  pni_pair *pair = s->r->pair;
  const pni_receiver_map_want *w = &pair->seen.want;
  pair->soft = (pn_soft_shadow_map){.sides = s->r->maps->layers,
                                    .layers = w->layers,
                                    .s0 = (float)w->bounds[0],
                                    .t0 = (float)w->bounds[1],
                                    .s1 = (float)w->bounds[2],
                                    .t1 = (float)w->bounds[3]};
  pni_texture_image(s->soft, &pair->soft.image);
}

static ssm_scattering start(const pni_visibility_request *r, ssm_sum_kind kind, const pni_texture *soft) {
  return (ssm_scattering){
      .r = r, .kind = kind, .soft = soft, .on_cpu = r->values[EXTENTS] == EXTENTS_CPU, .share = r->values[MERGE] / 100};
}

/* Eq. 3 instead of the shadow: how far the sums may be off because neighbouring micropatches overlap or part. */
static pn_result draw_bound(const pni_visibility_request *r) {
  pni_texture *soft = &r->pair->work[SSM_BOUND], *image = &r->pair->bound;
  const pni_receiver_map_want *w = &r->pair->seen.want;
  const pn_receiver_desc *view = &r->receiver->desc;
  ssm_scattering s = start(r, SSM_SUM_BOUND, soft);
  pn_result result = pni_texture_shape(r->gpu, soft, GL_R32F, w->width, w->height, r->maps->layers * w->layers, 1);
  if (result == PN_OK) result = pni_texture_shape(r->gpu, image, GL_R32F, view->width, view->height, 0, 1);
  if (result == PN_OK) result = ssm_scatter(&s);
  if (result == PN_OK) result = look_up(&s, (pni_attachment){image->id, image->target, 0, 0});
  ssm_mark(&s, "debug");
  return result;
}

/* How many micropatches each texel was asked about. */
static pn_result draw_counts(const pni_visibility_request *r) {
  pni_texture *covered = &r->pair->covered;
  const pni_receiver_map_want *w = &r->pair->seen.want;
  ssm_scattering s = start(r, SSM_SUM_COUNT, covered);
  pn_result result = pni_texture_shape(r->gpu, covered, GL_R32F, w->width, w->height, r->maps->layers * w->layers, 1);
  if (result == PN_OK) result = ssm_scatter(&s);
  return result;
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static pn_result shape(const pni_visibility_request *r, const pni_receiver_map_want *w, int accumulate) {
  pni_texture *work = r->pair->work;
  GLenum format = accumulate == ACCUMULATE_FP16 ? GL_R16F : GL_R32F;
  pn_result result =
      pni_texture_shape(r->gpu, &work[SSM_SOFT], format, w->width, w->height, r->maps->layers * w->layers, 1);
  for (int i = SSM_BATCH; i < SSM_SOFT && result == PN_OK && accumulate == ACCUMULATE_BATCHED; i++)
    result = pni_texture_shape(r->gpu, &work[i], i == SSM_BATCH ? GL_R16F : GL_R32F, w->width, w->height, 0, 1);
  return result == PN_OK ? ssm_gpu_shape(r) : result;
}

static pn_result draw(const pni_visibility_request *r) {
  pni_region seen;
  pni_receiver_map_want where;
  pn_result result = find_receivers(r, &seen);
  if (result != PN_OK) return result;
  const pn_receiver_desc *view = &r->receiver->desc;
  if (!place(r, &seen, &where)) return pni_fill(r->gpu, r->target, view->width, view->height, 1);
  int accumulate = accumulation(r);
  ssm_scattering s = start(r, SSM_SUM_SHADOW, &r->pair->work[SSM_SOFT]);
  s.by_batches = accumulate == ACCUMULATE_BATCHED;
  if (r->values[ACCUMULATE] == ACCUMULATE_FP16) warn_of_loss(r, &seen);
  result = shape(r, &where, accumulate);
  if (result == PN_OK) result = pni_receiver_map_draw(r->receiver, r->frame, &where, &r->pair->seen);
  ssm_mark(&s, "receiver_map");
  if (result == PN_OK) result = ssm_scatter(&s);
  if (result == PN_OK) result = look_up(&s, r->target);
  ssm_mark(&s, "visibility");
  if (result == PN_OK) hand_out(&s);
  if (result == PN_OK && r->gpu->debug & PN_DEBUG_SEARCH) result = draw_counts(r);
  bool bound = r->gpu->debug & PN_DEBUG_BOUND && r->values[MERGE] == 0; /* Eq. 3 speaks of single texels */
  if (result == PN_OK && bound) result = draw_bound(r);
  return result;
}

const pni_technique_class pni_technique_ssm = {
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
