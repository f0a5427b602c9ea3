/* Drawing casters into a depth pass: the library's own meshes, then the host's callbacks. */
#include "casters/casters.h"

#include <stdio.h>

static pn_result caster_program(pni_gpu *gpu, bool alpha, bool peel, const pni_program **out) {
  char defines[64];
  snprintf(defines, sizeof defines, "PN_ALPHA %d\nPN_PEEL %d\n", alpha, peel);
  pni_program_key key = {"casters/caster.vert.glsl", "casters/caster.frag.glsl", NULL, defines};
  return pni_program_get(gpu, &key, out);
}

pn_result pni_casters_prepare(pni_gpu *gpu, bool peel) {
  const pni_program *program;
  pn_result result = caster_program(gpu, false, peel, &program);
  return result == PN_OK ? caster_program(gpu, true, peel, &program) : result;
}

/* Whether all eight corners of the box lie outside the same plane of the map's frustum. The near plane does not
 * count: nearer casters are clamped to it. */
static bool outside(const pni_box *box, const pni_matrix *clip_from_object) {
  int out[4] = {0};
  for (int i = 0; i < 8; i++) {
    double p[4] = {i & 1 ? box->max[0] : box->min[0], i & 2 ? box->max[1] : box->min[1],
                   i & 4 ? box->max[2] : box->min[2], 1},
           c[4];
    pni_matrix_apply(clip_from_object, p, c);
    out[0] += c[0] < -c[3];
    out[1] += c[0] > c[3];
    out[2] += c[1] < -c[3];
    out[3] += c[1] > c[3];
  }
  return out[0] == 8 || out[1] == 8 || out[2] == 8 || out[3] == 8;
}

/* Whether what is drawn from at on, up to where the next box begins, may reach into the frustum. Where boxes do not
 * tell triangles apart, that is all of them. */
static bool run_inside(const pni_mesh_data *mesh, const pni_matrix *cull_from_object, size_t at) {
  size_t first = 0, end = (size_t)mesh->box_count;
  if (mesh->box_triangles) {
    first = at / (3 * mesh->box_triangles);
    end = first + 1;
  }
  for (size_t b = first; b < end; b++)
    if (!outside(&mesh->boxes[b], cull_from_object)) return true;
  return false;
}

/* From *at on, the next vertices or indices that may reach into the frustum: moves *at there, returns how many, 0 at
 * the end. */
static size_t next_run(const pni_mesh_data *mesh, const pni_matrix *cull_from_object, size_t *at) {
  size_t step = mesh->box_triangles ? 3 * mesh->box_triangles : mesh->draw_count;
  while (*at < mesh->draw_count && !run_inside(mesh, cull_from_object, *at)) *at += step;
  if (*at >= mesh->draw_count) return 0;
  size_t end = *at + step;
  while (end < mesh->draw_count && run_inside(mesh, cull_from_object, end)) end += step;
  return (end < mesh->draw_count ? end : mesh->draw_count) - *at;
}

static void draw_run(pni_gpu *gpu, const pni_mesh_data *mesh, size_t first, size_t count) {
  if (!mesh->index_bytes) {
    GL(gpu, DrawArrays)(GL_TRIANGLES, (GLint)first, (GLsizei)count);
    return;
  }
  size_t offset = (mesh->buffers[1] ? 0 : mesh->indices.offset) + first * (size_t)mesh->index_bytes;
  GL(gpu, DrawElements)
  (GL_TRIANGLES, (GLsizei)count, mesh->index_bytes == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT,
   (const void *)(uintptr_t)offset);
}

typedef struct {
  pni_matrix clip_from_object, cull_from_object;
} mesh_matrices;

