/* The average of many hard shadow maps: slow, simple, and with enough of them right. */
#include "gl/host.h"
#include "maps/maps.h"
#include "techniques/technique.h"

/* Maps are drawn and read in batches: as many layers as a block holds. */
enum { BATCH = PNI_MAPS_MAX };

enum { PRESET, SAMPLES, COUNT };

static const char *const presets[] = {"fast", "good", "exact", NULL};

static const pn_parameter parameters[COUNT] = {
    [PRESET] = {"preset", "", "sets the others; what is named besides it goes over it", "docs/techniques/average.md",
                PN_CHOICE, 0, 2, 1, presets},
    [SAMPLES] = {"samples", "", "number of depth maps, each from its own point of the light",
                 "Bitmask Soft Shadows, Fig. 9a", PN_INT, 1, 65536, 1024, NULL},
};

static void preset(int choice, double *values) {
  static const double samples[] = {64, 1024, 4096};
  values[PRESET] = choice;
  values[SAMPLES] = samples[choice];
}

/* It draws its maps itself, batch by batch; pn_maps_update only finds out whether anything casts, and has the host
 * draw: as many maps as there are samples, so that with another number it has to again. */
static void want(const double *values, pni_maps_want *out) { *out = (pni_maps_want){.variant = (int)values[SAMPLES]}; }

/* Radical inverse in base 2. */
static double mirrored(uint32_t i) {
  double value = 0, digit = 0.5;
  for (; i; i >>= 1, digit *= 0.5)
    if (i & 1) value += digit;
  return value;
}

/* Point i of count on [-A, A]^2: the Hammersley set, moved to the middle of its strata. For powers of two it is a (0,
 * m, 2)-net in base 2. */
static void light_point(const pni_emission *emission, int i, int count, double out[2]) {
  out[0] = emission->extent[0] * (2 * (i + 0.5) / count - 1);
  out[1] = emission->extent[1] * (2 * (mirrored((uint32_t)i) + 0.5 / count) - 1);
}

/* ---- what it keeps ----------------------------------------------------------------------------------------------- */

/* Maps are drawn when they are read, one batch after the other into the same images. Where the host's callbacks draw
 * casters, which is for pn_maps_update alone, all batches are drawn then and kept. */
typedef struct {
  pni_maps **batches;
  int count, capacity;
  pni_buffer block; /* of the batch that is read */
  bool drawn;       /* in the last update: one for every BATCH samples */
} light_state;

static void release_light(pni_gpu *gpu, void *data, bool abandon) {
  light_state *state = data;
  for (int i = 0; i < state->count; i++) {
    pni_maps_free(gpu, state->batches[i], abandon);
    pni_free(gpu, state->batches[i]);
  }
  pni_free(gpu, state->batches);
  pni_buffer_free(gpu, &state->block, abandon);
  *state = (light_state){0};
}

typedef struct {
  pni_texture counts[2]; /* seen, above the horizon: before and after a batch, in turn */
} pair_state;

static void release_pair(pni_gpu *gpu, void *data, bool abandon) {
  pair_state *state = data;
  for (int i = 0; i < 2; i++) pni_texture_free(gpu, &state->counts[i], abandon);
}

static int batch_count(const pni_job *job) { return ((int)job->values[SAMPLES] + BATCH - 1) / BATCH; }

/* Each lies in memory of its own, so that the others stay where they are. */
static pn_result add_room(const pni_job *job, int count) {
  light_state *state = job->light_state;
  if (count > state->capacity) {
    pni_maps **grown = pni_reallocate(job->gpu, state->batches, (size_t)count * sizeof *grown);
    if (!grown) return PN_ERROR_OUT_OF_MEMORY;
    state->batches = grown;
    state->capacity = count;
  }
  for (; state->count < count; state->count++) {
    state->batches[state->count] = pni_allocate_zero(job->gpu, sizeof **state->batches);
    if (!state->batches[state->count]) return PN_ERROR_OUT_OF_MEMORY;
  }
  return PN_OK;
}

