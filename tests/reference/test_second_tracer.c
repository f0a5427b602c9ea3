/* A second tracer: every ray against every triangle, in double, Moeller and Trumbore's test, sharing only the pattern
 * of points on the light with the reference. Each ray is blocked, free, or too close to call (it passes an edge, a
 * horizon, a hole's border within what float can tell); the reference must count every one of the first two kinds
 * alike. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "reference/reference.h"
#include "reference/sampling.h"

#define GRID 10
#define LEAVES 40
#define POINTS_PER_TRIANGLE 3
#define SAMPLES 256
#define CLOSE 2e-4 /* relative to edges and heights of about 1: far above float's rounding, far below what matters */

static const uint8_t checker[16] = {255, 0, 255, 255, 0, 255, 0, 0, 255, 255, 255, 0, 0, 255, 0, 255};

struct triangle {
  double corner[3][3];
  double st[3][2];
  int has_holes;
};

struct small_scene {
  float ground[(GRID + 1) * (GRID + 1) * 3], leaves[LEAVES * 9], texcoords[LEAVES * 6];
  uint32_t ground_indices[GRID * GRID * 6], leaf_indices[LEAVES * 3];
  struct reference_alpha alpha;
  struct reference_mesh meshes[2];
  struct reference_instance instances[3];
  struct triangle triangles[GRID * GRID * 2 + 2 * LEAVES];
  int count;
};

static float random_between(float lo, float hi) { return lo + (hi - lo) * ((float)rand() / (float)RAND_MAX); }

/* ---- the scene: hills, and two clouds of leaves with holes ------------------------------------------------------- */

static void make_ground(struct small_scene *scene) {
  for (int i = 0; i < (GRID + 1) * (GRID + 1); i++) {
    scene->ground[3 * i] = (float)(i % (GRID + 1)) / GRID * 4 - 2;
    scene->ground[3 * i + 1] = random_between(0, 0.6f);
    scene->ground[3 * i + 2] = (float)(i / (GRID + 1)) / GRID * 4 - 2;
  }
  for (int i = 0; i < GRID * GRID; i++) {
    uint32_t a = (uint32_t)(i / GRID * (GRID + 1) + i % GRID),
             corners[6] = {a, a + GRID + 1, a + 1, a + 1, a + GRID + 1, a + GRID + 2};
    memcpy(scene->ground_indices + 6 * i, corners, sizeof corners);
  }
}

static void make_leaves(struct small_scene *scene) {
  for (int i = 0; i < LEAVES; i++) {
    float center[3] = {random_between(-1.5f, 1.5f), random_between(-0.5f, 0.5f), random_between(-1.5f, 1.5f)};
    for (int j = 0; j < 9; j++) scene->leaves[9 * i + j] = center[j % 3] + random_between(-0.3f, 0.3f);
    for (int j = 0; j < 6; j++) scene->texcoords[6 * i + j] = random_between(-1.5f, 1.5f);
    for (int j = 0; j < 3; j++) scene->leaf_indices[3 * i + j] = (uint32_t)(3 * i + j);
  }
}

static void list_triangles(struct small_scene *scene) {
  scene->count = 0;
  for (int k = 0; k < 3; k++) {
    const struct reference_mesh *mesh = &scene->meshes[scene->instances[k].mesh];
    const float *m = scene->instances[k].scene_from_object;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
      struct triangle *triangle = &scene->triangles[scene->count++];
      triangle->has_holes = mesh->alpha != NULL;
      for (int corner = 0; corner < 3; corner++) {
        size_t vertex = mesh->indices[3 * i + (size_t)corner];
        const float *p = mesh->positions + 3 * vertex;
        for (int row = 0; row < 3; row++)
          triangle->corner[corner][row] = (double)m[row] * (double)p[0] + (double)m[4 + row] * (double)p[1] +
                                          (double)m[8 + row] * (double)p[2] + (double)m[12 + row];
        for (int axis = 0; mesh->alpha && axis < 2; axis++)
          triangle->st[corner][axis] = (double)mesh->texcoords[2 * vertex + (size_t)axis];
      }
    }
  }
}

static void make_scene(struct small_scene *scene) {
  make_ground(scene);
  make_leaves(scene);
  scene->alpha = (struct reference_alpha){4, 4, checker, REFERENCE_REPEAT, REFERENCE_MIRROR};
  scene->meshes[0] = (struct reference_mesh){.positions = scene->ground,
                                             .indices = scene->ground_indices,
                                             .vertex_count = (GRID + 1) * (GRID + 1),
                                             .triangle_count = GRID * GRID * 2};
  scene->meshes[1] = (struct reference_mesh){.positions = scene->leaves,
                                             .indices = scene->leaf_indices,
                                             .texcoords = scene->texcoords,
                                             .vertex_count = 3 * LEAVES,
                                             .triangle_count = LEAVES,
                                             .alpha = &scene->alpha,
                                             .cutoff = 0.4f};
  const struct reference_instance instances[3] = {
      {0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
      {1, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.3f, 1.5f, 0.1f, 1}},
      {1, {0.6f, 0, 0.8f, 0, 0, -1.2f, 0, 0, -0.8f, 0, 0.6f, 0, -0.4f, 1.9f, 0.2f, 1}}, /* turned and mirrored */
  };
  memcpy(scene->instances, instances, sizeof instances);
  list_triangles(scene);
}

