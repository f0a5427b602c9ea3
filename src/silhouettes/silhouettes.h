/* Silhouettes of meshes, seen from the light's centre or along a sun: on the GPU, and in C for the test that holds the
 * two together. */
#ifndef PNI_SILHOUETTES_SILHOUETTES_H
#define PNI_SILHOUETTES_SILHOUETTES_H

#include "silhouettes/edges.h"
#include "silhouettes/mesh_edges.h"
#include "space/space.h"

typedef enum {
  PNI_SIDE_NONE = 0,
  PNI_SIDE_RIGHT,
  PNI_SIDE_LEFT
} pni_side; /* where the mesh lies, walking along the edge */

/* Fills the textures points and sides of a mesh's edges for one instance. cut: pn_cut of edges.glsl. */
pn_result pni_silhouettes_draw(pni_gpu *gpu, pni_mesh_edges *edges, const pni_matrix *light_from_object,
                               pni_projection projection, float cut);
/* Textures and uniforms for the pass that has begun, whose program includes silhouettes/edges.glsl. */
void pni_silhouettes_set(pni_gpu *gpu, const pni_mesh_edges *edges, pni_projection projection, float cut);
/* A pass over count entries of a table, as wide as they need; it begins with the program of that fragment shader. */
pn_result pni_edge_table_begin(pni_gpu *gpu, const char *name, const char *fragment, const char *defines,
                               const pni_texture *to, size_t count);

/* The same sides, from positions in the light's frame, three floats each. */
pni_side pni_silhouette_side(const pni_edge *edge, const float *points, pni_projection projection);
/* A vertex as the GPU transforms it. */
void pni_silhouette_point(const float light_from_object[16], const float position[3], float out[3]);

/* Calls visit for every opaque mesh of groups: each instance with its matrix. What has no edges to
 * find, draw callbacks and meshes with holes in their texture, is counted. */
typedef pn_result (*pni_mesh_visitor)(void *user, pni_mesh_data *mesh, const pni_matrix *scene_from_object);
typedef struct {
  int callbacks, holes;
} pni_without_edges;
pn_result pni_casters_each_mesh(pn_casters *casters, uint32_t groups, pni_mesh_visitor visit, void *user,
                                pni_without_edges *others);

#endif
