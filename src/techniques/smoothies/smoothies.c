/* Smoothies (Chan and Durand 2003): a hard shadow whose edge is softened outwards by primitives along the silhouettes.
 * docs/techniques/smoothies.md derives what the shaders compute. */
#include "techniques/technique.h"

#include <math.h>

#include "gl/host.h"
#include "silhouettes/silhouettes.h"

enum { PRESET, GEOMETRY, WIDTH, FILTER, REMAP, RECEIVER, COUNT };

static const char *const presets[] = {"fast", "good", "exact", "paper", NULL};
static const char *const geometries[] = {"edges", "cones", NULL};
static const char *const receivers[] = {"map", "pixel", NULL};
static const char *const width_words[] = {"light", NULL};

static const pn_parameter parameters[COUNT] = {
    [PRESET] = {"preset", "", "sets the others; what is named besides it goes over it", "docs/techniques/smoothies.md",
                PN_CHOICE, 0, 3, 1, presets},
    [GEOMETRY] = {"geometry", "", "rectangles along edges and rounded corners, or sheets and cones shaped by the light",
                  "Chan and Durand 2003; Haines 2001, Wyman and Hansen 2003", PN_CHOICE, 0, 1, 1, geometries},
    [WIDTH] = {"width", "map units", "how far smoothies reach: by the light's real size, or the same everywhere",
               "Chan and Durand 2003", PN_FLOAT, 0, 100, 0, width_words},
    [FILTER] = {"filter", "", "looks up 2 x 2 texels and weighs the results", "Chan and Durand 2003", PN_BOOL, 0, 1, 1,
                NULL},
    [REMAP] = {"remap", "", "penumbrae widen behind an edge, by alpha / (1 - b / r); off: alpha alone, wide everywhere",
               "Chan and Durand 2003", PN_BOOL, 0, 1, 1, NULL},
    [RECEIVER] = {"receiver", "",
                  "whose distance r is: the surface's behind the smoothie in the light's map, or each pixel's",
                  "Chan and Durand 2003; docs/techniques/smoothies.md", PN_CHOICE, 0, 1, 1, receivers},
};

static void preset(int choice, double *values) {
  for (int i = 0; i < COUNT; i++) values[i] = parameters[i].initial;
  values[PRESET] = choice;
  values[FILTER] = choice != 0 && choice != 3; /* fast, paper */
  if (choice == 3) {
    values[GEOMETRY] = 0;
    values[WIDTH] = 0.05; /* the notes have no number */
    values[RECEIVER] = 0;
  }
}

/* Whether the image is the notes' smoothie buffer: what is seen does not depend on the pixel's own distance. */
static bool keeps_alpha(const double *values) { return values[REMAP] < 0.5 || values[RECEIVER] < 0.5; }

static void want(const double *values, pni_maps_want *out) {
  *out = (pni_maps_want){.near_layers = 1,
                         .reach = true,
                         .reach_width = values[WIDTH],
                         .reach_turned = values[GEOMETRY] < 0.5 && values[WIDTH] == 0,
                         .receivers = values[RECEIVER] < 0.5,
                         .variant = (int)values[GEOMETRY] + 2 * (int)values[REMAP] + 4 * (int)values[RECEIVER]};
}

/* ---- what it keeps for a light ----------------------------------------------------------------------------------- */

enum { SUMMED = 64, LEVELS = 3 };

typedef struct {
  pni_texture image; /* the smoothies, a layer for each map */
  /* Filled anew for each instance; as large as the largest mesh needs. */
  pni_texture kept;         /* 1 for silhouettes that have a smoothie to draw */
  pni_texture sums[LEVELS]; /* of those among 64 edges, 64 of those, 64 of those */
  pni_texture total, list;  /* the draw's arguments; the edges that have one */
  pni_buffer arguments;
  bool told; /* that some casters have no edges to find */
} smoothies;

