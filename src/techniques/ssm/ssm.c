/* Soft shadow maps (Atty et al. 2006): every texel of the occluder map scatters its shadow. */
#include "techniques/ssm/ssm.h"

#include <math.h>
#include <stdio.h>

#include "gl/host.h"
#include "maps/texels.h"

enum { PRESET, SIDES, FACES, ACCUMULATE, EXTENTS, MERGE, SIZE, LAYERS, COUNT };
enum { SIDES_BOTH, SIDES_FRONT, SIDES_BACK };
enum { FACES_ANY, FACES_CULLED };
enum { ACCUMULATE_FP32, ACCUMULATE_BATCHED, ACCUMULATE_FP16, ACCUMULATE_CONSECUTIVE };
enum { EXTENTS_GPU, EXTENTS_CPU };
enum { RECEIVER_LAYERS_MAX = 8 };

static const char *const presets[] = {"fast", "good", "exact", "paper", NULL};
static const char *const sides[] = {"both", "front", "back", NULL};
static const char *const faces[] = {"any", "culled", NULL};
static const char *const accumulations[] = {"fp32", "fp16-batched", "fp16", "fp16-consecutive", NULL};
static const char *const extents[] = {"gpu", "cpu", NULL};

static const pn_parameter parameters[COUNT] = {
    [PRESET] = {"preset", "", "sets the others; what is named besides it goes over it", "docs/techniques/ssm.md",
                PN_CHOICE, 0, 3, 1, presets},
    [SIDES] = {"sides", "", "which surfaces cast: the nearest and the farthest, merged by maximum, or one of them",
               "Soft Shadow Maps, section 3.5", PN_CHOICE, 0, 2, SIDES_BOTH, sides},
    [FACES] = {"faces", "",
               "nearest and farthest of all faces; or nearest of those that look at the light, farthest of those that "
               "look away",
               "Soft Shadow Maps, section 3.5", PN_CHOICE, 0, 1, FACES_ANY, faces},
    [ACCUMULATE] =
        {"accumulate", "",
         "sums in 32 bits; in 16 bits by batches of sqrt(M) of M micropatches, summed in 32; one by one in 16 bits; "
         "in 16 bits by batches of neighbours",
         "Soft Shadow Maps, section 5.1.3", PN_CHOICE, 0, 3, ACCUMULATE_FP32, accumulations},
    [EXTENTS] = {"extents", "", "where penumbra extents are found; cpu reads the maps back, the paper the occluder map",
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
  if (choice == 3) { /* paper */
    values[FACES] = FACES_CULLED;
    values[ACCUMULATE] = ACCUMULATE_FP16;
    values[EXTENTS] = EXTENTS_CPU;
    values[MERGE] = 0;
    values[LAYERS] = 1;
  }
}

static bool has_front(const double *values) { return values[SIDES] != SIDES_BACK; }
static bool has_back(const double *values) { return values[SIDES] != SIDES_FRONT; }

static void want(const double *values, pni_maps_want *out) {
  bool culled = values[FACES] == FACES_CULLED;
  *out = (pni_maps_want){.near_layers = has_front(values),
                         .farthest = has_back(values),
                         .near_faces = culled ? PN_FACES_FRONT : (pn_faces)0,
                         .far_faces = culled ? PN_FACES_BACK : (pn_faces)0,
                         .range = {.structure = PNI_RANGE_PYRAMID}};
}

/* ---- what it keeps for a pair ------------------------------------------------------------------------------------ */

static void free_scratch(pni_gpu *gpu, pni_ssm_state *s) {
  pni_free(gpu, s->scratch);
  s->scratch = NULL;
  s->scratch_floats = 0;
}

static void release(pni_gpu *gpu, void *data, bool abandon) {
  pni_ssm_state *s = data;
  pni_texture *all[] = {&s->counts,  &s->list, &s->limits,  &s->totals, &s->batch, &s->sums[0],
                        &s->sums[1], &s->soft, &s->covered, &s->bounds, &s->bound};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) pni_texture_free(gpu, all[i], abandon);
  pni_seen_free(gpu, &s->seen, abandon);
  pni_buffer_free(gpu, &s->arguments, abandon);
  free_scratch(gpu, s);
}