/* ---- the second tracer ------------------------------------------------------------------------------------------- */

static void cross(const double a[3], const double b[3], double out[3]) {
  for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}
static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

enum verdict { FREE, BLOCKED, CLOSE_CALL };

/* Alpha at a hit, written from OpenGL's words: the weighted mean of the four texels around (s w - 1/2, t h - 1/2). */
static enum verdict through_hole(const struct triangle *triangle, double u, double v) {
  double s = (1 - u - v) * triangle->st[0][0] + u * triangle->st[1][0] + v * triangle->st[2][0];
  double t = (1 - u - v) * triangle->st[0][1] + u * triangle->st[1][1] + v * triangle->st[2][1];
  double x = s * 4 - 0.5, y = t * 4 - 0.5, alpha = 0;
  for (int j = 0; j < 2; j++)
    for (int i = 0; i < 2; i++) {
      long column = (long)floor(x) + i, row = (long)floor(y) + j;
      column = ((column % 4) + 4) % 4; /* repeat */
      row = ((row % 8) + 8) % 8;       /* mirrored repeat: 0 1 2 3 3 2 1 0 */
      row = row < 4 ? row : 7 - row;
      alpha += checker[4 * row + column] / 255.0 * (i ? x - floor(x) : 1 - (x - floor(x))) *
               (j ? y - floor(y) : 1 - (y - floor(y)));
    }
  return fabs(alpha - (double)0.4f) < 2e-3 ? CLOSE_CALL : alpha >= (double)0.4f ? BLOCKED : FREE;
}

static enum verdict against(const struct triangle *triangle, const double origin[3], const double direction[3],
                            double reach, const double normal[3]) {
  double e1[3], e2[3], to[3], p[3], q[3];
  for (int i = 0; i < 3; i++) {
    e1[i] = triangle->corner[1][i] - triangle->corner[0][i];
    e2[i] = triangle->corner[2][i] - triangle->corner[0][i];
    to[i] = origin[i] - triangle->corner[0][i];
  }
  cross(direction, e2, p);
  double determinant = dot(e1, p);
  cross(to, e1, q);
  double u = dot(to, p) / determinant, v = dot(direction, q) / determinant, t = dot(e2, q) / determinant;
  if (fabs(determinant) < 1e-7) /* edge on: anything may come out of the division */
    return t > -0.1 && t < reach + 0.1 && u > -0.1 && v > -0.1 && u + v < 1.1 ? CLOSE_CALL : FREE;
  double tolerance = CLOSE * (1 + 0.01 / fabs(determinant)), height = t * dot(direction, normal);
  double least = fmin(fmin(u, v), fmin(1 - u - v, fmin(height, fmin(t, reach - t))));
  if (least < -tolerance) return FREE;
  if (least < tolerance) return CLOSE_CALL;
  return triangle->has_holes ? through_hole(triangle, u, v) : BLOCKED;
}

static enum verdict shoot(const struct small_scene *scene, int own, const double origin[3], const double direction[3],
                          double reach, const double normal[3]) {
  enum verdict verdict = FREE;
  for (int i = 0; i < scene->count; i++) {
    enum verdict one = i == own ? FREE : against(&scene->triangles[i], origin, direction, reach, normal);
    if (one == BLOCKED) return BLOCKED;
    if (one == CLOSE_CALL) verdict = CLOSE_CALL;
  }
  return verdict;
}

/* ---- both on the same rays --------------------------------------------------------------------------------------- */

struct surface {
  float positions[GRID * GRID * 2 * POINTS_PER_TRIANGLE * 3], normals[GRID * GRID * 2 * POINTS_PER_TRIANGLE * 3];
  int count;
};

/* Points inside the ground's triangles, normals up. */
static void scatter_points(const struct small_scene *scene, struct surface *surface) {
  surface->count = GRID * GRID * 2 * POINTS_PER_TRIANGLE;
  for (int i = 0; i < surface->count; i++) {
    const struct triangle *triangle = &scene->triangles[i / POINTS_PER_TRIANGLE];
    double w[3], sum = 0, e1[3], e2[3], n[3];
    for (int k = 0; k < 3; k++) sum += w[k] = (double)random_between(0.1f, 1);
    for (int axis = 0; axis < 3; axis++) {
      double p = 0;
      for (int k = 0; k < 3; k++) p += w[k] / sum * triangle->corner[k][axis];
      surface->positions[3 * i + axis] = (float)p;
      e1[axis] = triangle->corner[1][axis] - triangle->corner[0][axis];
      e2[axis] = triangle->corner[2][axis] - triangle->corner[0][axis];
    }
    cross(e1, e2, n);
    double length = (n[1] < 0 ? -1 : 1) * sqrt(dot(n, n));
    for (int axis = 0; axis < 3; axis++) surface->normals[3 * i + axis] = (float)(n[axis] / length);
  }
}

