/* A mesh's edges as textures, and its positions beside them: what the passes over them read. */
#ifndef PNI_SILHOUETTES_MESH_EDGES_H
#define PNI_SILHOUETTES_MESH_EDGES_H

#include "casters/casters.h"
#include "gl/texture.h"

/* Tables are textures, PNI_EDGE_ROW entries a row; positions a row of floats. The shaders are told by
 * pni_edge_defines. */
enum { PNI_EDGE_ROW = 4096, PNI_POSITION_ROW = 4096 };
extern const char pni_edge_defines[];

typedef struct {
  size_t count, vertices;
  int ring_most;                     /* of a vertex's edges that are looked at */
  int stride;                        /* floats from position to position */
  pni_texture positions;             /* as in the mesh's buffer */
  pni_texture edges, rings, entries; /* pni_edge, pni_ring, pni_ring_entry */
  pni_texture points;                /* of the last instance: positions in the light's frame */
  pni_texture sides;                 /* which edges are silhouettes, and on which side the mesh lies */
  bool current;                      /* positions are those of this pose */
  uint32_t pose;
} pni_mesh_edges;

/* Finds the mesh's edges when it is asked for the first time, which reads its buffers back once, and brings its
 * positions up to date. *out NULL: the mesh has none that are drawn. */
pn_result pni_mesh_edges_get(pni_gpu *gpu, pni_mesh_data *mesh, pni_mesh_edges **out);

#endif