static const pni_texture *image(const void *data, int index, const char **name) {
  static const char *const names[] = {"receivers", "covered", "bound"};
  const pni_ssm_state *s = data;
  const pni_texture *all[] = {&s->seen.layers, &s->covered, &s->bound};
  if (index >= (int)(sizeof all / sizeof *all)) return NULL;
  *name = names[index];
  return all[index];
}

static bool soft_shadow_map(const void *data, pn_soft_shadow_map *out) {
  const pni_ssm_state *s = data;
  *out = s->shown;
  return s->shown.image.texture != 0;
}

/* ---- where the soft shadow map lies ------------------------------------------------------------------------------ */

/* Casters grown by the penumbra, as far as receivers are seen there. False: nothing to shadow. */
static bool place_axis(const pni_job *job, const pni_region *seen, int i, int texels, double *low, double *high) {
  const pni_fit_result *fit = &job->maps->fit;
  double reach = pni_penumbra_extent(job->emission->extent[i], fit->w_near, seen->least[2]);
  *low = fmax(fit->bounds[i] - reach, seen->least[i]);
  *high = fmin(fit->bounds[i + 2] + reach, seen->most[i]);
  if (!(*low <= *high)) return false;
  double least = fmax(1e-6 * fmax(fabs(*low), fabs(*high)), 1e-9);
  if (*high - *low < least) {
    *low -= least;
    *high += least;
  }
  pni_axis axis = pni_texels_around(*low, *high, texels);
  *low = axis.from;
  *high = axis.to;
  return true;
}

static pn_result find_receivers(const pni_job *job, pni_region *seen) {
  *seen = pni_region_empty();
  if (job->visible) *seen = *job->visible;
  return job->visible ? PN_OK : pni_receiver_bounds(job->receiver, job->frame, seen);
}

/* While the call is planned nothing is known of receivers: it lies anywhere. */
static bool place(const pni_job *job, const pni_region *seen, pni_seen_want *out) {
  int size = (int)job->values[SIZE];
  *out = (pni_seen_want){.width = size ? size : job->desc->map_width,
                         .height = size ? size : job->desc->map_height,
                         .layers = (int)job->values[LAYERS]};
  for (int i = 0; i < 2 && !job->gpu->plan.on; i++)
    if (!place_axis(job, seen, i, i ? out->height : out->width, &out->bounds[i], &out->bounds[i + 2])) return false;
  /* Receivers in a plane that faces the light have no extent in w; the depth test needs one that floats resolve. */
  double span = fmax(seen->most[2] - seen->least[2], 1e-3 * fabs(seen->most[2]) + 1e-12);
  out->w_least = seen->least[2] - 0.1 * span;
  out->w_most = seen->most[2] + 0.1 * span;
  return true;
}

/* ---- the lookup -------------------------------------------------------------------------------------------------- */

static pn_result look_up(const pni_ssm_scattering *s, pni_target target) {
  const pni_job *job = s->job;
  pni_gpu *gpu = job->gpu;
  char receiver[PNI_RECEIVER_DEFINES], defines[PNI_RECEIVER_DEFINES + 16];
  pni_receiver_defines(job->receiver, receiver);
  snprintf(defines, sizeof defines, "%sPN_BOUND %d\n", receiver, s->kind == PNI_SSM_SUM_BOUND);
  pni_pass pass =
      pni_job_pass(job, "ssm", (pni_program_key){.fragment = "techniques/ssm/lookup.frag.glsl", .defines = defines});
  pass.color[0] = target.image;
  pass.channels = target.channels;
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  pni_receiver_uniforms(job->receiver, job->frame, job->emission, &job->maps->rounding, 1);
  pni_seen_set(gpu, &s->state->seen);
  pni_set_ints(gpu, "pn_layer", s->state->seen.want.layers, pni_want_layers(&job->maps->want), 0, 0);
  pni_set_texture(gpu, "pn_soft", s->soft);
  pni_set_texture(gpu, "pn_maps", &job->maps->depth);
  pni_draw_screen(gpu);
  return PN_OK;
}