static pn_result draw_mesh(pni_gpu *gpu, const pni_mesh_data *mesh, const mesh_matrices *matrices, bool peel) {
  size_t first = 0, count = next_run(mesh, &matrices->cull_from_object, &first);
  if (count == 0) return PN_OK;
  const pni_program *program;
  bool alpha = mesh->alpha_texture != 0;
  pn_result result = caster_program(gpu, alpha, peel, &program);
  if (result != PN_OK) return result;
  GL(gpu, UseProgram)(program->id);
  float matrix[16];
  pni_matrix_to_floats(&matrices->clip_from_object, matrix);
  GL(gpu, UniformMatrix4fv)(pni_uniform(program, "pn_clip_from_object"), 1, GL_FALSE, matrix);
  if (alpha) {
    GLint channel[4] = {mesh->alpha_channel};
    GLfloat cutoff[4] = {mesh->alpha_cutoff};
    GL(gpu, Uniform4iv)(pni_uniform(program, "pn_alpha_channel"), 1, channel);
    GL(gpu, Uniform4fv)(pni_uniform(program, "pn_alpha_cutoff"), 1, cutoff);
    pni_bind_texture(gpu, PNI_UNIT_ALPHA, GL_TEXTURE_2D, mesh->alpha_texture, true);
  }
  GL(gpu, FrontFace)(mesh->clockwise ? GL_CW : GL_CCW);
  GL(gpu, BindVertexArray)(mesh->vertex_array);
  for (; count > 0; count = next_run(mesh, &matrices->cull_from_object, &first)) {
    draw_run(gpu, mesh, first, count);
    first += count;
  }
  return PN_OK;
}

/* Mirroring turns winding round. */
static bool mirrors(const pni_matrix *a) {
  const double *m = a->m;
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) +
             m[8] * (m[1] * m[6] - m[2] * m[5]) <
         0;
}

static pn_result draw_meshes(pn_casters *casters, const pni_caster_draw *draw) {
  pni_gpu *gpu = &casters->object.context->gpu;
  if (draw->peel) pni_bind_texture(gpu, PNI_UNIT_PEEL, GL_TEXTURE_2D, draw->peel, false);
  for (int i = 0; i < casters->instance_count; i++) {
    const pni_instance_data *instance = &casters->instances[i];
    if (!(draw->groups >> instance->group & 1)) continue;
    pni_mesh_data mesh = casters->meshes[instance->mesh];
    mesh_matrices matrices = {pni_matrix_multiply(&draw->clip_from_scene, &instance->scene_from_object),
                              pni_matrix_multiply(&draw->cull_from_scene, &instance->scene_from_object)};
    if (mirrors(&instance->scene_from_object)) mesh.clockwise = !mesh.clockwise;
    pn_result result = draw_mesh(gpu, &mesh, &matrices, draw->peel != 0);
    if (result != PN_OK) return result;
  }
  return PN_OK;
}

/* Sides and far plane of the map's frustum, pointing inwards: rows of the clip matrix. */
enum { PLANES = 5 };
static void frustum_planes(const pni_matrix *clip, float planes[PLANES][4]) {
  static const struct {
    int row;
    double sign;
  } sides[PLANES] = {{0, 1}, {0, -1}, {1, 1}, {1, -1}, {2, -1}};
  for (int i = 0; i < PLANES; i++)
    for (int c = 0; c < 4; c++)
      planes[i][c] = (float)(clip->m[4 * c + 3] + sides[i].sign * clip->m[4 * c + sides[i].row]);
}

static void call_host(pn_casters *casters, const pni_caster_draw *draw, int group) {
  pni_gpu *gpu = &casters->object.context->gpu;
  float matrix[16], planes[PLANES][4];
  pni_matrix_to_floats(&draw->clip_from_scene, matrix);
  frustum_planes(&draw->cull_from_scene, planes);
  pn_caster_pass pass = {matrix,        planes[0],   PLANES,      draw->faces, draw->peel,
                         PNI_UNIT_PEEL, draw->layer, draw->width, draw->height};
  if (draw->peel) pni_bind_texture(gpu, PNI_UNIT_PEEL, GL_TEXTURE_2D, draw->peel, false);
  GL(gpu, FrontFace)(GL_CCW);
  casters->callbacks[group].draw(casters->callbacks[group].user, &pass);
}

pn_result pni_casters_draw_pass(pn_casters *casters, const pni_caster_draw *draw) {
  pn_result result = draw_meshes(casters, draw);
  for (int group = 0; group < PN_GROUP_COUNT && result == PN_OK; group++)
    if (casters->callbacks[group].draw && (draw->groups >> group & 1)) call_host(casters, draw, group);
  return result;
}
