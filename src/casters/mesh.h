/* One mesh: from the host's description to buffers and bounds. */
#ifndef PNI_CASTERS_MESH_H
#define PNI_CASTERS_MESH_H

#include "gl/buffer.h"
#include "kept.h"

typedef struct {
  float min[3], max[3];
} pni_box;

/* Boxes over runs of triangles: they bound a mesh in any projection far more tightly than one box does. */
enum { PNI_BOXES_MAX = 256, PNI_BOX_TRIANGLES = 64 };

typedef struct pni_mesh_data {
  uint32_t id;                           /* 0: a free slot */
  pn_span positions, indices, texcoords; /* as described; data pointers are not kept */
  int index_bytes;
  uint32_t *kept_indices; /* positions and indices in memory: the mesh's triangles as described, for deformation */
  size_t kept_count;
  pni_vertices vertices;
  pni_buffer own_positions, own_indices, own_texcoords; /* none where the host owns it */
  double center[3];                                     /* object space: own_positions are seen from it; else 0 */
  size_t draw_count;                                    /* vertices or indices drawn */
  pn_gl alpha_texture;
  bool alpha_complete; /* as its own parameters want it */
  int alpha_channel;
  float alpha_cutoff;
  bool clockwise;
  pni_box whole; /* object space, around all boxes */
  pni_box *boxes;
  int box_count;
  size_t box_triangles; /* each box is over that many of the triangles drawn, in order; 0: it says nothing of that */
  uint32_t pose;        /* how often its positions changed */
  pni_kept kept;        /* by a room above: what it finds out of the triangles */
} pni_mesh_data;

bool pni_box_sound(const float min[3], const float max[3]);
pn_result pni_mesh_check(pni_gpu *gpu, const pn_mesh_desc *desc);
/* New positions of the mesh. */
pn_result pni_mesh_check_moved(pni_gpu *gpu, const pni_mesh_data *mesh, const pn_span *positions);
pn_result pni_mesh_build(pni_gpu *gpu, const pn_mesh_desc *desc, pni_mesh_data *mesh);
/* A failure leaves the mesh as it was. */
pn_result pni_mesh_deform(pni_gpu *gpu, pni_mesh_data *mesh, const pn_span *positions, const float *bounds);
void pni_mesh_drop(pni_gpu *gpu, pni_mesh_data *mesh, bool abandon);

#endif
