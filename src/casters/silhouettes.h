/* Silhouettes of meshes, seen from the light's centre or along a sun: on the GPU, and in C for the test that holds the
 * two together. */
#ifndef PN_CASTERS_SILHOUETTES_H
#define PN_CASTERS_SILHOUETTES_H

#include "casters/casters.h"
#include "casters/edges.h"
#include "space/space.h"

typedef enum {
  PN_SIDE_NONE = 0,
  PN_SIDE_RIGHT,
  PN_SIDE_LEFT
} pn_side; /* where the mesh lies, walking along the edge */

/* Fills the textures points and sides of a mesh's edges for one instance. cut: pn_cut of edges.glsl. */
pn_result pn_silhouettes_draw(pn_gpu *gpu, pn_mesh_edges *edges, const pn_matrix *light_from_object, bool sun,
                              float cut);
/* Textures and uniforms for a program that includes casters/edges.glsl, in use; count: pn_count.x. */
void pn_silhouettes_bind(pn_gpu *gpu, const pn_program *program, const pn_mesh_edges *edges, size_t count, bool sun,
                         float cut);
pn_result pn_silhouettes_prepare(pn_gpu *gpu);

/* The same sides, from positions in the light's frame, three floats each. */
pn_side pn_silhouette_side(const pn_edge *edge, const float *points, bool sun);
/* A vertex as the GPU transforms it. */
void pn_silhouette_point(const float light_from_object[16], const float position[3], float out[3]);

/* Calls draw for every mesh of groups that can have smoothies: each instance with its matrix. Others, which have no
 * mesh or holes in it, are counted, and told once. */
typedef pn_result (*pn_mesh_visitor)(void *user, pn_mesh_data *mesh, const pn_matrix *scene_from_object);
pn_result pn_casters_each_mesh(pn_casters *casters, uint32_t groups, pn_mesh_visitor visit, void *user);

#endif
