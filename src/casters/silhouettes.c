#include "casters/silhouettes.h"

#include <stdio.h>

/* ---- in C -------------------------------------------------------------------------------------------------------- */

void pn_silhouette_point(const float m[16], const float p[3], float out[3]) {
  for (int i = 0; i < 3; i++) out[i] = ((m[i] * p[0] + m[4 + i] * p[1]) + m[8 + i] * p[2]) + m[12 + i];
}

static void subtract(const float a[3], const float b[3], float out[3]) {
  for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

/* The operations of silhouette.frag.glsl, in their order. */
static float plane_side(const float p[3], const float e[3], const float q[3], const float d[3]) {
  float f[3];
  subtract(q, p, f);
  float x = e[1] * f[2] - e[2] * f[1], y = e[2] * f[0] - e[0] * f[2], z = e[0] * f[1] - e[1] * f[0];
  return (x * d[0] + y * d[1]) + z * d[2];
}

pn_side pn_silhouette_side(const pn_edge *edge, const float *points, bool sun) {
  static const float towards_sun[3] = {0, 0, 1};
  const float *p = points + 3 * (size_t)edge->ends[0];
  float e[3];
  subtract(points + 3 * (size_t)edge->ends[1], p, e);
  float a = plane_side(p, e, points + 3 * (size_t)edge->opposite[0], sun ? towards_sun : p);
  float b = plane_side(p, e, points + 3 * (size_t)edge->opposite[1], sun ? towards_sun : p);
  if (a >= 0 && b >= 0 && (a > 0 || b > 0)) return PN_SIDE_LEFT;
  return a <= 0 && b <= 0 && (a < 0 || b < 0) ? PN_SIDE_RIGHT : PN_SIDE_NONE;
}

/* ---- on the GPU -------------------------------------------------------------------------------------------------- */

static pn_result edge_program(pn_gpu *gpu, const char *fragment, const pn_program **out) {
  pn_program_key key = {"shaders/screen.vert.glsl", fragment, NULL, ""};
  return pn_program_get(gpu, &key, out);
}

static const char *const points_shader = "casters/points.frag.glsl", *const sides_shader =
                                                                         "casters/silhouette.frag.glsl";

pn_result pn_silhouettes_prepare(pn_gpu *gpu) {
  const pn_program *program;
  pn_result result = edge_program(gpu, points_shader, &program);
  return result == PN_OK ? edge_program(gpu, sides_shader, &program) : result;
}

void pn_silhouettes_bind(pn_gpu *gpu, const pn_program *program, const pn_mesh_edges *e, size_t count, bool sun,
                         float cut) {
  GLint counts[4] = {(GLint)count, sun};
  GLfloat cuts[4] = {cut};
  GL(gpu, Uniform4iv)(pn_uniform(program, "pn_count"), 1, counts);
  GL(gpu, Uniform4fv)(pn_uniform(program, "pn_cut"), 1, cuts);
  pn_bind_texture(gpu, PN_UNIT_DEPTH, GL_TEXTURE_2D, e->edges.id, false);
  pn_bind_texture(gpu, PN_UNIT_NORMAL, GL_TEXTURE_2D, e->points.id, false);
  pn_bind_texture(gpu, PN_UNIT_MASK, GL_TEXTURE_2D, e->sides.id, false);
  pn_bind_texture(gpu, PN_UNIT_WORK, GL_TEXTURE_2D, e->rings.id, false);
  pn_bind_texture(gpu, PN_UNIT_PEEL, GL_TEXTURE_2D, e->entries.id, false);
  pn_bind_texture(gpu, PN_UNIT_ALPHA, GL_TEXTURE_2D, e->kept.id, false);
}

/* A pass over count entries of a table, as wide as they need. */
static pn_result begin(pn_gpu *gpu, const char *shader, const pn_texture *to, size_t count, const pn_program **out) {
  pn_result result = edge_program(gpu, shader, out);
  int width = count < PN_EDGE_ROW ? (int)count : PN_EDGE_ROW;
  pn_pass pass = {.color = {{to->id, GL_TEXTURE_2D, 0, 0}}, .width = width, .height = to->height};
  return result == PN_OK ? pn_screen_begin(gpu, &pass, *out) : result;
}

static pn_result draw_points(pn_gpu *gpu, const pn_mesh_edges *e, const pn_matrix *light_from_object) {
  const pn_program *program;
  pn_result result = begin(gpu, points_shader, &e->points, e->vertices, &program);
  if (result != PN_OK) return result;
  float matrix[16];
  pn_matrix_to_floats(light_from_object, matrix);
  GLint counts[4] = {(GLint)e->vertices, e->stride};
  GL(gpu, UniformMatrix4fv)(pn_uniform(program, "pn_light_from_object"), 1, GL_FALSE, matrix);
  GL(gpu, Uniform4iv)(pn_uniform(program, "pn_count"), 1, counts);
  pn_bind_texture(gpu, PN_UNIT_WORK, GL_TEXTURE_2D, e->positions.id, false);
  pn_draw_screen(gpu);
  return PN_OK;
}

/* No pass may have the image bound that it draws to. */
static void unbind(pn_gpu *gpu, int unit) { pn_bind_texture(gpu, unit, GL_TEXTURE_2D, 0, false); }

pn_result pn_silhouettes_draw(pn_gpu *gpu, pn_mesh_edges *e, const pn_matrix *light_from_object, bool sun, float cut) {
  const pn_program *program;
  unbind(gpu, PN_UNIT_NORMAL);
  pn_result result = draw_points(gpu, e, light_from_object);
  if (result == PN_OK) result = begin(gpu, sides_shader, &e->sides, e->count, &program);
  if (result != PN_OK) return result;
  pn_silhouettes_bind(gpu, program, e, e->count, sun, cut);
  unbind(gpu, PN_UNIT_MASK);
  pn_draw_screen(gpu);
  return PN_OK;
}

/* ---- what there is to draw --------------------------------------------------------------------------------------- */

static void tell(pn_casters *casters, int callbacks, int holes) {
  if (casters->told_meshes || (!callbacks && !holes)) return;
  casters->told_meshes = true;
  pn_note(&casters->object.context->gpu, PN_LOG_WARNING, PN_MESSAGE_CASTER_MESHES,
          "soft edges need opaque meshes: %d draw callbacks and %d alpha-textured meshes cast hard shadows", callbacks,
          holes);
}

pn_result pn_casters_each_mesh(pn_casters *casters, uint32_t groups, pn_mesh_visitor visit, void *user) {
  int callbacks = 0, holes = 0;
  pn_result result = PN_OK;
  for (int group = 0; group < PN_GROUP_COUNT; group++)
    callbacks += casters->callbacks[group].draw && (groups >> group & 1);
  for (int i = 0; i < casters->instance_count && result == PN_OK; i++) {
    const pn_instance_data *instance = &casters->instances[i];
    pn_mesh_data *mesh = &casters->meshes[instance->mesh];
    if (!(groups >> instance->group & 1)) continue;
    if (mesh->alpha_texture) holes++;
    else result = visit(user, mesh, &instance->scene_from_object);
  }
  if (result == PN_OK) tell(casters, callbacks, holes);
  return result;
}