/* Room for so many batches; what more there is goes, unless this is only planned. */
static pn_result shape_batches(const pni_job *job, int count) {
  light_state *state = job->light_state;
  pni_gpu *gpu = job->gpu;
  static const pni_maps_want one = {.near_layers = 1};
  for (; state->count > count && !gpu->plan.on; state->count--) {
    pni_maps_free(gpu, state->batches[state->count - 1], false);
    pni_free(gpu, state->batches[state->count - 1]);
  }
  pn_result result = add_room(job, count);
  for (int i = 0; i < count && result == PN_OK; i++)
    result = pni_maps_shape(gpu, state->batches[i], &one, BATCH, job->desc->map_width, job->desc->map_height);
  return result;
}

/* ---- maps -------------------------------------------------------------------------------------------------------- */

static pni_fit_request fit_point(const pni_job *job, const double shear[2], pni_fit_result *fit) {
  pni_fit_request request = {.frame = job->frame,
                             .emission = job->emission,
                             .shear = {shear[0], shear[1]},
                             .near_distance = job->desc->near_distance,
                             .range = job->desc->range,
                             .width = job->desc->map_width,
                             .height = job->desc->map_height,
                             .given = job->desc->fit == PN_FIT_GIVEN ? job->desc->fit_bounds : NULL,
                             .visible = job->visible,
                             .kept = job->maps->fit.kept.cell[0] > 0 ? &job->maps->fit.kept : NULL};
  pni_fit_maps(job->casters, job->groups, &request, fit);
  if (!fit->empty) return request;
  request.visible = NULL;
  request.kept = NULL; /* from this point no caster shadows anything seen: any map will do */
  pni_fit_maps(job->casters, job->groups, &request, fit);
  return request;
}

/* A map from one point is never split: its border tiles would cost as much as more points. */
static pn_result draw_map(const pni_job *job, pni_maps *batch, const double shear[2]) {
  pni_fit_result fit;
  pni_fit_request request = fit_point(job, shear, &fit);
  pni_map_draw draw = {.frame = job->frame,
                       .casters = job->casters,
                       .groups = job->groups,
                       .bounds = {fit.bounds[0], fit.bounds[1], fit.bounds[2], fit.bounds[3]},
                       .w_near = fit.w_near,
                       .w_far = fit.w_far,
                       .shear = {shear[0], shear[1]},
                       .range = pni_fit_range(&request),
                       .floor = fit.kept.has_floor ? fit.kept.floor : NULL,
                       .without_host = job->receiver != NULL};
  if (fit.tiles == 1)
    for (int i = 0; i < 4; i++) draw.bounds[i] = fit.tile[0][i];
  return pni_maps_add(job->gpu, batch, &draw);
}

static pn_result draw_batch(const pni_job *job, int index, pni_maps *batch) {
  int samples = (int)job->values[SAMPLES];
  pn_result result = PN_OK;
  pni_maps_describe(job->gpu, batch, job->frame, job->emission);
  int end = BATCH * index + (job->gpu->plan.on ? 1 : BATCH); /* all are drawn alike */
  for (int i = BATCH * index; i < end && i < samples && result == PN_OK; i++) {
    double point[2];
    light_point(job->emission, i, samples, point);
    result = draw_map(job, batch, point);
  }
  return result;
}

static pn_result update(const pni_job *job) {
  light_state *state = job->light_state;
  int count = batch_count(job);
  bool draws = pni_casters_call_host(job->casters, job->groups);
  pn_result result = draws ? shape_batches(job, count) : PN_OK;
  if (result == PN_OK && draws && job->gpu->plan.on) return draw_batch(job, 0, state->batches[0]);
  for (int i = 0; i < count && draws && result == PN_OK; i++) result = draw_batch(job, i, state->batches[i]);
  if (!job->gpu->plan.on) state->drawn = draws && result == PN_OK;
  return result;
}

/* ---- counting ---------------------------------------------------------------------------------------------------- */

