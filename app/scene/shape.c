#include "scene/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/vector.h"

static void *grown(void *array, uint32_t *room, uint32_t needed, size_t element) {
  if (needed <= *room) return array;
  uint32_t more = *room ? *room * 2 : 64;
  void *p = realloc(array, (size_t)more * element);
  if (p) *room = more;
  return p;
}

uint32_t shape_vertex(struct shape *shape, double x, double y, double z) {
  if (shape->failed) return 0;
  float *p = grown(shape->positions, &shape->vertex_room, shape->vertex_count + 1, 3 * sizeof(float));
  if (!p) {
    shape->failed = 1;
    return 0;
  }
  shape->positions = p;
  p += 3 * (size_t)shape->vertex_count;
  p[0] = (float)x;
  p[1] = (float)y;
  p[2] = (float)z;
  return shape->vertex_count++;
}

void shape_triangle(struct shape *shape, uint32_t a, uint32_t b, uint32_t c) {
  if (shape->failed) return;
  uint32_t *i = grown(shape->indices, &shape->triangle_room, shape->triangle_count + 1, 3 * sizeof(uint32_t));
  if (!i) {
    shape->failed = 1;
    return;
  }
  shape->indices = i;
  i += 3 * (size_t)shape->triangle_count++;
  i[0] = a;
  i[1] = b;
  i[2] = c;
}

void shape_quad(struct shape *shape, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  shape_triangle(shape, a, b, c);
  shape_triangle(shape, a, c, d);
}

/* The six faces of a hexahedron: corner i has bit 0 for its second u, bit 1 for its second v, bit 2 for its second
 * w, with u x v = w. */
static void hexahedron(struct shape *shape, const uint32_t corner[8]) {
  static const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (int f = 0; f < 6; f++)
    shape_quad(shape, corner[faces[f][0]], corner[faces[f][1]], corner[faces[f][2]], corner[faces[f][3]]);
}

void shape_box(struct shape *shape, double x, double z, double y0, double y1, double width, double depth) {
  uint32_t corner[8];
  for (int i = 0; i < 8; i++)
    corner[i] =
        shape_vertex(shape, x + (i & 1 ? 0.5 : -0.5) * width, i & 2 ? y1 : y0, z + (i & 4 ? 0.5 : -0.5) * depth);
  hexahedron(shape, corner);
}

void shape_bar(struct shape *shape, const double p[3], const double q[3], const double side[3], double thickness) {
  double along[3], u[3], v[3];
  v3_sub(q, p, along);
  v3_cross(side, along, u);
  v3_normalize(u);
  v3_cross(along, u, v);
  v3_normalize(v);
  uint32_t corner[8];
  for (int i = 0; i < 8; i++) {
    double c[3];
    memcpy(c, i & 4 ? q : p, sizeof c);
    v3_add_scaled(c, (i & 1 ? 0.5 : -0.5) * thickness, u, c);
    v3_add_scaled(c, (i & 2 ? 0.5 : -0.5) * thickness, v, c);
    corner[i] = shape_vertex(shape, c[0], c[1], c[2]);
  }
  hexahedron(shape, corner);
}

static const double pi = 3.14159265358979323846;

void shape_cylinder(struct shape *shape, double radius, double y0, double y1, int segments) {
  uint32_t low = shape_vertex(shape, 0, y0, 0), high = shape_vertex(shape, 0, y1, 0);
  uint32_t first = shape->vertex_count;
  for (int i = 0; i < segments; i++) {
    double a = 2 * pi * i / segments, x = radius * cos(a), z = -radius * sin(a);
    shape_vertex(shape, x, y0, z);
    shape_vertex(shape, x, y1, z);
  }
  for (int i = 0; i < segments; i++) {
    uint32_t a = first + 2 * (uint32_t)i, b = first + 2 * (uint32_t)((i + 1) % segments);
    shape_quad(shape, a, b, b + 1, a + 1);
    shape_triangle(shape, low, b, a);
    shape_triangle(shape, high, a + 1, b + 1);
  }
}

void shape_ball(struct shape *shape, const double c[3], double radius, int segments, int rings) {
  uint32_t top = shape_vertex(shape, c[0], c[1] + radius, c[2]),
           bottom = shape_vertex(shape, c[0], c[1] - radius, c[2]);
  uint32_t first = shape->vertex_count;
  for (int j = 1; j < rings; j++)
    for (int i = 0; i < segments; i++) {
      double theta = pi * j / rings, a = 2 * pi * i / segments;
      shape_vertex(shape, c[0] + radius * sin(theta) * cos(a), c[1] + radius * cos(theta),
                   c[2] - radius * sin(theta) * sin(a));
    }
  for (int i = 0; i < segments; i++) {
    uint32_t a = (uint32_t)i, b = (uint32_t)((i + 1) % segments), n = (uint32_t)segments;
    shape_triangle(shape, top, first + a, first + b);
    for (uint32_t j = 0; j + 2 < (uint32_t)rings; j++)
      shape_quad(shape, first + j * n + a, first + (j + 1) * n + a, first + (j + 1) * n + b, first + j * n + b);
    uint32_t last = first + (uint32_t)(rings - 2) * n;
    shape_triangle(shape, bottom, last + b, last + a);
  }
}

void shape_floor(struct shape *shape, double x0, double z0, double x1, double z1, double y) {
  uint32_t a = shape_vertex(shape, x0, y, z0), b = shape_vertex(shape, x0, y, z1);
  uint32_t c = shape_vertex(shape, x1, y, z1), d = shape_vertex(shape, x1, y, z0);
  shape_quad(shape, a, b, c, d);
}

void shape_texcoords(struct shape *shape, const float *texcoords) {
  if (shape->failed) return;
  size_t bytes = (size_t)shape->vertex_count * 2 * sizeof(float);
  shape->texcoords = malloc(bytes);
  if (shape->texcoords) memcpy(shape->texcoords, texcoords, bytes);
  else shape->failed = 1;
}

int shape_finish(struct shape *shape, struct scene *scene, int texture, float cutoff) {
  struct mesh mesh = {.positions = shape->positions,
                      .texcoords = shape->texcoords,
                      .indices = shape->indices,
                      .vertex_count = shape->vertex_count,
                      .triangle_count = shape->triangle_count,
                      .texture = texture,
                      .cutoff = cutoff};
  int failed = shape->failed;
  memset(shape, 0, sizeof *shape);
  if (!failed) return scene_add_mesh(scene, &mesh);
  mesh_free(&mesh);
  return -1;
}

int shape_place(struct scene *scene, int mesh, const double x[3], const double y[3], const double z[3],
                const double origin[3]) {
  const double *columns[4] = {x, y, z, origin};
  double m[16];
  for (int i = 0; i < 16; i++) m[i] = i % 4 < 3 ? columns[i / 4][i % 4] : i == 15;
  return scene_add_instance(scene, mesh, m, 1, 1) < 0 ? -1 : 0;
}

int shape_add_to(struct shape *shape, struct scene *scene, int casts, int receives) {
  int mesh = shape_finish(shape, scene, -1, 0);
  return mesh < 0 || scene_add_instance(scene, mesh, NULL, casts, receives) < 0 ? -1 : 0;
}

int shape_add_floor(struct scene *scene) {
  struct shape shape = {0};
  shape_floor(&shape, -2.5, -2.5, 2.5, 2.5, 0);
  return shape_add_to(&shape, scene, 0, 1);
}