struct tally {
  int above_least, above_most, blocked_least, blocked_most; /* what float may have counted */
};

static struct tally count_rays(const struct small_scene *scene, const struct reference_light *light,
                               const struct sampling *sampling, const struct surface *surface, int index) {
  struct tally tally = {0, 0, 0, 0};
  struct sampling_pixel state;
  sampling_begin(sampling, (uint32_t)index, &state);
  double p[3], n[3], direction[3];
  for (int axis = 0; axis < 3; axis++) {
    p[axis] = (double)surface->positions[3 * index + axis];
    n[axis] = (double)surface->normals[3 * index + axis];
  }
  for (int packet = 0; packet < sampling->packets; packet++) {
    float x[SAMPLING_LANES], y[SAMPLING_LANES];
    int active = sampling_packet(sampling, &state, packet, x, y);
    for (int i = 0; i < active; i++) {
      for (int axis = 0; axis < 3; axis++) {
        double base = light->shape == REFERENCE_SUN ? -light->direction[axis] : light->center[axis] - p[axis];
        direction[axis] =
            base + light->half[0] * (double)x[i] * light->u[axis] + light->half[1] * (double)y[i] * light->v[axis];
      }
      double rise = dot(direction, n);
      if (rise < -1e-4) continue;
      enum verdict verdict =
          shoot(scene, index / POINTS_PER_TRIANGLE, p, direction, light->shape == REFERENCE_SUN ? 1e9 : 1, n);
      int sure = rise > 1e-4;
      tally.above_least += sure;
      tally.above_most++;
      tally.blocked_least += sure && verdict == BLOCKED;
      tally.blocked_most += verdict != FREE;
    }
  }
  return tally;
}

static void compare_tracers(const struct reference_light *light) {
  static struct small_scene scene;
  static struct surface surface;
  static float visibility[GRID * GRID * 2 * POINTS_PER_TRIANGLE];
  make_scene(&scene);
  scatter_points(&scene, &surface);
  struct reference_casters casters = {scene.meshes, scene.instances, 2, 3};
  struct reference_points points = {
      .width = surface.count, .height = 1, .positions = surface.positions, .normals = surface.normals};
  struct reference_options options = {.samples = SAMPLES};
  assert_int_equal(reference_trace(&casters, light, &points, &options, visibility, NULL), REFERENCE_OK);
  struct sampling sampling;
  assert_true(sampling_create(&sampling, SAMPLES));
  long rays = 0, unsure = 0, blocked = 0;
  for (int i = 0; i < surface.count; i++) {
    struct tally tally = count_rays(&scene, light, &sampling, &surface, i);
    /* Some number of rays above the horizon and of blocked ones, both within the bounds, must give this visibility. */
    int agrees = tally.above_least == 0 && visibility[i] == 1;
    for (int above = tally.above_least > 0 ? tally.above_least : 1; above <= tally.above_most; above++)
      for (int hidden = tally.blocked_least; hidden <= tally.blocked_most && hidden <= above; hidden++)
        agrees |= fabs((double)visibility[i] - (double)(above - hidden) / above) < 1e-6;
    if (!agrees)
      printf("point %d: %g, not 1 - [%d, %d] / [%d, %d]\n", i, (double)visibility[i], tally.blocked_least,
             tally.blocked_most, tally.above_least, tally.above_most);
    assert_true(agrees);
    rays += tally.above_most;
    blocked += tally.blocked_least;
    unsure += tally.blocked_most - tally.blocked_least + tally.above_most - tally.above_least;
  }
  sampling_free(&sampling);
  /* The test says something: rays of both kinds abound, and close calls are a handful. */
  assert_true(blocked > rays / 10 && blocked < rays * 9 / 10);
  assert_true(unsure < rays / 100);
}

static void rectangle_above(void **state) {
  (void)state;
  srand(1);
  struct reference_light light = {.shape = REFERENCE_RECTANGLE,
                                  .center = {0.2, 4, -0.1},
                                  .direction = {0, -1, 0},
                                  .u = {1, 0, 0},
                                  .v = {0, 0, -1},
                                  .half = {0.8, 0.5}};
  compare_tracers(&light);
}

/* Low and close: many horizons are crossed. */
static void rectangle_aslant(void **state) {
  (void)state;
  srand(2);
  struct reference_light light = {.shape = REFERENCE_RECTANGLE,
                                  .center = {4, 2, 0},
                                  .direction = {-0.8, -0.6, 0},
                                  .u = {0, 0, 1},
                                  .v = {-0.6, 0.8, 0},
                                  .half = {0.7, 1.2}};
  compare_tracers(&light);
}

static void sun_aslant(void **state) {
  (void)state;
  srand(3);
  struct reference_light light = {.shape = REFERENCE_SUN,
                                  .direction = {-0.48, -0.6, 0.64},
                                  .u = {0.8, 0, 0.6},
                                  .v = {-0.36, 0.8, 0.48},
                                  .half = {0.2, 0.35}};
  compare_tracers(&light);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rectangle_above),
      cmocka_unit_test(rectangle_aslant),
      cmocka_unit_test(sun_aslant),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