static pn_result clear_counts(const pni_job *job, const pni_texture *counts) {
  static const float zero[4] = {0, 0, 0, 0};
  pni_pass pass = {.name = "average, counts",
                   .color = {pni_image_of(counts, 0, 0)},
                   .clear = zero,
                   .width = counts->width,
                   .height = counts->height};
  return pni_pass_begin(job->gpu, &pass);
}

static pn_result add_batch(const pni_job *job, const pni_maps *batch, const pni_texture *from, const pni_texture *to) {
  light_state *state = job->light_state;
  pni_gpu *gpu = job->gpu;
  char defines[PNI_RECEIVER_DEFINES];
  pni_receiver_defines(job->receiver, defines);
  pn_result result = pni_buffer_reserve(gpu, &state->block, "light", PNI_BUFFER_BLOCK, sizeof batch->block);
  if (result == PN_OK && !gpu->plan.on)
    result = pni_buffer_fill(gpu, &state->block, "light", PNI_BUFFER_BLOCK, &batch->block, sizeof batch->block);
  if (result != PN_OK) return result;
  pni_bind_block(gpu, &state->block);
  pni_pass pass = {.name = "average",
                   .program = {.fragment = "techniques/average/average.frag.glsl", .defines = defines},
                   .color = {pni_image_of(to, 0, 0)},
                   .width = to->width,
                   .height = to->height};
  result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  pni_receiver_uniforms(job->receiver, job->frame, job->emission, &job->maps->rounding, 1);
  pni_set_texture(gpu, "pn_maps", &batch->depth);
  pni_set_texture(gpu, "pn_counts", from);
  pni_draw_screen(gpu);
  return PN_OK;
}

static pn_result resolve(const pni_job *job, const pni_texture *counts) {
  pni_pass pass =
      pni_job_pass(job, "average, resolved", (pni_program_key){.fragment = "techniques/average/resolve.frag.glsl"});
  pn_result result = pni_pass_begin(job->gpu, &pass);
  if (result != PN_OK) return result;
  pni_set_texture(job->gpu, "pn_counts", counts);
  pni_draw_screen(job->gpu);
  return PN_OK;
}

static pn_result shape(const pni_job *job) {
  light_state *state = job->light_state;
  pair_state *pair = job->pair_state;
  const pn_receiver_desc *view = &job->receiver->desc;
  pn_result result = state->drawn ? PN_OK : shape_batches(job, 1);
  for (int i = 0; i < 2 && result == PN_OK; i++)
    result =
        pni_texture_shape(job->gpu, &pair->counts[i], "average counts", PNI_RG32F, view->width, view->height, 0, 1);
  return result;
}

static pn_result draw(const pni_job *job) {
  light_state *state = job->light_state;
  pair_state *pair = job->pair_state;
  if (!state->drawn && !job->casters)
    return pni_fail(job->gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE,
                    "the casters of the last pn_maps_update are gone");
  int count = job->gpu->plan.on ? 1 : batch_count(job);
  pn_result result = shape(job);
  if (result == PN_OK) result = clear_counts(job, &pair->counts[0]);
  for (int i = 0; i < count && result == PN_OK; i++) {
    pni_maps *batch = state->batches[state->drawn ? i : 0];
    if (!state->drawn) result = draw_batch(job, i, batch);
    if (result == PN_OK) result = add_batch(job, batch, &pair->counts[i & 1], &pair->counts[!(i & 1)]);
  }
  if (result == PN_OK) result = resolve(job, &pair->counts[count & 1]);
  pni_job_mark(job, "visibility");
  return result;
}

static void sketch(double *values) { values[SAMPLES] = 1; }

const pni_technique_class pni_technique_average = {
    .table = {.name = "average",
              .title = "average of hard shadows",
              .help = "many hard shadow maps from well-spread points of the light: slow, and right with enough of them",
              .parameters = parameters,
              .parameter_count = COUNT,
              .self_shadows = 1},
    .want = want,
    .preset = preset,
    .sketch = sketch,
    .draw = draw,
    .update = update,
    .stage = "depth_map",
    .light_kind = {.bytes = sizeof(light_state), .release = release_light},
    .pair_kind = {.bytes = sizeof(pair_state), .release = release_pair},
};
