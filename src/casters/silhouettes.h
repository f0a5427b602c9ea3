/* Silhouettes of meshes, seen from the light's centre or along a sun: on the GPU, and in C for the test that holds the
 * two together. */
#ifndef PN_CASTERS_SILHOUETTES_H
#define PN_CASTERS_SILHOUETTES_H

#include "casters/casters.h"
#include "casters/edges.h"
#include "space/space.h"

typedef enum {
  PNI_SIDE_NONE = 0,
  PNI_SIDE_RIGHT,
  PNI_SIDE_LEFT
} pni_side; /* where the mesh lies, walking along the edge */

/* Fills the textures points and sides of a mesh's edges for one instance. cut: pn_cut of edges.glsl. */
pn_result pni_silhouettes_draw(pni_gpu *gpu, pni_mesh_edges *edges, const pni_matrix *light_from_object, bool sun,
                               float cut);
/* Textures and uniforms for a program that includes casters/edges.glsl, in use; count: pn_count.x. */
void pni_silhouettes_bind(pni_gpu *gpu, const pni_program *program, const pni_mesh_edges *edges, size_t count, bool sun,
                          float cut);
pn_result pni_silhouettes_prepare(pni_gpu *gpu);

/* The same sides, from positions in the light's frame, three floats each. */
pni_side pni_silhouette_side(const pni_edge *edge, const float *points, bool sun);
/* A vertex as the GPU transforms it. */
void pni_silhouette_point(const float light_from_object[16], const float position[3], float out[3]);

/* Calls draw for every mesh of groups that can have smoothies: each instance with its matrix. Others, which have no
 * mesh or holes in it, are counted, and told once. */
typedef pn_result (*pni_mesh_visitor)(void *user, pni_mesh_data *mesh, const pni_matrix *scene_from_object);
pn_result pni_casters_each_mesh(pn_casters *casters, uint32_t groups, pni_mesh_visitor visit, void *user);

#endif