/* ---- precision --------------------------------------------------------------------------------------------------- */

/* Area of a texel of the finest tile: a wide light's meet in angles, so in the middle texels are smaller. */
static double finest_texel(const pni_job *job) {
  const pni_fit_result *fit = &job->maps->fit;
  double least = INFINITY;
  for (int i = 0; i < fit->tiles; i++) {
    const double *tile = fit->tile[i];
    least = fmin(least, (tile[2] - tile[0]) / job->desc->map_width * (tile[3] - tile[1]) / job->desc->map_height);
  }
  return least;
}

/* Appendix A, Eq. 4: beside a sum near 1, 16 bits keep nothing below 2^-10, and the smallest thing a micropatch hides
 * is its area on the light as the farthest receiver sees it. */
static void warn_of_loss(const pni_job *job, const pni_region *seen) {
  pni_ssm_state *state = job->pair_state;
  const double *extent = job->emission->extent;
  double depth = job->maps->fit.w_near - seen->least[2];
  double share = finest_texel(job) / (4 * extent[0] * extent[1] * depth * depth);
  bool loses = share < 0x1p-10;
  if (loses && !state->warned)
    pni_note(job->gpu, PN_LOG_WARNING, PN_MESSAGE_ACCUMULATION,
             "micropatches may hide as little as %.2g of the light: sums in 16 bits lose what is below 2^-10 of them",
             share);
  state->warned = loses;
}