static void release(pni_gpu *gpu, void *state, bool abandon) {
  smoothies *s = state;
  pni_texture *all[] = {&s->image, &s->kept, &s->sums[0], &s->sums[1], &s->sums[2], &s->total, &s->list};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) pni_texture_free(gpu, all[i], abandon);
  pni_buffer_free(gpu, &s->arguments, abandon);
}

static const pni_texture *image(const void *state, int index, const char **name) {
  *name = "smoothies";
  return index == 0 ? &((const smoothies *)state)->image : NULL;
}

static const pni_texture *beside(const void *light_state) { return &((const smoothies *)light_state)->image; }

/* ---- the list of smoothies --------------------------------------------------------------------------------------- */

typedef struct {
  const pni_job *job;
  smoothies *state;
  pni_matrix light_from_scene;
  double farthest; /* beyond it casters cast nothing */
  float cut;       /* nearer than the nearest caster's plane nothing is drawn */
} drawing;

static size_t summed(size_t count) { return (count + SUMMED - 1) / SUMMED; }

/* A table of so many entries, or as large as it is. */
static pn_result grow_table(pni_gpu *gpu, pni_texture *t, const char *label, pni_format format, size_t entries) {
  int rows = (int)((entries + PNI_EDGE_ROW - 1) / PNI_EDGE_ROW);
  return pni_texture_shape(gpu, t, label, format, PNI_EDGE_ROW, rows > t->height ? rows : t->height, 0, 1);
}

static pn_result shape_tables(pni_gpu *gpu, smoothies *s, size_t count) {
  pn_result result = grow_table(gpu, &s->kept, "smoothies kept", PNI_R8, count);
  if (result == PN_OK) result = grow_table(gpu, &s->list, "smoothies list", PNI_R32UI, count);
  if (result == PN_OK) result = pni_texture_shape(gpu, &s->total, "smoothies total", PNI_RGBA32UI, 1, 1, 0, 1);
  for (int i = 0; i < LEVELS && result == PN_OK; i++) {
    count = summed(count);
    result = grow_table(gpu, &s->sums[i], "smoothies sums", PNI_R32F, count);
  }
  return result;
}

static void set_mode(const drawing *d, int tile) {
  const pni_job *job = d->job;
  pni_set_ints(job->gpu, "pn_mode", tile, job->values[GEOMETRY] > 0.5, job->values[REMAP] > 0.5, 0);
  pni_set_floats(job->gpu, "pn_width", (const float[4]){(float)job->values[WIDTH]});
}

static pn_result keep_seen(const drawing *d, const pni_mesh_edges *e) {
  pni_gpu *gpu = d->job->gpu;
  pn_result result =
      pni_edge_table_begin(gpu, "smoothies kept", "techniques/smoothies/keep.frag.glsl", "", &d->state->kept, e->count);
  if (result != PN_OK) return result;
  pni_silhouettes_set(gpu, e, d->job->frame->projection, d->cut);
  set_mode(d, 0);
  pni_set_texture(gpu, "pn_maps", &d->job->maps->depth);
  pni_draw_screen(gpu);
  return PN_OK;
}

static pn_result add_level(pni_gpu *gpu, const pni_texture *from, const pni_texture *to, size_t entries) {
  pn_result result =
      pni_edge_table_begin(gpu, "smoothies sums", "techniques/smoothies/sum.frag.glsl", "", to, summed(entries));
  if (result != PN_OK) return result;
  pni_set_ints(gpu, "pn_count", (int)entries, 0, 0, 0);
  pni_set_texture(gpu, "pn_below", from);
  pni_draw_screen(gpu);
  return PN_OK;
}

