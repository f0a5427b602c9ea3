/* Edges of a mesh with the vertices opposite them: what silhouettes are found from. Built once for each mesh. */
#ifndef PNI_SILHOUETTES_EDGES_H
#define PNI_SILHOUETTES_EDGES_H

#include "gl/gpu.h"

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
  /* So many of a vertex's edges may be looked at for each of them: all, but in a mesh that would hold up the GPU with
   * vertices where too many meet. */
  uint32_t ring_most;
  /* what was noticed: edges with one face; with three and more; between two faces that are wound against each other;
   * triangles left out: two corners at one place, not finite, or an index out of range */
  size_t open, crowded, opposed, dropped;
} pni_edge_list;

/* positions: three floats each. Vertices at exactly the same place are one. */
pn_result pni_edges_find(pni_gpu *gpu, const float *positions, size_t vertices, const uint32_t *indices,
                         size_t index_count, pni_edge_list *out);
void pni_edges_free(pni_gpu *gpu, pni_edge_list *list);

#endif
