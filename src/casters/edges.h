/* Edges of a mesh with the vertices opposite them: what silhouettes are found from. Built once for each mesh. */
#ifndef PN_CASTERS_EDGES_H
#define PN_CASTERS_EDGES_H

#include "gl/target.h"

/* An edge of one or two faces: its ends, and the third corner of each face (twice the same where there is one face).
 * Neither winding nor normals take part. */
typedef struct {
  uint32_t ends[2], opposite[2];
} pni_edge;

typedef struct {
  uint32_t edge, other; /* an edge that ends at the vertex, and its other end */
} pni_ring_entry;

typedef struct {
  uint32_t first, count;
} pni_ring;

typedef struct {
  pni_edge *edges;
  size_t count;
  pni_ring *rings; /* one for each vertex; empty ones for those that an equal one stands for */
  pni_ring_entry *entries;
  size_t vertices;
  /* what was noticed: edges with one face; with three and more; between two faces that are wound against each other;
   * triangles left out: two corners at one place, not finite, or an index out of range */
  size_t open, crowded, opposed, dropped;
} pni_edge_list;

/* positions: three floats each. Vertices at exactly the same place are one. */
pn_result pni_edges_find(pni_gpu *gpu, const float *positions, size_t vertices, const uint32_t *indices,
                         size_t index_count, pni_edge_list *out);
void pni_edges_free(pni_gpu *gpu, pni_edge_list *list);

/* ---- on the GPU -------------------------------------------------------------------------------------------------- */

/* Tables are textures, PNI_EDGE_ROW entries a row; positions a row of floats. */
enum { PNI_EDGE_ROW = 4096, PNI_POSITION_ROW = 4096 };

typedef struct pni_mesh_edges {
  size_t count, vertices;
  int stride;                        /* floats from position to position */
  pni_texture positions;             /* as in the mesh's buffer */
  pni_texture edges, rings, entries; /* pni_edge, pni_ring, pni_ring_entry */
  pni_texture points;                /* of the last instance: positions in the light's frame */
  pni_texture sides;                 /* which edges are silhouettes, and on which side the mesh lies */
  /* a technique's own, filled anew for each instance */
  pni_texture kept, sums[3], total, list;
  pni_buffer arguments;
  bool stale; /* positions changed */
} pni_mesh_edges;

struct pni_mesh_data;
/* Finds the mesh's edges when it is asked for the first time, which reads its buffers back once, and brings its
 * positions up to date. *out NULL: the mesh has none that are drawn. */
pn_result pni_mesh_edges_get(pni_gpu *gpu, struct pni_mesh_data *mesh, pni_mesh_edges **out);
void pni_mesh_edges_free(pni_gpu *gpu, pni_mesh_edges **edges, bool abandon);

#endif
