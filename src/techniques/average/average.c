/* The average of many hard shadow maps: slow, simple, and with enough of them right. */
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

/* It draws its maps itself, batch by batch; pn_maps_update only finds out whether anything casts. */
static void want(const double *values, pni_maps_want *out) {
  (void)values;
  *out = (pni_maps_want){0};
}

/* Radical inverse in base 2. */
static double mirrored(uint32_t i) {
  double value = 0, digit = 0.5;
  for (; i; i >>= 1, digit *= 0.5)
    if (i & 1) value += digit;
  return value;
}

/* Point i of count on [-A, A]^2: the Hammersley set, moved to the middle of its strata. For powers of two it is a (0,
 * m, 2)-net in base 2. */
static void light_point(const pni_frame *frame, int i, int count, double out[2]) {
  out[0] = frame->extent[0] * (2 * (i + 0.5) / count - 1);
  out[1] = frame->extent[1] * (2 * (mirrored((uint32_t)i) + 0.5 / count) - 1);
}

typedef struct {
  const pni_visibility_request *request;
  int width, height; /* of the images */
  int current;       /* which work image holds the counts */
  pni_light_block block;
} averaging;

static void fit_point(const averaging *a, const double shear[2], pni_fit_result *fit) {
  const pni_visibility_request *r = a->request;
  pni_fit_request request = {.frame = r->frame,
                             .shear = {shear[0], shear[1]},
                             .near_distance = r->desc->near_distance,
                             .range = r->desc->range,
                             .width = r->desc->map_width,
                             .height = r->desc->map_height,
                             .given = r->desc->fit == PN_FIT_GIVEN ? r->desc->fit_bounds : NULL,
                             .visible = r->visible};
  pni_fit_maps(r->casters, r->groups, &request, fit);
  if (!fit->empty) return;
  request.visible = NULL; /* from this point no caster shadows anything seen: any map will do */
  pni_fit_maps(r->casters, r->groups, &request, fit);
}

/* A map from one point is never split: its border tiles would cost as much as more points. */
static pn_result draw_map(averaging *a, int map, const double shear[2]) {
  const pni_visibility_request *r = a->request;
  pni_fit_result fit;
  fit_point(a, shear, &fit);
  pni_map_draw draw = {.frame = r->frame,
                       .casters = r->casters,
                       .groups = r->groups,
                       .map = map,
                       .bounds = {fit.bounds[0], fit.bounds[1], fit.bounds[2], fit.bounds[3]},
                       .w_near = fit.w_near,
                       .w_far = fit.w_far,
                       .shear = {shear[0], shear[1]}};
  if (fit.tiles == 1)
    for (int i = 0; i < 4; i++) draw.bounds[i] = fit.tile[0][i];
  pni_block_map(&a->block, r->gpu, &draw, r->desc->map_width, r->desc->map_height);
  return pni_maps_draw(r->gpu, r->maps, &draw);
}

static pn_result average_program(pni_gpu *gpu, const pn_receiver *receiver, const pni_program **out) {
  char defines[PNI_RECEIVER_DEFINES] = "PN_NORMALS 0\nPN_MASK 0\n";
  if (receiver) pni_receiver_defines(receiver, defines);
  pni_program_key key = {"shaders/screen.vert.glsl", "techniques/average/average.frag.glsl", NULL, defines};
  return pni_program_get(gpu, &key, out);
}

static pn_result add_batch(averaging *a, int count) {
  const pni_visibility_request *r = a->request;
  const pni_program *program;
  pn_result result = average_program(r->gpu, r->receiver, &program);
  a->block.maps[0] = (float)count;
  if (result == PN_OK) result = pni_uniform_buffer_set(r->gpu, r->block, &a->block, sizeof a->block);
  if (result != PN_OK) return result;
  pni_texture *from = &r->pair->work[a->current], *to = &r->pair->work[!a->current];
  pni_pass pass = {.color = {{to->id, to->target, 0, 0}}, .width = a->width, .height = a->height};
  result = pni_screen_begin(r->gpu, &pass, program);
  if (result != PN_OK) return result;
  GL(r->gpu, BindBufferBase)(GL_UNIFORM_BUFFER, PNI_BLOCK_BINDING, r->block->id);
  pni_receiver_bind(r->receiver, program, r->frame, 1);
  pni_bind_texture(r->gpu, PNI_UNIT_MAPS, GL_TEXTURE_2D_ARRAY, r->maps->depth.id, false);
  pni_bind_texture(r->gpu, PNI_UNIT_WORK, GL_TEXTURE_2D, from->id, false);
  pni_draw_screen(r->gpu);
  a->current = !a->current;
  return PN_OK;
}

