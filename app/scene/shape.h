/* shape.h: triangles under construction. Solids are closed and wound counter-clockwise seen from outside; flat
 * faces are truly flat, their corners exact. Running out of memory is remembered and told once, by shape_add_to. */
#ifndef PENUMBRA_APP_SCENE_SHAPE_H
#define PENUMBRA_APP_SCENE_SHAPE_H

#include "scene/scene.h"

struct shape {
  float *positions, *texcoords;
  uint32_t *indices;
  uint32_t vertex_count, triangle_count, vertex_room, triangle_room;
  int failed;
};

uint32_t shape_vertex(struct shape *shape, double x, double y, double z);
void shape_triangle(struct shape *shape, uint32_t a, uint32_t b, uint32_t c);
void shape_quad(struct shape *shape, uint32_t a, uint32_t b, uint32_t c, uint32_t d); /* counter-clockwise */

/* Axis-aligned box from its centre in x and z, its lower and upper y, and full widths. */
void shape_box(struct shape *shape, double x, double z, double y0, double y1, double width, double depth);

/* A bar of square cross section from p to q; side: some direction that is not parallel to it. */
void shape_bar(struct shape *shape, const double p[3], const double q[3], const double side[3], double thickness);

void shape_cylinder(struct shape *shape, double radius, double y0, double y1, int segments);
void shape_ball(struct shape *shape, const double center[3], double radius, int segments, int rings);

/* A horizontal rectangle facing up. */
void shape_floor(struct shape *shape, double x0, double z0, double x1, double z1, double y);

/* Gives every vertex its texture coordinates (2 floats each, copied). */
void shape_texcoords(struct shape *shape, const float *texcoords);

/* Moves the triangles into the scene as a mesh, opaque or with a texture, and empties the shape. Returns the mesh
 * or -1: out of memory. */
int shape_finish(struct shape *shape, struct scene *scene, int texture, float cutoff);

/* An instance that casts and receives: the columns of its transform. 0, or -1: out of memory. */
int shape_place(struct scene *scene, int mesh, const double x[3], const double y[3], const double z[3],
                const double origin[3]);

/* shape_finish, and one instance where it stands. 0, or -1: out of memory. */
int shape_add_to(struct shape *shape, struct scene *scene, int casts, int receives);

/* A floor at y = 0, 5 wide, that only receives. 0, or -1: out of memory. */
int shape_add_floor(struct scene *scene);

#endif
