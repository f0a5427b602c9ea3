#include "casters/silhouettes.h"

#include <stdio.h>

/* ---- in C -------------------------------------------------------------------------------------------------------- */

void pni_silhouette_point(const float m[16], const float p[3], float out[3]) {
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

pni_side pni_silhouette_side(const pni_edge *edge, const float *points, bool sun) {
  static const float towards_sun[3] = {0, 0, 1};
  const float *p = points + 3 * (size_t)edge->ends[0];
  float e[3];
  subtract(points + 3 * (size_t)edge->ends[1], p, e);
  float a = plane_side(p, e, points + 3 * (size_t)edge->opposite[0], sun ? towards_sun : p);
  float b = plane_side(p, e, points + 3 * (size_t)edge->opposite[1], sun ? towards_sun : p);
  if (a >= 0 && b >= 0 && (a > 0 || b > 0)) return PNI_SIDE_LEFT;
  return a <= 0 && b <= 0 && (a < 0 || b < 0) ? PNI_SIDE_RIGHT : PNI_SIDE_NONE;
}

/* ---- on the GPU -------------------------------------------------------------------------------------------------- */

static pn_result edge_program(pni_gpu *gpu, const char *fragment, const pni_program **out) {
  pni_program_key key = {"shaders/screen.vert.glsl", fragment, NULL, ""};
  return pni_program_get(gpu, &key, out);
}

static const char *const points_shader = "casters/points.frag.glsl", *const sides_shader =
                                                                         "casters/silhouette.frag.glsl";

pn_result pni_silhouettes_prepare(pni_gpu *gpu) {
  const pni_program *program;
  pn_result result = edge_program(gpu, points_shader, &program);
  return result == PN_OK ? edge_program(gpu, sides_shader, &program) : result;
}

void pni_silhouettes_bind(pni_gpu *gpu, const pni_program *program, const pni_mesh_edges *e, size_t count, bool sun,
                          float cut) {
  GLint counts[4] = {(GLint)count, sun};
  GLfloat cuts[4] = {cut};
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_count"), 1, counts);
  GL(gpu, Uniform4fv)(pni_uniform(program, "pn_cut"), 1, cuts);
  pni_bind_texture(gpu, PNI_UNIT_DEPTH, GL_TEXTURE_2D, e->edges.id, false);
  pni_bind_texture(gpu, PNI_UNIT_NORMAL, GL_TEXTURE_2D, e->points.id, false);
  pni_bind_texture(gpu, PNI_UNIT_MASK, GL_TEXTURE_2D, e->sides.id, false);
  pni_bind_texture(gpu, PNI_UNIT_WORK, GL_TEXTURE_2D, e->rings.id, false);
  pni_bind_texture(gpu, PNI_UNIT_PEEL, GL_TEXTURE_2D, e->entries.id, false);
  pni_bind_texture(gpu, PNI_UNIT_ALPHA, GL_TEXTURE_2D, e->kept.id, false);
}

/* A pass over count entries of a table, as wide as they need. */
static pn_result begin(pni_gpu *gpu, const char *shader, const pni_texture *to, size_t count, const pni_program **out) {
  pn_result result = edge_program(gpu, shader, out);
  int width = count < PNI_EDGE_ROW ? (int)count : PNI_EDGE_ROW;
  pni_pass pass = {.color = {{to->id, GL_TEXTURE_2D, 0, 0}}, .width = width, .height = to->height};
  return result == PN_OK ? pni_screen_begin(gpu, &pass, *out) : result;
}

static pn_result draw_points(pni_gpu *gpu, const pni_mesh_edges *e, const pni_matrix *light_from_object) {
  const pni_program *program;
  pn_result result = begin(gpu, points_shader, &e->points, e->vertices, &program);
  if (result != PN_OK) return result;
  float matrix[16];
  pni_matrix_to_floats(light_from_object, matrix);
  GLint counts[4] = {(GLint)e->vertices, e->stride};
  GL(gpu, UniformMatrix4fv)(pni_uniform(program, "pn_light_from_object"), 1, GL_FALSE, matrix);
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_count"), 1, counts);
  pni_bind_texture(gpu, PNI_UNIT_WORK, GL_TEXTURE_2D, e->positions.id, false);
  pni_draw_screen(gpu);
  return PN_OK;
}

/* No pass may have the image bound that it draws to. */
static void unbind(pni_gpu *gpu, int unit) { pni_bind_texture(gpu, unit, GL_TEXTURE_2D, 0, false); }

pn_result pni_silhouettes_draw(pni_gpu *gpu, pni_mesh_edges *e, const pni_matrix *light_from_object, bool sun,
                               float cut) {
  const pni_program *program;
  unbind(gpu, PNI_UNIT_NORMAL);
  pn_result result = draw_points(gpu, e, light_from_object);
  if (result == PN_OK) result = begin(gpu, sides_shader, &e->sides, e->count, &program);
  if (result != PN_OK) return result;
  pni_silhouettes_bind(gpu, program, e, e->count, sun, cut);
  unbind(gpu, PNI_UNIT_MASK);
  pni_draw_screen(gpu);
  return PN_OK;
}

/* ---- what there is to draw --------------------------------------------------------------------------------------- */

static void tell(pn_casters *casters, int callbacks, int holes) {
  if (casters->told_meshes || (!callbacks && !holes)) return;
  casters->told_meshes = true;
  pni_note(&casters->object.context->gpu, PN_LOG_WARNING, PN_MESSAGE_CASTER_MESHES,
           "soft edges need opaque meshes: %d draw callbacks and %d alpha-textured meshes cast hard shadows", callbacks,
           holes);
}

pn_result pni_casters_each_mesh(pn_casters *casters, uint32_t groups, pni_mesh_visitor visit, void *user) {
  int callbacks = 0, holes = 0;
  pn_result result = PN_OK;
  for (int group = 0; group < PN_GROUP_COUNT; group++)
    callbacks += casters->callbacks[group].draw && (groups >> group & 1);
  for (int i = 0; i < casters->instance_count && result == PN_OK; i++) {
    const pni_instance_data *instance = &casters->instances[i];
    pni_mesh_data *mesh = &casters->meshes[instance->mesh];
    if (!(groups >> instance->group & 1)) continue;
    if (mesh->alpha_texture) holes++;
    else result = visit(user, mesh, &instance->scene_from_object);
  }
  if (result == PN_OK) tell(casters, callbacks, holes);
  return result;
}