static pn_result add_sums(const drawing *d, const pni_mesh_edges *e) {
  pni_gpu *gpu = d->job->gpu;
  smoothies *s = d->state;
  size_t count = e->count;
  pn_result result = PN_OK;
  for (int i = 0; i < LEVELS && result == PN_OK; i++) {
    result = add_level(gpu, i ? &s->sums[i - 1] : &s->kept, &s->sums[i], count);
    count = summed(count);
  }
  if (result == PN_OK)
    result = pni_edge_table_begin(gpu, "smoothies total", "techniques/smoothies/count.frag.glsl", "", &s->total, 1);
  if (result != PN_OK) return result;
  pni_set_ints(gpu, "pn_count", (int)count, 0, 0, 0);
  pni_set_texture(gpu, "pn_below", &s->sums[LEVELS - 1]);
  pni_draw_screen(gpu);
  return pni_counts_take(gpu, &s->total, &s->arguments);
}

static pn_result make_list(const drawing *d, const pni_mesh_edges *e) {
  pni_gpu *gpu = d->job->gpu;
  const smoothies *s = d->state;
  pn_result result =
      pni_edge_table_begin(gpu, "smoothies list", "techniques/smoothies/list.frag.glsl", "", &s->list, e->count);
  if (result != PN_OK) return result;
  pni_set_ints(gpu, "pn_count", (int)summed(summed(summed(e->count))), 0, 0, 0);
  pni_set_texture(gpu, "pn_kept", &s->kept);
  pni_set_texture(gpu, "pn_sums_low", &s->sums[0]);
  pni_set_texture(gpu, "pn_sums_middle", &s->sums[1]);
  pni_set_texture(gpu, "pn_sums_high", &s->sums[2]);
  pni_set_texture(gpu, "pn_total", &s->total);
  pni_draw_screen(gpu);
  return PN_OK;
}

/* ---- drawing them ------------------------------------------------------------------------------------------------ */

/* What alpha is remapped by. */
static void set_receivers(const pni_job *job) {
  const pni_fit_result *fit = &job->maps->fit;
  const double *g = fit->ground;
  pni_set_texture(job->gpu, "pn_maps", &job->maps->depth);
  pni_set_floats(job->gpu, "pn_ground", (const float[4]){(float)g[0], (float)g[1], (float)g[2], fit->has_ground});
}

/* Smoothies behind the nearest caster have nothing left to darken. Where alpha is remapped the shader reads the map and
 * sees to that itself. */
static pn_result draw_tile(const drawing *d, const pni_mesh_edges *e, int tile) {
  pni_gpu *gpu = d->job->gpu;
  const smoothies *s = d->state;
  bool alpha = keeps_alpha(d->job->values);
  pni_pass pass = {
      .name = "smoothies",
      .program = {"techniques/smoothies/smoothie.vert.glsl",
                  alpha ? "techniques/smoothies/alpha.frag.glsl" : "techniques/smoothies/smoothie.frag.glsl", NULL,
                  pni_edge_defines},
      .color = {pni_image_of(&s->image, 0, tile)},
      .depth_clamp = true,
      .width = s->image.width,
      .height = s->image.height,
      .blend = PNI_BLEND_MIN};
  if (!alpha || d->job->values[REMAP] < 0.5) {
    pass.depth = pni_image_of(&d->job->maps->depth, 0, tile);
    pass.depth_use = PNI_DEPTH_TEST;
  }
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  pni_silhouettes_set(gpu, e, d->job->frame->projection, d->cut);
  set_mode(d, tile);
  pni_set_texture(gpu, "pn_list", &s->list);
  pni_set_texture(gpu, "pn_total", &s->total);
  if (alpha && !pass.depth.texture) set_receivers(d->job);
  pni_draw_counted(gpu, &s->arguments, 0, (int)(12 * e->count));
  return PN_OK;
}

