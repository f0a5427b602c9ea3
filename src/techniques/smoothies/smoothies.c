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
    [GEOMETRY] = {"geometry", "", "rectangles along edges and rounded corners, or sheets and cones shaped by the light",
                  "Chan and Durand 2003; Haines 2001, Wyman and Hansen 2003", PN_CHOICE, 0, 1, 0, geometries},
    [WIDTH] = {"width", "map units", "how far smoothies reach: by the light's real size, or the same everywhere",
               "Chan and Durand 2003", PN_FLOAT, 0, 100, 0, width_words},
    [FILTER] = {"filter", "", "looks up 2 x 2 texels and weighs the results", "Chan and Durand 2003", PN_BOOL, 0, 1, 1,
                NULL},
};

static void preset(int choice, double *values) {
  values[PRESET] = choice;
  values[GEOMETRY] = choice == 2;
  values[WIDTH] = 0;
  values[FILTER] = choice != 0;
}

static void want(const double *values, pn_maps_want *out) {
  *out = (pn_maps_want){
      .near_layers = 1, .range = {PN_RANGE_OWN, false}, .reach = true, .reach_width = values[WIDTH]};
}

/* ---- drawing the smoothies --------------------------------------------------------------------------------------- */

static pn_result smoothie_program(pn_gpu *gpu, const pn_program **out) {
  pn_program_key key = {"techniques/smoothies/smoothie.vert.glsl", "techniques/smoothies/smoothie.frag.glsl", NULL, ""};
  return pn_program_get(gpu, &key, out);
}

typedef struct {
  const pn_build_request *request;
  pn_matrix light_from_scene;
  float cut; /* nearer than the nearest caster's plane nothing is drawn */
} drawing;

static pn_result draw_tile(const drawing *d, const pn_mesh_edges *edges, int tile) {
  const pn_build_request *r = d->request;
  const pn_texture *to = &r->maps->range;
  const pn_program *program;
  pn_result result = smoothie_program(r->gpu, &program);
  pn_pass pass = {
      .color = {{to->id, to->target, 0, tile}}, .width = to->width, .height = to->height, .blend = PN_BLEND_MIN};
  if (result == PN_OK) result = pn_screen_begin(r->gpu, &pass, program);
  if (result != PN_OK) return result;
  pn_silhouettes_bind(r->gpu, program, edges, edges->count, r->frame->sun, d->cut);
  GLint mode[4] = {tile, r->values[GEOMETRY] > 0.5};
  GLfloat width[4] = {(float)r->values[WIDTH]};
  GL(r->gpu, Uniform4iv)(pn_uniform(program, "pn_mode"), 1, mode);
  GL(r->gpu, Uniform4fv)(pn_uniform(program, "pn_width"), 1, width);
  pn_bind_texture(r->gpu, PN_UNIT_MAPS, GL_TEXTURE_2D_ARRAY, r->maps->depth.id, false);
  GL(r->gpu, BindVertexArray)(r->gpu->vertex_array);
  GL(r->gpu, DrawArrays)(GL_TRIANGLES, 0, (GLsizei)(3 * edges->count));
  return PN_OK;
}

static pn_result draw_mesh(void *user, pn_mesh_data *mesh, const pn_matrix *scene_from_object) {
  const drawing *d = user;
  const pn_build_request *r = d->request;
  pn_mesh_edges *edges;
  pn_result result = pn_mesh_edges_get(r->gpu, mesh, &edges);
  if (result != PN_OK || !edges) return result;
  pn_matrix light_from_object = pn_matrix_multiply(&d->light_from_scene, scene_from_object);
  result = pn_silhouettes_draw(r->gpu, edges, &light_from_object, r->frame->sun, d->cut);
  for (int tile = 0; tile < r->maps->fit.tiles && result == PN_OK; tile++) result = draw_tile(d, edges, tile);
  return result;
}

static pn_result clear(const pn_build_request *r) {
  const pn_texture *depth = &r->maps->depth;
  int tiles = r->maps->fit.tiles;
  pn_texture *to = &r->maps->range;
  pn_result result = pn_texture_shape(r->gpu, to, GL_RGBA32F, depth->width, depth->height, tiles, 1);
  for (int tile = 0; tile < tiles && result == PN_OK; tile++) {
    static const GLfloat nothing[4] = {1e30f, 1e30f, 1e30f, 1e30f}; /* -PN_NOTHING of maps.glsl */
    pn_pass pass = {.color = {{to->id, to->target, 0, tile}}, .width = to->width, .height = to->height};
    result = pn_pass_begin(r->gpu, &pass);
    if (result == PN_OK) GL(r->gpu, ClearBufferfv)(GL_COLOR, 0, nothing);
  }
  return result;
}

static pn_result build(const pn_build_request *request) {
  drawing d = {.request = request,
               .light_from_scene = pn_light_from_scene(request->frame),
               .cut = request->frame->sun ? 0 : (float)(1 / request->maps->fit.w_near)};
  pn_result result = clear(request);
  return result == PN_OK ? pn_casters_each_mesh(request->casters, request->groups, draw_mesh, &d) : result;
}

/* ---- the class --------------------------------------------------------------------------------------------------- */

static const char *const shader = "techniques/smoothies/smoothies.glsl";

static pn_result prepare(pn_gpu *gpu, const double *values) {
  (void)values;
  const pn_program *program;
  pn_result result = smoothie_program(gpu, &program);
  if (result == PN_OK) result = pn_silhouettes_prepare(gpu);
  return result == PN_OK ? pn_gather_prepare(gpu, shader, "") : result;
}

const pn_technique_class pn_technique_smoothies = {
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