static int accumulation(const pni_job *job) {
  pni_ssm_state *state = job->pair_state;
  if (job->values[ACCUMULATE] != ACCUMULATE_FP32 || job->gpu->can.float_blend) return (int)job->values[ACCUMULATE];
  if (!state->warned)
    pni_note(job->gpu, PN_LOG_INFO, PN_MESSAGE_FALLBACK,
             "this device does not blend 32-bit floats: soft shadow maps are summed up in 16 bits, by batches");
  state->warned = true;
  return ACCUMULATE_BATCHED;
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static void hand_out(pni_ssm_state *state, const pni_job *job) {
  const pni_seen_want *w = &state->seen.want;
  double offset[3];
  pni_frame_offset(job->frame, offset);
  state->shown = (pn_soft_shadow_map){.sides = pni_want_layers(&job->maps->want),
                                      .layers = w->layers,
                                      .s0 = (float)(w->bounds[0] + offset[0]),
                                      .t0 = (float)(w->bounds[1] + offset[1]),
                                      .s1 = (float)(w->bounds[2] + offset[0]),
                                      .t1 = (float)(w->bounds[3] + offset[1])};
  pni_texture_describe(&state->soft, &state->shown.image);
}

static pni_ssm_scattering start(const pni_job *job, pni_ssm_sum_kind kind, const pni_texture *soft) {
  return (pni_ssm_scattering){.job = job,
                              .state = job->pair_state,
                              .kind = kind,
                              .soft = soft,
                              .on_cpu = job->values[EXTENTS] == EXTENTS_CPU,
                              .share = job->values[MERGE] / 100};
}

/* An image like the soft shadow map. */
static pn_result shape_soft(const pni_job *job, pni_texture *image, const char *label, pni_format format) {
  const pni_ssm_state *state = job->pair_state;
  const pni_seen_want *w = &state->seen.want;
  int layers = pni_want_layers(&job->maps->want) * w->layers;
  return pni_texture_shape(job->gpu, image, label, format, w->width, w->height, layers, 1);
}

/* Eq. 3 instead of the shadow: how far the sums may be off because neighbouring micropatches overlap or part. */
static pn_result draw_bound(const pni_job *job) {
  pni_ssm_state *state = job->pair_state;
  const pn_receiver_desc *view = &job->receiver->desc;
  pni_ssm_scattering s = start(job, PNI_SSM_SUM_BOUND, &state->bounds);
  pn_result result = shape_soft(job, &state->bounds, "bounds of the error", PNI_R32F);
  if (result == PN_OK)
    result = pni_texture_shape(job->gpu, &state->bound, "bound", PNI_R32F, view->width, view->height, 0, 1);
  if (result == PN_OK) result = pni_ssm_scatter(&s);
  if (result == PN_OK) result = look_up(&s, (pni_target){pni_image_of(&state->bound, 0, 0), 0});
  pni_ssm_mark(&s, "debug");
  return result;
}

/* How many micropatches each texel was asked about. */
static pn_result draw_counts(const pni_job *job) {
  pni_ssm_state *state = job->pair_state;
  pni_ssm_scattering s = start(job, PNI_SSM_SUM_COUNT, &state->covered);
  pn_result result = shape_soft(job, &state->covered, "covered", PNI_R32F);
  return result == PN_OK ? pni_ssm_scatter(&s) : result;
}

static pn_result shape(const pni_job *job, int accumulate) {
  pni_ssm_state *state = job->pair_state;
  const pni_seen_want *w = &state->seen.want;
  bool batched = accumulate == ACCUMULATE_BATCHED || accumulate == ACCUMULATE_CONSECUTIVE;
  pni_format format = accumulate == ACCUMULATE_FP32 || accumulate == ACCUMULATE_BATCHED ? PNI_R32F : PNI_R16F;
  pn_result result = shape_soft(job, &state->soft, "soft shadow map", format);
  if (result == PN_OK && batched) {
    result = pni_texture_shape(job->gpu, &state->batch, "batch", PNI_R16F, w->width, w->height, 0, 1);
    for (int i = 0; i < 2 && result == PN_OK; i++)
      result = pni_texture_shape(job->gpu, &state->sums[i], "sum of batches", format, w->width, w->height, 0, 1);
  }
  return result == PN_OK ? pni_ssm_gpu_shape(job) : result;
}

static pn_result draw_shadow(const pni_job *job, const pni_region *seen, const pni_seen_want *where) {
  pni_ssm_state *state = job->pair_state;
  int accumulate = accumulation(job);
  pni_ssm_scattering s = start(job, PNI_SSM_SUM_SHADOW, &state->soft);
  s.by_batches = accumulate == ACCUMULATE_BATCHED || accumulate == ACCUMULATE_CONSECUTIVE;
  s.consecutive = accumulate == ACCUMULATE_CONSECUTIVE;
  if (job->values[ACCUMULATE] == ACCUMULATE_FP16 && !job->gpu->plan.on) warn_of_loss(job, seen);
  pn_result result = pni_seen_draw(job, where, &state->seen);
  if (result == PN_OK) result = shape(job, accumulate);
  pni_ssm_mark(&s, "receiver_map");
  if (result == PN_OK) result = pni_ssm_scatter(&s);
  if (result == PN_OK) result = look_up(&s, job->target);
  pni_ssm_mark(&s, "visibility");
  if (result == PN_OK && !job->gpu->plan.on) hand_out(state, job);
  return result;
}

static pn_result draw(const pni_job *job) {
  pni_ssm_state *state = job->pair_state;
  pni_region seen;
  pni_seen_want where;
  pn_result result = find_receivers(job, &seen);
  if (result != PN_OK) return result;
  if (!job->gpu->plan.on) state->shown = (pn_soft_shadow_map){0};
  if (!place(job, &seen, &where)) {
    pni_pass pass = pni_job_pass(job, NULL, (pni_program_key){0});
    return pni_fill(job->gpu, "nothing to shadow", &pass, 1);
  }
  result = draw_shadow(job, &seen, &where);
  if (result == PN_OK && job->gpu->debug & PN_DEBUG_SEARCH) result = draw_counts(job);
  bool bound = job->gpu->debug & PN_DEBUG_BOUND && job->values[MERGE] == 0; /* Eq. 3 speaks of single texels */
  if (result == PN_OK && bound) result = draw_bound(job);
  if (!job->gpu->plan.on) free_scratch(job->gpu, state);
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
    .pair_kind = {.bytes = sizeof(pni_ssm_state), .release = release, .image = image},
    .soft_shadow_map = soft_shadow_map,
};
