/* scene.h: what is drawn, in plain memory, independent of GL: triangles, where they stand, the light, the camera. How
 * one is made: load.h.
 *
 * Scene space is right-handed, Y up; matrices are column-major and map column vectors. */
#ifndef PENUMBRA_APP_SCENE_H
#define PENUMBRA_APP_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include "penumbra/penumbra.h"

/* The largest coordinate anywhere, so that squares of distances stay finite floats. */
#define COORDINATE_MAX 1e15

/* An alpha texture: one byte a texel, row 0 at v = 0 (the bottom), as OpenGL wants it. Sampled bilinearly from this one
 * level, so that a ray tracer and the GPU see the same holes: texture_alpha is the definition. */
enum texture_wrap { WRAP_REPEAT = 0, WRAP_CLAMP, WRAP_MIRROR };
struct texture {
  int width, height;
  uint8_t *alpha;
  enum texture_wrap wrap_u, wrap_v;
};

/* Triangles in object space. Coordinates are finite and every triangle has an area. */
struct mesh {
  float *positions;  /* 3 a vertex, seen from center */
  double center[3];  /* object space; 0 along axes where the mesh is not far from 0 */
  float *texcoords;  /* 2 a vertex; NULL unless texture >= 0 */
  uint32_t *indices; /* 3 a triangle */
  uint32_t vertex_count, triangle_count;
  int texture;                        /* index into scene.textures; -1: opaque */
  float cutoff;                       /* texels with alpha >= cutoff block light, the others are holes */
  float bounds_min[3], bounds_max[3]; /* of positions */
};

/* A mesh that stands somewhere. A pure receiver (casts = 0) is not given to the library. */
struct instance {
  int mesh;
  double scene_from_object[16]; /* affine and finite; may mirror */
  /* Derived by scene_measure, from positions to scene space seen from scene.origin: what is drawn, given to the library
   * and traced. Its numbers are as small as the scene, however far away that lies. */
  float placed[16];
  int casts, receives;
};

struct light {
  pn_light_shape shape;
  double center[3], target[3], up[3]; /* what options set; a sun shines along center to target */
  double size[2];                     /* full widths in scene units; sun: full angles in degrees */
  /* Derived by light_finish: */
  double direction[3], u[3], v[3]; /* unit */
  double half[2];                  /* half extents in scene units; sun: tangents of the angular radii */
};

struct camera {
  double position[3], target[3], up[3];
  double fov; /* vertical, degrees */
};

enum ground { GROUND_DEFAULT = 0, GROUND_ON, GROUND_OFF };

/* Everything that, with the model, makes two runs the same picture. */
struct setup {
  struct light light;
  struct camera camera;
  int size[2]; /* pixels */
  int map[2];  /* depth-map texels; the library's default when 0 */
  int split;   /* the model only casts, the ground only receives */
  int visibility_scale;
  int normals_from_depth; /* the library is handed none and finds tangent planes itself */
  pn_fit fit;
  double fit_bounds[6];
  enum ground ground; /* how the scene was loaded: see scene_request */
  int up_is_z;
};

struct scene {
  char *name; /* "bunny", "builtin:boxes" */
  struct mesh *meshes;
  struct instance *instances;
  struct texture *textures;
  int mesh_count, instance_count, texture_count;
  /* Scene space, of what casts, or of everything when nothing does: B and H of the standard set-up. */
  double bounds_min[3], bounds_max[3];
  /* Scene space: what everything is seen from that ends in floats. 0 along axes where the scene is not far from 0. */
  double origin[3];
  uint64_t triangle_count; /* over instances, the ground included */
  struct setup setup;
};

struct scene *scene_new(const char *name); /* NULL: out of memory, nothing printed */
void scene_free(struct scene **scene);     /* clears the handle; NULL and a NULL handle are fine */

/* Largest extent of the bounds: H. */
double scene_extent(const struct scene *scene);

/* Alpha at (u, v) in [0, 1]: bilinear, wrapped as the texture says. A hole is where this is below the mesh's cutoff. */
float texture_alpha(const struct texture *texture, float u, float v);

/* Adding to a scene under construction (importer, built-ins). Arrays are malloc'ed and taken over; all return the
 * index or -1 when memory ran out (the arrays are then freed). mesh->positions come in object space; center and
 * bounds_* are computed here. */
int scene_add_mesh(struct scene *scene, struct mesh *mesh);
int scene_add_instance(struct scene *scene, int mesh, const double scene_from_object[16], int casts, int receives);
int scene_add_texture(struct scene *scene, const struct texture *texture);
void mesh_free(struct mesh *mesh); /* one that was not added */

/* Bounds in scene space. */
void instance_bounds(const struct scene *scene, const struct instance *instance, double low[3], double high[3]);

/* Computes bounds, triangle_count, origin and every instance's placed anew. */
void scene_measure(struct scene *scene);

#endif
