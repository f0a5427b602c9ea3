/* Built-in scenes of a few plain solids over a floor. */
#include <math.h>

#include "scene/builtin_scenes.h"
#include "scene/shape.h"

static int over_floor(struct scene *scene, struct shape *shape) {
  return shape_add_to(shape, scene, 1, 1) || shape_add_floor(scene) ? -1 : 0;
}

int build_square(struct scene *scene, int count) {
  (void)count;
  struct shape shape = {0};
  shape_floor(&shape, -0.4, -0.4, 0.4, 0.4, 0.6);
  return over_floor(scene, &shape);
}

int build_boxes(struct scene *scene, int count) {
  (void)count;
  struct shape shape = {0};
  shape_box(&shape, 0, 0, 0.12, 0.4, 0.7, 0.5);
  shape_box(&shape, 0.12, -0.05, 0.7, 1.0, 0.32, 0.42);
  return over_floor(scene, &shape);
}

int build_cylinder(struct scene *scene, int count) {
  (void)count;
  struct shape shape = {0};
  shape_cylinder(&shape, 0.25, 0, 1, 96);
  return over_floor(scene, &shape);
}

int build_balls(struct scene *scene, int count) {
  (void)count;
  struct shape shape = {0};
  const double origin[3] = {0, 0, 0}, radius = 0.13, step = 0.37;
  shape_ball(&shape, origin, radius, 40, 20);
  int mesh = shape_finish(&shape, scene, -1, 0);
  if (mesh < 0) return -1;
  for (int i = 0; i < 27; i++) {
    const double place[3] = {(i % 3 - 1) * step, radius + i / 3 % 3 * step, (i / 9 - 1) * step};
    const double x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};
    if (shape_place(scene, mesh, x, y, z, place)) return -1;
  }
  return shape_add_floor(scene);
}

/* From the light's centre (height 3) the plate covers the box below it, which is wider than the plate; from the
 * light's corners the box shows, and its edges bound the shadow. A single depth map never holds them. */
static int silhouette(struct scene *scene, double y0, double y1) {
  struct shape shape = {0};
  shape_box(&shape, 0, 0, 0.9, 0.95, 0.6, 0.6);
  shape_box(&shape, 0, 0, y0, y1, 0.68, 0.68);
  return over_floor(scene, &shape);
}

int build_silhouette(struct scene *scene, int count) {
  (void)count;
  return silhouette(scene, 0.3, 0.5);
}

int build_silhouette_standing(struct scene *scene, int count) {
  (void)count;
  return silhouette(scene, 0, 0.5);
}

/* A torus: neither convex nor simply shaped, yet closed. */
static void torus(struct shape *shape, double ring, double tube, int n, int m) {
  const double turn = 2 * 3.14159265358979323846;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < m; j++) {
      double a = turn * i / n, b = turn * j / m, r = ring + tube * cos(b);
      shape_vertex(shape, r * cos(a), tube * sin(b), -r * sin(a));
    }
  for (int i = 0; i < n; i++)
    for (int j = 0; j < m; j++) {
      uint32_t i1 = (uint32_t)((i + 1) % n), j1 = (uint32_t)((j + 1) % m), u = (uint32_t)m;
      shape_quad(shape, (uint32_t)i * u + (uint32_t)j, i1 * u + (uint32_t)j, i1 * u + j1, (uint32_t)i * u + j1);
    }
}

/* Tori of one mesh, each turned differently, on a square grid that fills the unit box however many there are. */
int build_copies(struct scene *scene, int count) {
  struct shape shape = {0};
  torus(&shape, 0.7, 0.3, 48, 20);
  int mesh = shape_finish(&shape, scene, -1, 0);
  if (mesh < 0) return -1;
  int columns = (int)ceil(sqrt(count));
  double cell = 1.6 / columns, size = 0.46 * cell;
  for (int i = 0; i < count; i++) {
    double a = 0.7 * i, b = 1.3 * i, ca = size * cos(a), sa = size * sin(a), cb = cos(b), sb = sin(b);
    const double place[3] = {-0.8 + (i % columns + 0.5) * cell, 1.05 * size + 0.25 * (1 + sin(2.1 * i)),
                             -0.8 + (i / columns + 0.5) * cell};
    const double x[3] = {ca, sa * cb, sa * sb}, y[3] = {-sa, ca * cb, ca * sb}, z[3] = {0, -size * sb, size * cb};
    if (shape_place(scene, mesh, x, y, z, place)) return -1;
  }
  return shape_add_floor(scene);
}