static pn_result draw_mesh(void *user, pni_mesh_data *mesh, const pni_matrix *scene_from_object) {
  const drawing *d = user;
  const pni_job *job = d->job;
  pni_mesh_edges *edges;
  pni_matrix light_from_object = pni_matrix_multiply(&d->light_from_scene, scene_from_object);
  if (pni_mesh_beyond(mesh, &light_from_object, d->farthest)) return PN_OK;
  pn_result result = pni_mesh_edges_get(job->gpu, mesh, &edges);
  if (result != PN_OK || !edges) return result;
  pni_matrix light_from_vertex = pni_from_vertex(mesh, &light_from_object);
  result = pni_silhouettes_draw(job->gpu, edges, &light_from_vertex, job->frame->projection, d->cut);
  if (result == PN_OK) result = shape_tables(job->gpu, d->state, edges->count);
  if (result == PN_OK) result = keep_seen(d, edges);
  if (result == PN_OK) result = add_sums(d, edges);
  if (result == PN_OK) result = make_list(d, edges);
  for (int tile = 0; tile < job->maps->fit.tiles && result == PN_OK; tile++) result = draw_tile(d, edges, tile);
  return result;
}

static pn_result clear(const pni_job *job, pni_texture *to) {
  static const float nothing[4] = {PNI_EVERYTHING, PNI_EVERYTHING, PNI_EVERYTHING, PNI_EVERYTHING};
  const pni_texture *depth = &job->maps->depth;
  int tiles = job->maps->fit.tiles;
  pni_format format = keeps_alpha(job->values) ? PNI_RG32F : PNI_RGBA32F;
  pn_result result = pni_texture_shape(job->gpu, to, "smoothies", format, depth->width, depth->height, tiles, 1);
  for (int tile = 0; tile < tiles && result == PN_OK; tile++) {
    pni_pass pass = {.name = "smoothies cleared",
                     .color = {pni_image_of(to, 0, tile)},
                     .clear = nothing,
                     .width = to->width,
                     .height = to->height};
    result = pni_pass_begin(job->gpu, &pass);
  }
  return result;
}

static void tell(pni_gpu *gpu, smoothies *s, const pni_without_edges *others) {
  if (s->told || (!others->callbacks && !others->holes)) return;
  s->told = true;
  pni_note(gpu, PN_LOG_WARNING, PN_MESSAGE_CASTER_MESHES,
           "soft edges need opaque meshes: %d draw callbacks and %d alpha-textured meshes cast hard shadows",
           others->callbacks, others->holes);
}

/* The light's range, or where the map's depth ends. */
static double farthest_caster(const pni_job *job) {
  double w_far = job->maps->fit.w_far, range = job->desc->range;
  if (job->frame->projection == PNI_PARALLEL) return -w_far;
  double end = w_far > 0 ? 1 / w_far : INFINITY;
  return range > 0 && range < end ? range : end;
}

static pn_result update(const pni_job *job) {
  drawing d = {.job = job,
               .state = job->light_state,
               .light_from_scene = pni_light_from_scene(job->frame),
               .farthest = farthest_caster(job),
               .cut = job->frame->projection == PNI_PARALLEL ? 0 : (float)(1 / job->maps->fit.w_near)};
  pni_without_edges others = {0};
  pn_result result = clear(job, &d.state->image);
  if (result == PN_OK) result = pni_casters_each_mesh(job->casters, job->groups, draw_mesh, &d, &others);
  if (result == PN_OK) tell(job->gpu, d.state, &others);
  return result;
}

/* ---- the class --------------------------------------------------------------------------------------------------- */

const pni_technique_class pni_technique_smoothies = {
    .table = {.name = "smoothies",
              .title = "smoothies",
              .help = "a hard shadow with its edge softened outwards, from the casters' silhouettes",
              .parameters = parameters,
              .parameter_count = COUNT,
              .needs_meshes = 1,
              .forward = 1,
              .self_shadows = 1},
    .want = want,
    .preset = preset,
    .draw = pni_gather,
    .gathering = {.shader = "techniques/smoothies/smoothies.glsl", .beside = beside},
    .update = update,
    .stage = "smoothies",
    .light_kind = {.bytes = sizeof(smoothies), .release = release, .image = image},
};
