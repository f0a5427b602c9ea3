#include "silhouettes/silhouettes.h"

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

pni_side pni_silhouette_side(const pni_edge *edge, const float *points, pni_projection projection) {
  bool sun = projection == PNI_PARALLEL;
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

pn_result pni_edge_table_begin(pni_gpu *gpu, const char *name, const char *fragment, const char *defines,
                               const pni_texture *to, size_t count) {
  char all[128];
  snprintf(all, sizeof all, "%s%s", pni_edge_defines, defines);
  pni_pass pass = {.name = name,
                   .program = {.fragment = fragment, .defines = all},
                   .color = {pni_image_of(to, 0, 0)},
                   .width = count < PNI_EDGE_ROW ? (int)count : PNI_EDGE_ROW,
                   .height = (int)((count - 1) / PNI_EDGE_ROW) + 1};
  return pni_pass_begin(gpu, &pass);
}

void pni_silhouettes_set(pni_gpu *gpu, const pni_mesh_edges *e, pni_projection projection, float cut) {
  pni_set_ints(gpu, "pn_mesh", (int)e->count, projection == PNI_PARALLEL, e->ring_most, 0);
  pni_set_floats(gpu, "pn_cut", (const float[4]){cut});
  pni_set_texture(gpu, "pn_edges", &e->edges);
  pni_set_texture(gpu, "pn_points", &e->points);
  pni_set_texture(gpu, "pn_sides", &e->sides);
  pni_set_texture(gpu, "pn_rings", &e->rings);
  pni_set_texture(gpu, "pn_entries", &e->entries);
}

static pn_result draw_points(pni_gpu *gpu, const pni_mesh_edges *e, const pni_matrix *light_from_object) {
  pn_result result =
      pni_edge_table_begin(gpu, "mesh points", "silhouettes/points.frag.glsl", "", &e->points, e->vertices);
  if (result != PN_OK) return result;
  float matrix[16];
  pni_matrix_to_floats(light_from_object, matrix);
  pni_set_matrix4(gpu, "pn_light_from_object", matrix);
  pni_set_ints(gpu, "pn_layout", (int)e->vertices, e->stride, 0, 0);
  pni_set_texture(gpu, "pn_positions", &e->positions);
  pni_draw_screen(gpu);
  return PN_OK;
}

pn_result pni_silhouettes_draw(pni_gpu *gpu, pni_mesh_edges *e, const pni_matrix *light_from_object,
                               pni_projection projection, float cut) {
  pn_result result = draw_points(gpu, e, light_from_object);
  if (result == PN_OK)
    result = pni_edge_table_begin(gpu, "silhouettes", "silhouettes/silhouette.frag.glsl", "", &e->sides, e->count);
  if (result != PN_OK) return result;
  pni_silhouettes_set(gpu, e, projection, cut);
  pni_draw_screen(gpu);
  return PN_OK;
}

/* ---- what there is to draw --------------------------------------------------------------------------------------- */

pn_result pni_casters_each_mesh(pn_casters *casters, uint32_t groups, pni_mesh_visitor visit, void *user,
                                pni_without_edges *others) {
  pn_result result = PN_OK;
  *others = (pni_without_edges){0};
  for (int group = 0; group < PN_GROUP_COUNT; group++)
    others->callbacks += casters->callbacks[group].draw && (groups >> group & 1);
  for (int i = 0; i < casters->instance_count && result == PN_OK; i++) {
    const pni_instance_data *instance = &casters->instances[i];
    pni_mesh_data *mesh = &casters->meshes[instance->mesh];
    if (!(groups >> instance->group & 1)) continue;
    if (mesh->alpha_texture) {
      others->holes++;
      continue;
    }
    result = visit(user, mesh, &instance->scene_from_object);
  }
  return result;
}