static void start_block(averaging *a) {
  const pni_visibility_request *r = a->request;
  pni_block_frame(&a->block, r->frame, r->gpu, BATCH, 1, r->desc->map_width, r->desc->map_height);
}

static pn_result clear_counts(averaging *a) {
  const pni_visibility_request *r = a->request;
  pni_texture *work = &r->pair->work[a->current];
  pni_pass pass = {.color = {{work->id, work->target, 0, 0}}, .width = a->width, .height = a->height};
  pn_result result = pni_pass_begin(r->gpu, &pass);
  static const GLfloat zero[4] = {0, 0, 0, 0};
  if (result == PN_OK) GL(r->gpu, ClearBufferfv)(GL_COLOR, 0, zero);
  return result;
}

static pn_result resolve_program(pni_gpu *gpu, const pni_program **out) {
  pni_program_key key = {"shaders/screen.vert.glsl", "techniques/average/resolve.frag.glsl", NULL, ""};
  return pni_program_get(gpu, &key, out);
}

static pn_result resolve(averaging *a) {
  const pni_visibility_request *r = a->request;
  const pni_program *program;
  pn_result result = resolve_program(r->gpu, &program);
  if (result != PN_OK) return result;
  pni_pass pass = {.color = {r->target}, .width = a->width, .height = a->height};
  result = pni_screen_begin(r->gpu, &pass, program);
  if (result != PN_OK) return result;
  pni_bind_texture(r->gpu, PNI_UNIT_WORK, GL_TEXTURE_2D, r->pair->work[a->current].id, false);
  pni_draw_screen(r->gpu);
  return PN_OK;
}

static pn_result shape(averaging *a) {
  const pni_visibility_request *r = a->request;
  static const pni_maps_want one = {.near_layers = 1};
  pn_result result = pni_maps_shape(r->gpu, r->maps, &one, BATCH, r->desc->map_width, r->desc->map_height);
  for (int i = 0; i < 2 && result == PN_OK; i++)
    result = pni_texture_shape(r->gpu, &r->pair->work[i], GL_RG32F, a->width, a->height, 0, 1);
  return result;
}

static pn_result draw(const pni_visibility_request *r) {
  averaging a = {.request = r, .width = r->receiver->desc.width, .height = r->receiver->desc.height};
  int samples = (int)r->values[SAMPLES];
  pn_result result = shape(&a);
  if (result == PN_OK) result = clear_counts(&a);
  start_block(&a);
  for (int i = 0; i < samples && result == PN_OK; i++) {
    double point[2];
    light_point(r->frame, i, samples, point);
    result = draw_map(&a, i % BATCH, point);
    bool last = i % BATCH == BATCH - 1 || i == samples - 1;
    if (result != PN_OK || !last) continue;
    result = add_batch(&a, i % BATCH + 1);
    start_block(&a);
  }
  if (result == PN_OK) result = resolve(&a);
  pni_clock_mark(r->gpu, &r->pair->clock, "visibility");
  return result;
}

static pn_result prepare(pni_gpu *gpu, const double *values) {
  (void)values;
  const pni_program *program;
  pn_result result = average_program(gpu, NULL, &program);
  if (result == PN_OK) result = resolve_program(gpu, &program);
  return result == PN_OK ? pni_casters_prepare(gpu, false) : result;
}

const pni_technique_class pni_technique_average = {
    .table = {.name = "average",
              .title = "average of hard shadows",
              .help = "many hard shadow maps from well-spread points of the light: slow, and right with enough of them",
              .parameters = parameters,
              .parameter_count = COUNT,
              .self_shadows = 1},
    .want = want,
    .preset = preset,
    .draw = draw,
    .prepare = prepare,
};
