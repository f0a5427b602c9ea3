/* Smoothies (Chan and Durand 2003): a hard shadow whose edge is softened outwards by primitives along the silhouettes.
 * docs/techniques/smoothies.md derives what the shaders compute. */
#include "techniques/technique.h"

#include <math.h>

#include "casters/silhouettes.h"
#include "search/gather.h"

enum { PRESET, GEOMETRY, WIDTH, FILTER, COUNT };

static const char *const presets[] = {"fast", "good", "exact", NULL};
static const char *const geometries[] = {"edges", "cones", NULL};
static const char *const width_words[] = {"light", NULL};

static const pn_parameter parameters[COUNT] = {
    [PRESET] = {"preset", "", "sets the others; what is named besides it goes over it", "docs/techniques/smoothies.md",
                PN_CHOICE, 0, 2, 1, presets},
    [GEOMETRY] = {"geometry", "", "rectangles along edges and rounded kept, or sheets and cones shaped by the light",
                  "Chan and Durand 2003; Haines 2001, Wyman and Hansen 2003", PN_CHOICE, 0, 1, 1, geometries},
    [WIDTH] = {"width", "map units", "how far smoothies reach: by the light's real size, or the same everywhere",
               "Chan and Durand 2003", PN_FLOAT, 0, 100, 0, width_words},
    [FILTER] = {"filter", "", "looks up 2 x 2 texels and weighs the results", "Chan and Durand 2003", PN_BOOL, 0, 1, 1,
                NULL},
};

static void preset(int choice, double *values) {
  values[PRESET] = choice;
  values[GEOMETRY] = 1;
  values[WIDTH] = 0;
  values[FILTER] = choice != 0;
}

static void want(const double *values, pni_maps_want *out) {
  *out = (pni_maps_want){
      .near_layers = 1, .range = {.structure = PNI_RANGE_OWN}, .reach = true, .reach_width = values[WIDTH]};
}

/* ---- programs ---------------------------------------------------------------------------------------------------- */

static pn_result smoothie_program(pni_gpu *gpu, const pni_program **out) {
  pni_program_key key = {"techniques/smoothies/smoothie.vert.glsl", "techniques/smoothies/smoothie.frag.glsl", NULL,
                         ""};
  return pni_program_get(gpu, &key, out);
}

typedef enum { KEEP_PASS, FIRST_SUM_PASS, SUM_PASS, COUNT_PASS, LIST_PASS, PASS_COUNT } table_pass;

static pn_result table_program(pni_gpu *gpu, table_pass pass, const pni_program **out) {
  static const struct {
    const char *fragment, *defines;
  } passes[PASS_COUNT] = {{"techniques/smoothies/keep.frag.glsl", ""},
                          {"techniques/smoothies/sum.frag.glsl", "PN_FIRST 1\n"},
                          {"techniques/smoothies/sum.frag.glsl", "PN_FIRST 0\n"},
                          {"techniques/smoothies/count.frag.glsl", ""},
                          {"techniques/smoothies/list.frag.glsl", ""}};
  pni_program_key key = {"shaders/screen.vert.glsl", passes[pass].fragment, NULL, passes[pass].defines};
  return pni_program_get(gpu, &key, out);
}

/* ---- the list of smoothies --------------------------------------------------------------------------------------- */

typedef struct {
  const pni_build_request *request;
  pni_matrix light_from_scene;
  float cut; /* nearer than the nearest caster's plane nothing is drawn */
} drawing;

enum { SUMMED = 64, LEVELS = 3 };

static size_t summed(size_t count) { return (count + SUMMED - 1) / SUMMED; }

static pn_result shape_tables(pni_gpu *gpu, pni_mesh_edges *e) {
  int rows = e->edges.height;
  size_t count = e->count;
  pn_result result = pni_texture_shape(gpu, &e->kept, GL_R8, PNI_EDGE_ROW, rows, 0, 1);
  if (result == PN_OK) result = pni_texture_shape(gpu, &e->list, GL_R32UI, PNI_EDGE_ROW, rows, 0, 1);
  if (result == PN_OK) result = pni_texture_shape(gpu, &e->total, GL_RGBA32UI, 1, 1, 0, 1);
  for (int i = 0; i < LEVELS && result == PN_OK; i++) {
    count = summed(count);
    result = pni_texture_shape(gpu, &e->sums[i], GL_R32F, PNI_EDGE_ROW, (int)((count - 1) / PNI_EDGE_ROW) + 1, 0, 1);
  }
  return result;
}

