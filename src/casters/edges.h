/* Edges of a mesh with the vertices opposite them: what silhouettes are found from. Built once for each mesh. */
#ifndef PN_CASTERS_EDGES_H
#define PN_CASTERS_EDGES_H

#include "gl/target.h"

/* An edge of one or two faces: its ends, and the third corner of each face (twice the same where there is one face).
 * Neither winding nor normals take part. */
typedef struct {
  uint32_t ends[2], opposite[2];
} pn_edge;

typedef struct {
  uint32_t edge, other; /* an edge that ends at the vertex, and its other end */
} pn_ring_entry;

typedef struct {
  uint32_t first, count;
} pn_ring;

typedef struct {
  pn_edge *edges;
  size_t count;
  pn_ring *rings; /* one for each vertex; empty ones for those that an equal one stands for */
  pn_ring_entry *entries;
  size_t vertices;
  /* what was noticed: edges with one face; with three and more; between two faces that are wound against each other;
   * triangles left out: two corners at one place, not finite, or an index out of range */
  size_t open, crowded, opposed, dropped;
} pn_edge_list;

/* positions: three floats each. Vertices at exactly the same place are one. */
pn_result pn_edges_find(pn_gpu *gpu, const float *positions, size_t vertices, const uint32_t *indices,
                        size_t index_count, pn_edge_list *out);
void pn_edges_free(pn_gpu *gpu, pn_edge_list *list);

/* ---- on the GPU -------------------------------------------------------------------------------------------------- */

/* Tables are textures, PN_EDGE_ROW entries a row; positions a row of floats. */
enum { PN_EDGE_ROW = 4096, PN_POSITION_ROW = 4096 };

typedef struct pn_mesh_edges {
  size_t count, vertices;
  int stride;                       /* floats from position to position */
  pn_texture positions;             /* as in the mesh's buffer */
  pn_texture edges, rings, entries; /* pn_edge, pn_ring, pn_ring_entry */
  pn_texture points;                /* of the last instance: positions in the light's frame */
  pn_texture sides;                 /* which edges are silhouettes, and on which side the mesh lies */
  /* a technique's own, filled anew for each instance */
  pn_texture kept, sums[3], total, list;
  pn_buffer arguments;
  bool stale; /* positions changed */
} pn_mesh_edges;

struct pn_mesh_data;
/* Finds the mesh's edges when it is asked for the first time, which reads its buffers back once, and brings its
 * positions up to date. *out NULL: the mesh has none that are drawn. */
pn_result pn_mesh_edges_get(pn_gpu *gpu, struct pn_mesh_data *mesh, pn_mesh_edges **out);
void pn_mesh_edges_free(pn_gpu *gpu, pn_mesh_edges **edges, bool abandon);

#endif
