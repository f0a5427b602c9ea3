/* Built-in scenes that surround the camera: a room, a terrain. */
#include <math.h>

#include "scene/builtin_scenes.h"
#include "scene/shape.h"
#include "scene/vector.h"

/* Seen from inside. Nothing in a convex room stands between its walls and the light, so they only receive. */
static void walls(struct shape *shape, double half_x, double height, double half_z) {
  uint32_t c[8];
  for (int i = 0; i < 8; i++)
    c[i] = shape_vertex(shape, i & 1 ? half_x : -half_x, i & 2 ? height : 0, i & 4 ? half_z : -half_z);
  shape_quad(shape, c[0], c[4], c[5], c[1]); /* floor */
  shape_quad(shape, c[2], c[3], c[7], c[6]); /* ceiling */
  shape_quad(shape, c[0], c[1], c[3], c[2]);
  shape_quad(shape, c[4], c[6], c[7], c[5]);
  shape_quad(shape, c[0], c[2], c[6], c[4]);
  shape_quad(shape, c[1], c[5], c[7], c[3]);
}

static void table(struct shape *shape, double x, double z, double width, double depth, double height, double top,
                  double leg) {
  shape_box(shape, x, z, height - top, height, width, depth);
  for (int i = 0; i < 4; i++)
    shape_box(shape, x + (i & 1 ? 0.5 : -0.5) * (width - 2 * leg), z + (i & 2 ? 0.5 : -0.5) * (depth - 2 * leg), 0,
              height - top, leg, leg);
}

static void chair(struct shape *shape, double x, double z, double back) {
  table(shape, x, z, 0.42, 0.42, 0.45, 0.04, 0.04);
  shape_box(shape, x, z + back * 0.19, 0.45, 0.95, 0.42, 0.04);
}

int build_room(struct scene *scene, int count) {
  (void)count;
  struct shape shape = {0};
  walls(&shape, 2, 2.6, 2.5);
  if (shape_add_to(&shape, scene, 0, 1)) return -1;
  table(&shape, 0.1, -0.3, 1.6, 0.9, 0.75, 0.04, 0.06);
  chair(&shape, -0.25, 0.35, 1);
  chair(&shape, 0.45, -1.05, -1);
  shape_box(&shape, -1.68, -0.6, 0, 2.25, 0.6, 1.4); /* a wardrobe whose top is almost level with the lamp */
  shape_box(&shape, 1.8, -1.2, 1.5, 1.54, 0.3, 1.6); /* a shelf with two things on it */
  shape_box(&shape, 1.8, -1.6, 1.54, 1.8, 0.2, 0.25);
  shape_box(&shape, 1.8, -0.8, 1.54, 1.7, 0.2, 0.4);
  if (shape_add_to(&shape, scene, 1, 1)) return -1;
  struct light *light = &scene->setup.light;
  v3_set(light->center, 0.1, 2.55, -0.2);
  v3_set(light->target, 0.1, 0, -0.2);
  light->size[0] = 1.0;
  light->size[1] = 0.5;
  struct camera *camera = &scene->setup.camera;
  v3_set(camera->position, 0.9, 1.75, 2.35);
  v3_set(camera->target, -0.15, 0.85, -0.8);
  camera->fov = 62;
  return 0;
}

/* A hash of a lattice point, in [0, 1). */
static double lattice(int x, int y) {
  uint32_t h = (uint32_t)x * 0x8da6b343u ^ (uint32_t)y * 0xd8163841u;
  h = (h ^ h >> 13) * 0x9e3779b1u;
  return ((h ^ h >> 16) >> 8) / 16777216.0;
}

/* What the lattice point's random slope contributes at an offset from it. */
static double slope(int i, int j, double x, double y) {
  double angle = 2 * 3.14159265358979323846 * lattice(i, j);
  return cos(angle) * x + sin(angle) * y;
}

/* Gradient noise, about -0.7 .. 0.7. */
static double smooth_noise(double x, double y) {
  double fx = floor(x), fy = floor(y), u = x - fx, v = y - fy;
  int i = (int)fx, j = (int)fy;
  double a = u * u * u * (u * (6 * u - 15) + 10), b = v * v * v * (v * (6 * v - 15) + 10);
  double low = slope(i, j, u, v) * (1 - a) + slope(i + 1, j, u - 1, v) * a;
  double high = slope(i, j + 1, u, v - 1) * (1 - a) + slope(i + 1, j + 1, u - 1, v - 1) * a;
  return low * (1 - b) + high * b;
}

/* Ridged: valleys are wide, crests sharp. Each octave is turned, so that no lattice shows. */
static double terrain_height(double x, double z) {
  double sum = 0, size = 14;
  x = x / 55 + 0.31;
  z = z / 55 + 0.17;
  for (int octave = 0; octave < 6; octave++) {
    double n = 1 - 1.6 * fabs(smooth_noise(x + 11.3 * octave, z + 5.7 * octave));
    sum += size * n * fabs(n);
    size *= 0.42;
    double turned = 1.62 * x - 1.2 * z;
    z = 1.2 * x + 1.62 * z;
    x = turned;
  }
  return sum - 10;
}

int build_terrain(struct scene *scene, int count) {
  (void)count;
  enum { N = 256 };
  const double half = 64;
  struct shape shape = {0};
  for (int j = 0; j <= N; j++)
    for (int i = 0; i <= N; i++) {
      double x = -half + 2 * half * i / N, z = -half + 2 * half * j / N;
      shape_vertex(&shape, x, terrain_height(x, z), z);
    }
  for (uint32_t j = 0; j < N; j++)
    for (uint32_t i = 0; i < N; i++) {
      uint32_t a = j * (N + 1) + i;
      shape_quad(&shape, a, a + N + 1, a + N + 2, a + 1);
    }
  if (shape_add_to(&shape, scene, 1, 1)) return -1;
  struct light *light = &scene->setup.light;
  light->shape = PN_LIGHT_SUN;
  v3_set(light->center, 80, 78, -50);
  v3_set(light->target, 0, 0, 0);
  light->size[0] = light->size[1] = 2;
  struct camera *camera = &scene->setup.camera;
  v3_set(camera->position, 0, 66, 92);
  v3_set(camera->target, 0, 2, 8);
  return 0;
}