static void set_mode(const drawing *d, const pni_program *program, int tile) {
  const pni_build_request *r = d->request;
  GLint mode[4] = {tile, r->values[GEOMETRY] > 0.5};
  GLfloat width[4] = {(float)r->values[WIDTH]};
  GL(r->gpu, Uniform4iv)(pni_uniform(program, "pn_mode"), 1, mode);
  GL(r->gpu, Uniform4fv)(pni_uniform(program, "pn_width"), 1, width);
}

/* Begins a pass that writes entries of a table, and binds the edges; counts: pn_count. */
static pn_result begin_table(const drawing *d, const pni_mesh_edges *e, table_pass table, const pni_texture *to,
                             size_t entries, const GLint counts[4]) {
  pni_gpu *gpu = d->request->gpu;
  const pni_program *program;
  pn_result result = table_program(gpu, table, &program);
  pni_pass pass = {.color = {{to->id, GL_TEXTURE_2D, 0, 0}},
                   .width = entries < PNI_EDGE_ROW ? (int)entries : PNI_EDGE_ROW,
                   .height = (int)((entries - 1) / PNI_EDGE_ROW) + 1};
  if (result == PN_OK) result = pni_screen_begin(gpu, &pass, program);
  if (result != PN_OK) return result;
  pni_silhouettes_bind(gpu, program, e, e->count, d->request->frame->sun, d->cut);
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_count"), 1, counts);
  set_mode(d, program, 0);
  return PN_OK;
}

static void draw_table(pni_gpu *gpu, int unit, const pni_texture *from) {
  pni_bind_texture(gpu, unit, GL_TEXTURE_2D, from ? from->id : 0, false);
  pni_draw_screen(gpu);
}

static pn_result keep_seen(const drawing *d, const pni_mesh_edges *e) {
  pni_gpu *gpu = d->request->gpu;
  GLint counts[4] = {(GLint)e->count, d->request->frame->sun};
  pn_result result = begin_table(d, e, KEEP_PASS, &e->kept, e->count, counts);
  if (result != PN_OK) return result;
  pni_bind_texture(gpu, PNI_UNIT_MAPS, GL_TEXTURE_2D_ARRAY, d->request->maps->depth.id, false);
  draw_table(gpu, PNI_UNIT_ALPHA, NULL); /* no pass may have the image bound that it draws to */
  return PN_OK;
}

static pn_result add_sums(const drawing *d, pni_mesh_edges *e) {
  pni_gpu *gpu = d->request->gpu;
  size_t count = e->count;
  pn_result result = PN_OK;
  for (int i = 0; i < LEVELS && result == PN_OK; i++) {
    GLint counts[4] = {(GLint)count};
    count = summed(count);
    result = begin_table(d, e, i ? SUM_PASS : FIRST_SUM_PASS, &e->sums[i], count, counts);
    if (result == PN_OK) draw_table(gpu, PNI_UNIT_WORK, i ? &e->sums[i - 1] : NULL);
  }
  GLint counts[4] = {(GLint)count};
  if (result == PN_OK) result = begin_table(d, e, COUNT_PASS, &e->total, 1, counts);
  if (result != PN_OK) return result;
  draw_table(gpu, PNI_UNIT_WORK, &e->sums[LEVELS - 1]);
  return pni_counts_take(gpu, &e->total, &e->arguments);
}

static pn_result make_list(const drawing *d, const pni_mesh_edges *e) {
  pni_gpu *gpu = d->request->gpu;
  GLint counts[4] = {(GLint)e->count, d->request->frame->sun, (GLint)summed(summed(summed(e->count)))};
  pn_result result = begin_table(d, e, LIST_PASS, &e->list, e->count, counts);
  if (result != PN_OK) return result;
  pni_bind_texture(gpu, PNI_UNIT_WORK, GL_TEXTURE_2D, e->sums[0].id, false);
  pni_bind_texture(gpu, PNI_UNIT_PEEL, GL_TEXTURE_2D, e->sums[1].id, false);
  pni_bind_texture(gpu, PNI_UNIT_RANGE, GL_TEXTURE_2D, e->total.id, false);
  draw_table(gpu, PNI_UNIT_SEEN, &e->sums[2]);
  return PN_OK;
}

/* ---- drawing them ------------------------------------------------------------------------------------------------ */

static pni_attachment layer(const pni_texture *texture, int tile) {
  return (pni_attachment){texture->id, texture->target, 0, tile};
}

