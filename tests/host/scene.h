/* The client's scene: a floor that receives, and what casts on it: boxes, a torus, and a waving flag with round holes.
 * */
#ifndef HOST_SCENE_H
#define HOST_SCENE_H

#include <stdint.h>

#include "linear.h"

typedef struct {
  const char *name;
  int vertex_count, index_count;
  float *rest;      /* 3 a vertex, object space, before the wave */
  float *posed;     /* the same after the wave at the scene's phase */
  float *texcoords; /* 2 a vertex */
  uint32_t *indices;
  float place[16]; /* scene from object */
  int casts, holes;
  float wave;                         /* height of the wave; 0: rigid */
  float bounds_min[3], bounds_max[3]; /* object space, of the posed vertices */
} mesh;

enum { SCENE_FLOOR, SCENE_BOX, SCENE_SLAB, SCENE_TORUS, SCENE_FLAG, SCENE_MESHES };

typedef struct {
  mesh meshes[SCENE_MESHES];
  int count;
  float phase; /* of the wave, radians */
} scene;

/* The whole scene, or an empty one when memory runs out. */
void scene_make(scene *out);
void scene_free(scene *self);
void scene_pose(scene *self, float phase);

/* 1 where the flag has a hole. The texture, the truth and the picture all come from here. */
int scene_hole(double u, double v);
enum { HOLE_TEXELS = 64 };

/* An empty mesh with room for its numbers; vertex_count 0 when memory runs out. */
mesh mesh_make(const char *name, int vertex_count, int index_count);
void mesh_free(mesh *self);
void mesh_pose(mesh *self, float phase);
void mesh_box(mesh *out, const char *name, vec3 half);

/* Smallest box around everything that casts, scene space: min, max. */
void scene_bounds(const scene *self, float bounds[6]);

/* Vertex i in scene space, posed. */
vec3 mesh_vertex(const mesh *self, uint32_t i);

#endif
