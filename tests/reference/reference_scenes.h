/* reference_scenes.h: lights, casters and rows of points for the tests of the reference. */
#ifndef PENUMBRA_TEST_REFERENCE_SCENES_H
#define PENUMBRA_TEST_REFERENCE_SCENES_H

#include <stdlib.h>
#include <string.h>

#include "reference/reference.h"

#define IDENTITY \
  { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 }

/* Shines straight down, u along x, v along -z. */
static inline struct reference_light light_down(enum reference_shape shape, double height, double half_u,
                                                double half_v) {
  struct reference_light light = {.shape = shape,
                                  .center = {0, height, 0},
                                  .direction = {0, -1, 0},
                                  .u = {1, 0, 0},
                                  .v = {0, 0, -1},
                                  .half = {half_u, half_v}};
  return light;
}

/* Points on the plane y = 0 in a grid over [x0, x1] x [z0, z1], normals up. */
struct plane_points {
  struct reference_points points;
  float *positions, *normals;
};

static inline struct plane_points plane_points(int width, int height, float x0, float x1, float z0, float z1) {
  struct plane_points plane;
  size_t count = (size_t)width * (size_t)height;
  plane.positions = malloc(3 * count * sizeof(float));
  plane.normals = malloc(3 * count * sizeof(float));
  for (size_t i = 0; i < count; i++) {
    float fx = ((float)(i % (size_t)width) + 0.5f) / (float)width,
          fz = ((float)(i / (size_t)width) + 0.5f) / (float)height;
    float position[3] = {x0 + (x1 - x0) * fx, 0, z0 + (z1 - z0) * fz}, normal[3] = {0, 1, 0};
    memcpy(plane.positions + 3 * i, position, sizeof position);
    memcpy(plane.normals + 3 * i, normal, sizeof normal);
  }
  plane.points = (struct reference_points){
      .width = width, .height = height, .positions = plane.positions, .normals = plane.normals};
  return plane;
}

static inline void plane_points_free(struct plane_points *plane) {
  free(plane->positions);
  free(plane->normals);
}

/* The rectangle [x0, x1] x [z0, z1] at height y, texture coordinates 0 to 1. */
struct quad {
  float positions[12], texcoords[8];
  uint32_t indices[6];
};

static inline struct quad horizontal_quad(float y, float x0, float x1, float z0, float z1) {
  struct quad quad = {{x0, y, z0, x1, y, z0, x1, y, z1, x0, y, z1}, {0, 0, 1, 0, 1, 1, 0, 1}, {0, 1, 2, 0, 2, 3}};
  return quad;
}

static inline struct reference_mesh quad_mesh(const struct quad *quad) {
  struct reference_mesh mesh = {.positions = quad->positions,
                                .indices = quad->indices,
                                .texcoords = quad->texcoords,
                                .vertex_count = 4,
                                .triangle_count = 2};
  return mesh;
}

#endif