/* Smoothies behind the nearest caster have nothing left to darken. */
static pn_result draw_tile(const drawing *d, pni_mesh_edges *e, int tile) {
  const pni_build_request *r = d->request;
  const pni_texture *to = &r->maps->range;
  const pni_program *program;
  pn_result result = smoothie_program(r->gpu, &program);
  pni_pass pass = {.color = {layer(to, tile)},
                   .depth = layer(&r->maps->depth, tile),
                   .depth_use = PNI_DEPTH_TEST,
                   .depth_clamp = true,
                   .width = to->width,
                   .height = to->height,
                   .blend = PNI_BLEND_MIN};
  if (result == PN_OK) result = pni_screen_begin(r->gpu, &pass, program);
  if (result != PN_OK) return result;
  pni_silhouettes_bind(r->gpu, program, e, e->count, r->frame->sun, d->cut);
  set_mode(d, program, tile);
  pni_bind_texture(r->gpu, PNI_UNIT_MAPS, GL_TEXTURE_2D_ARRAY, 0, false);
  pni_bind_texture(r->gpu, PNI_UNIT_SEEN, GL_TEXTURE_2D, e->list.id, false);
  pni_bind_texture(r->gpu, PNI_UNIT_RANGE, GL_TEXTURE_2D, e->total.id, false);
  pni_draw_counted(r->gpu, &e->arguments, 0, (int)(12 * e->count));
  return PN_OK;
}

static pn_result draw_mesh(void *user, pni_mesh_data *mesh, const pni_matrix *scene_from_object) {
  const drawing *d = user;
  const pni_build_request *r = d->request;
  pni_mesh_edges *edges;
  pn_result result = pni_mesh_edges_get(r->gpu, mesh, &edges);
  if (result != PN_OK || !edges) return result;
  pni_matrix light_from_object = pni_matrix_multiply(&d->light_from_scene, scene_from_object);
  result = pni_silhouettes_draw(r->gpu, edges, &light_from_object, r->frame->sun, d->cut);
  if (result == PN_OK) result = shape_tables(r->gpu, edges);
  if (result == PN_OK) result = keep_seen(d, edges);
  if (result == PN_OK) result = add_sums(d, edges);
  if (result == PN_OK) result = make_list(d, edges);
  for (int tile = 0; tile < r->maps->fit.tiles && result == PN_OK; tile++) result = draw_tile(d, edges, tile);
  return result;
}

static pn_result clear(const pni_build_request *r) {
  const pni_texture *depth = &r->maps->depth;
  int tiles = r->maps->fit.tiles;
  pni_texture *to = &r->maps->range;
  pn_result result = pni_texture_shape(r->gpu, to, GL_RGBA32F, depth->width, depth->height, tiles, 1);
  for (int tile = 0; tile < tiles && result == PN_OK; tile++) {
    static const GLfloat nothing[4] = {1e30f, 1e30f, 1e30f, 1e30f}; /* -PN_NOTHING of maps.glsl */
    pni_pass pass = {.color = {layer(to, tile)}, .width = to->width, .height = to->height};
    result = pni_pass_begin(r->gpu, &pass);
    if (result == PN_OK) GL(r->gpu, ClearBufferfv)(GL_COLOR, 0, nothing);
  }
  return result;
}

static pn_result build(const pni_build_request *request) {
  drawing d = {.request = request,
               .light_from_scene = pni_light_from_scene(request->frame),
               .cut = request->frame->sun ? 0 : (float)(1 / request->maps->fit.w_near)};
  pn_result result = clear(request);
  return result == PN_OK ? pni_casters_each_mesh(request->casters, request->groups, draw_mesh, &d) : result;
}

/* ---- the class --------------------------------------------------------------------------------------------------- */

static const char *const shader = "techniques/smoothies/smoothies.glsl";

static pn_result prepare(pni_gpu *gpu, const double *values) {
  (void)values;
  const pni_program *program;
  pn_result result = smoothie_program(gpu, &program);
  for (int i = 0; i < PASS_COUNT && result == PN_OK; i++) result = table_program(gpu, (table_pass)i, &program);
  if (result == PN_OK) result = pni_silhouettes_prepare(gpu);
  return result == PN_OK ? pni_gather_prepare(gpu, shader, "") : result;
}

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
    .shader = shader,
    .build = build,
    .stage = "smoothies",
    .prepare = prepare,
};
