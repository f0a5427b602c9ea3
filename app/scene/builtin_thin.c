/* Built-in scenes of thin things: a fence, leaves. */
#include <math.h>
#include <stdlib.h>

#include "scene/builtin_scenes.h"
#include "scene/shape.h"

static void bar(struct shape *shape, double x0, double y0, double x1, double y1, double z, double thickness) {
  const double p[3] = {x0, y0, z}, q[3] = {x1, y1, z}, side[3] = {0, 0, 1};
  shape_bar(shape, p, q, side, thickness);
}

/* Wires in both diagonal directions, cut off at the frame; the two layers lie apart, as woven netting does. */
static void netting(struct shape *shape, double x0, double x1, double y0, double y1, double mesh_width, double wire) {
  double height = y1 - y0;
  for (double start = x0 - height + mesh_width / 2; start < x1; start += mesh_width) {
    double t0 = fmax(0, x0 - start), t1 = fmin(height, x1 - start);
    if (t1 - t0 < mesh_width / 4) continue;
    bar(shape, start + t0, y0 + t0, start + t1, y0 + t1, -wire / 2, wire);
    bar(shape, x0 + x1 - start - t0, y0 + t0, x0 + x1 - start - t1, y0 + t1, wire / 2, wire);
  }
}

/* A back light throws the fence's shadow towards the camera. */
int build_fence(struct scene *scene, int count) {
  (void)count;
  struct shape shape = {0};
  const double height = 0.8, post = 0.05;
  for (int i = -1; i <= 1; i++) shape_box(&shape, 0.9 * i, 0, 0, height + 0.06, post, post);
  for (int i = 0; i < 11; i++) bar(&shape, -0.8 + 0.07 * i, 0.05, -0.8 + 0.07 * i, height, 0, 0.016);
  for (int i = 0; i < 2; i++) bar(&shape, -0.9 + post / 2, 0.15 + 0.5 * i, -post / 2, 0.15 + 0.5 * i, 0.024, 0.03);
  netting(&shape, post / 2, 0.9 - post / 2, 0.05, height, 0.08, 0.006);
  if (shape_add_to(&shape, scene, 1, 1)) return -1;
  struct light *light = &scene->setup.light;
  light->center[0] = 0.5;
  light->center[1] = 1.9;
  light->center[2] = -1.6;
  light->target[1] = 0.2;
  light->size[0] = light->size[1] = 0.25;
  light->up[1] = 1;
  light->up[2] = 0;
  return shape_add_floor(scene);
}

/* One leaf with a serrated edge, pointing up in the unit square; v = 0 is its stalk. */
static int inside_leaf(double u, double v) {
  double x = fabs(u - 0.5);
  if (v < 0.2) return x < 0.018;
  double t = (v - 0.2) / 0.8, teeth = 0.02 * fabs(fmod(t * 9, 1) - 0.5);
  double half = 0.36 * pow(sin(3.14159265358979323846 * pow(t, 0.75)), 0.9) - teeth;
  return x < half || x < 0.012;
}

/* Coverage of each texel by 4 x 4 samples, so that the bilinear edge runs where the outline does. */
static int leaf_texture(struct scene *scene) {
  enum { SIZE = 128, SUB = 4 };
  struct texture texture = {.width = SIZE, .height = SIZE, .wrap_u = WRAP_CLAMP, .wrap_v = WRAP_CLAMP};
  texture.alpha = malloc(SIZE * SIZE);
  if (!texture.alpha) return -1;
  for (int i = 0; i < SIZE * SIZE; i++) {
    int hits = 0;
    for (int s = 0; s < SUB * SUB; s++)
      hits += inside_leaf((i % SIZE + (s % SUB + 0.5) / SUB) / SIZE, (i / SIZE + (s / SUB + 0.5) / SUB) / SIZE);
    texture.alpha[i] = (uint8_t)(hits * 255 / (SUB * SUB));
  }
  return scene_add_texture(scene, &texture);
}

static int leaf_mesh(struct scene *scene) {
  int texture = leaf_texture(scene);
  if (texture < 0) return -1;
  struct shape shape = {0};
  uint32_t a = shape_vertex(&shape, -0.5, 0, 0), b = shape_vertex(&shape, 0.5, 0, 0);
  uint32_t c = shape_vertex(&shape, 0.5, 1, 0), d = shape_vertex(&shape, -0.5, 1, 0);
  shape_quad(&shape, a, b, c, d);
  const float texcoords[8] = {0, 0, 1, 0, 1, 1, 0, 1};
  shape_texcoords(&shape, texcoords);
  return shape_finish(&shape, scene, texture, 0.5f);
}

/* A deterministic number in [0, 1). */
static double chance(uint32_t *state) {
  *state = *state * 1664525u + 1013904223u;
  return (*state >> 8) / 16777216.0;
}

int build_leaves(struct scene *scene, int count) {
  (void)count;
  int leaf = leaf_mesh(scene);
  if (leaf < 0) return -1;
  uint32_t seed = 7;
  for (int i = 0; i < 70; i++) {
    double around = 2.39996323 * i, height = 0.25 + 0.6 * (i + 0.5) / 70,
           reach = 0.42 * sqrt(1 - pow(2 * height - 1.1, 2));
    double lean = 0.9 + 0.5 * chance(&seed), size = 0.2 + 0.08 * chance(&seed);
    double ca = cos(around), sa = sin(around), cl = size * cos(lean), sl = size * sin(lean);
    double r = reach * (0.25 + 0.6 * chance(&seed));
    /* x across the leaf, y along it (outwards and up), z its normal. */
    const double x[3] = {-size * sa, 0, size * ca}, y[3] = {sl * ca, cl, sl * sa}, z[3] = {-cl * ca, sl, -cl * sa};
    const double place[3] = {r * ca, height, r * sa};
    if (shape_place(scene, leaf, x, y, z, place)) return -1;
  }
  struct shape shape = {0};
  shape_cylinder(&shape, 0.02, 0, 0.85, 16);
  if (shape_add_to(&shape, scene, 1, 1)) return -1;
  scene->setup.light.size[0] = scene->setup.light.size[1] = 0.5;
  return shape_add_floor(scene);
}
