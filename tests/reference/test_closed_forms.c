/* The reference against formulas, and its promises: determinism, stopping, hostile input. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "reference_scenes.h"

static const struct reference_instance placed = {0, IDENTITY};

static float *trace(const struct reference_mesh *mesh, const struct reference_light *light,
                    const struct reference_points *points, int samples, int threads) {
  struct reference_casters casters = {.meshes = mesh, .instances = &placed, .mesh_count = 1, .instance_count = 1};
  struct reference_options options = {.samples = samples, .threads = threads};
  float *visibility = malloc((size_t)points->width * (size_t)points->height * sizeof *visibility);
  assert_int_equal(reference_trace(&casters, light, points, &options, visibility, NULL), REFERENCE_OK);
  return visibility;
}

/* The part of [-a, a] that the interval [lo, hi] covers. */
static double covered(double lo, double hi, double a) {
  lo = lo < -a ? -a : lo;
  hi = hi > a ? a : hi;
  return hi > lo ? (hi - lo) / (2 * a) : 0;
}

/* From p on the plane, an edge at q and height h stands before the light's plane at this coordinate. */
static double projected(double p, double q, double h, double light_height) { return p + (q - p) * light_height / h; }

/* A square of half side b at height h over the plane, parallel to the light: visibility = 1 - fx fz. Tolerances in
 * rays: 1 where one of the factors is 0 or 1 (an edge parallel to the light's), 6 at corners, both from the net's
 * discrepancy; what the rays' offset and float rounding move an edge by is 1e-4 of the light at the very most. */
static void square_over_plane(void **state) {
  (void)state;
  const double a_u = 0.5, a_v = 0.35, b = 1, h = 1.5, height = 3;
  struct quad quad = horizontal_quad((float)h, -1, 1, -1, 1);
  struct reference_mesh mesh = quad_mesh(&quad);
  struct reference_light light = light_down(REFERENCE_RECTANGLE, height, a_u, a_v);
  struct plane_points plane = plane_points(150, 130, -3, 3, -3, 3);
  float *visibility = trace(&mesh, &light, &plane.points, 1024, 0);
  int edges = 0, corners = 0;
  for (int i = 0; i < 150 * 130; i++) {
    double x = (double)plane.positions[3 * i], z = (double)plane.positions[3 * i + 2];
    double fx = covered(projected(x, -b, h, height), projected(x, b, h, height), a_u);
    double fz = covered(projected(z, -b, h, height), projected(z, b, h, height), a_v);
    int is_corner = fx > 0 && fx < 1 && fz > 0 && fz < 1;
    double tolerance = (is_corner ? 6 : 1) / 1024.0 + 1e-4;
    double error = (double)visibility[i] - (1 - fx * fz);
    assert_true(fabs(error) <= tolerance);
    if (fx * fz == 0) assert_true(visibility[i] == 1);
    edges += !is_corner && fx * fz > 0 && fx * fz < 1;
    corners += is_corner;
  }
  assert_true(edges > 2000 && corners > 700);
  free(visibility);
  plane_points_free(&plane);
}

/* The same with a number of rays that is no power of two: correlated multi-jittered, 1/N at edges. */
static void square_over_plane_multi_jittered(void **state) {
  (void)state;
  struct quad quad = horizontal_quad(1.5f, -9, 0, -9, 9);
  struct reference_mesh mesh = quad_mesh(&quad);
  struct reference_light light = light_down(REFERENCE_RECTANGLE, 3, 0.5, 0.5);
  struct plane_points plane = plane_points(200, 3, -1, 1, -1, 1);
  float *visibility = trace(&mesh, &light, &plane.points, 400, 0);
  for (int i = 0; i < 600; i++) {
    double x = (double)plane.positions[3 * i];
    double exact = 1 - covered(-99, projected(x, 0, 1.5, 3), 0.5);
    assert_true(fabs((double)visibility[i] - exact) <= 1 / 400.0 + 1e-4);
  }
  free(visibility);
  plane_points_free(&plane);
}

/* A half-plane x < 0 at height h under a sun from straight above: the ray to tangent x_L meets it where x + x_L h <
 * 0. */
static void sun_over_half_plane(void **state) {
  (void)state;
  const double h = 2, tangent = 0.25;
  struct quad quad = horizontal_quad((float)h, -500, 0, -500, 500);
  struct reference_mesh mesh = quad_mesh(&quad);
  struct reference_light light = light_down(REFERENCE_SUN, 0, tangent, 0.1);
  struct plane_points plane = plane_points(300, 3, -1, 1, -1, 1);
  float *visibility = trace(&mesh, &light, &plane.points, 1024, 0);
  for (int i = 0; i < 900; i++) {
    double x = (double)plane.positions[3 * i];
    double exact = 1 - covered(-99, -x / h, tangent);
    assert_true(fabs((double)visibility[i] - exact) <= 1 / 1024.0 + 1e-4);
  }
  free(visibility);
  plane_points_free(&plane);
}

/* A light that stands on the horizon is cut by it: a wall x = 1 hides what a receiver sees of an upright light's
 * upper part. */
static void light_is_cut_at_the_horizon(void **state) {
  (void)state;
  struct reference_light light = {.shape = REFERENCE_RECTANGLE,
                                  .center = {2, 0, 0},
                                  .direction = {-1, 0, 0},
                                  .u = {0, 1, 0},
                                  .v = {0, 0, 1},
                                  .half = {1, 1}};
  /* From (0, 0, 0) with normal y the light's upper half [0, 1] is seen; a wall at x = 1 from y = 0 to 0.25 hides it
   * up to 0.5. */
  struct quad wall = {{1, -5, -9, 1, 0.25f, -9, 1, 0.25f, 9, 1, -5, 9}, {0}, {0, 1, 2, 0, 2, 3}};
  struct reference_mesh mesh = quad_mesh(&wall);
  float positions[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 2, 0, 0, NAN, 0, 0},
        normals[] = {0, 1, 0, -1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0};
  struct reference_points points = {.width = 6, .height = 1, .positions = positions, .normals = normals};
  float *visibility = trace(&mesh, &light, &points, 4096, 1);
  assert_true(fabs((double)visibility[0] - 0.5) <= 2 / 2048.0); /* 2048 of the 4096 rays are above the horizon */
  assert_true(visibility[1] == 1);                              /* faces away */
  assert_true(fabs((double)visibility[2] - 0.25) <=
              1 / 4096.0 + 1e-4);  /* sees all of the light, hidden up to height 0.5 of -1 to 1 */
  assert_true(visibility[3] == 1); /* behind the light */
  assert_true(visibility[4] == 1); /* in its plane */
  assert_true(visibility[5] == 1); /* background */
  free(visibility);
}

/* A caster that is its own receiver: large triangles, points on them displaced by what a depth buffer does to them,
 * and not one ray may be lost to acne. And at a contact no light may leak. */
static void no_acne_and_no_leak(void **state) {
  (void)state;
  struct quad floor = horizontal_quad(0, -50, 50, -50, 50);
  float positions[24];
  uint32_t indices[12] = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
  memcpy(positions, floor.positions, sizeof floor.positions);
  /* An opaque curtain that stands on the floor at x = 0. */
  const float curtain[12] = {0, 0, -50, 0, 40, -50, 0, 40, 50, 0, 0, 50};
  memcpy(positions + 12, curtain, sizeof curtain);
  struct reference_mesh mesh = {.positions = positions, .indices = indices, .vertex_count = 8, .triangle_count = 4};
  struct reference_light light = {.shape = REFERENCE_RECTANGLE,
                                  .center = {10, 10, 0},
                                  .direction = {-0.6, -0.8, 0},
                                  .u = {0, 0, 1},
                                  .v = {-0.8, 0.6, 0},
                                  .half = {1, 1}};
  struct plane_points plane = plane_points(400, 20, -2, 2, -30, 30);
  for (int i = 0; i < 8000; i++) plane.positions[3 * i + 1] = (i % 3 - 1) * 2e-5f;
  float errors[8000];
  for (int i = 0; i < 8000; i++) errors[i] = 2e-5f;
  plane.points.errors = errors;
  float *visibility = trace(&mesh, &light, &plane.points, 64, 0);
  for (int i = 0; i < 8000; i++) assert_true(visibility[i] == (plane.positions[3 * i] > 0 ? 1 : 0));
  free(visibility);
  plane_points_free(&plane);
}

/* A ceiling in the light's own plane does not block it. */
static void ceiling_at_the_light(void **state) {
  (void)state;
  struct quad quad = horizontal_quad(3, -5, 5, -5, 5);
  struct reference_mesh mesh = quad_mesh(&quad);
  struct reference_light light = light_down(REFERENCE_RECTANGLE, 3, 0.5, 0.5);
  struct plane_points plane = plane_points(64, 64, -5, 5, -5, 5);
  float *visibility = trace(&mesh, &light, &plane.points, 64, 0);
  for (int i = 0; i < 64 * 64; i++) assert_true(visibility[i] == 1);
  free(visibility);
  plane_points_free(&plane);
}

/* A texture of 4 x 1 texels 0, 0, 255, 255 over x in [-1, 1] at cutoff 0.5 is, bilinearly, a half-plane x > 0;
 * wrapped, a hole every 2. */
static void alpha_makes_holes(void **state) {
  (void)state;
  static const uint8_t texels[] = {0, 0, 255, 255};
  struct reference_light light = light_down(REFERENCE_RECTANGLE, 3, 0.5, 0.5);
  struct plane_points plane = plane_points(300, 2, -1.2f, 1.2f, -0.1f, 0.1f);
  struct quad quad = horizontal_quad(1.5f, -9, 9, -9, 9);
  for (int corner = 0; corner < 4; corner++) /* one image per 2 scene units, its first texel's left edge at x = -1 */
    quad.texcoords[2 * corner] = (quad.positions[3 * corner] + 1) / 2;
  struct reference_mesh mesh = quad_mesh(&quad);
  mesh.cutoff = 0.5f;
  for (int wrap = REFERENCE_REPEAT; wrap <= REFERENCE_MIRROR; wrap++) {
    struct reference_alpha alpha = {4, 1, texels, (enum reference_wrap)wrap, REFERENCE_CLAMP};
    mesh.alpha = &alpha;
    float *visibility = trace(&mesh, &light, &plane.points, 1024, 0);
    for (int i = 0; i < 600; i++) {
      double x = (double)plane.positions[3 * i], hidden = 0;
      for (int k = -4; k <= 4;
           k++) { /* blocking intervals of x: repeat [2k, 2k + 1]; clamp [0, inf); mirror [4k, 4k + 2] */
        if (wrap == REFERENCE_CLAMP && k != 0) continue;
        double lo = wrap == REFERENCE_REPEAT ? 2 * k : 4 * k, hi = wrap == REFERENCE_REPEAT  ? lo + 1
                                                                   : wrap == REFERENCE_CLAMP ? 9
                                                                                             : lo + 2;
        hidden += covered(projected(x, lo, 1.5, 3), projected(x, hi, 1.5, 3), 0.5);
      }
      assert_true(fabs((double)visibility[i] - (1 - hidden)) <= 2 / 1024.0 + 1e-4); /* two edges at most */
    }
    free(visibility);
  }
  plane_points_free(&plane);
}

/* The caster is placed by its instance: mirrored, scaled, moved. */
static void instances_are_placed(void **state) {
  (void)state;
  struct quad quad = horizontal_quad(0, 0, 1, 0, 1);
  struct reference_mesh mesh = quad_mesh(&quad);
  struct reference_instance instances[2] = {{0, {-8, 0, 0, 0, 0, 1, 0, 0, 0, 0, 16, 0, 0, 1.5f, -8, 1}}, {0, {0}}};
  struct reference_casters casters = {&mesh, instances, 1, 2}; /* the second is scaled to nothing */
  struct reference_light light = light_down(REFERENCE_RECTANGLE, 3, 0.5, 0.5);
  struct plane_points plane = plane_points(101, 1, -1, 1, -1, 1);
  struct reference_options options = {.samples = 256, .threads = 1};
  float visibility[101];
  assert_int_equal(reference_trace(&casters, &light, &plane.points, &options, visibility, NULL), REFERENCE_OK);
  for (int i = 0; i < 101; i++) {
    double exact = 1 - covered(-99, projected((double)plane.positions[3 * i], 0, 1.5, 3), 0.5);
    assert_true(fabs((double)visibility[i] - exact) <= 1 / 256.0 + 1e-4);
  }
  plane_points_free(&plane);
}

/* ---- promises ---------------------------------------------------------------------------------------------------- */

/* Many small triangles in a slab above the plane. */
static struct reference_mesh confetti(int count) {
  float *positions = malloc((size_t)count * 9 * sizeof *positions);
  uint32_t *indices = malloc((size_t)count * 3 * sizeof *indices);
  srand(7);
  for (int i = 0; i < count; i++) {
    float center[3];
    for (int axis = 0; axis < 3; axis++) center[axis] = (float)rand() / (float)RAND_MAX * 2 - 1;
    center[1] = center[1] * 0.5f + 1;
    for (int j = 0; j < 9; j++) positions[9 * i + j] = center[j % 3] + 0.1f * ((float)rand() / (float)RAND_MAX - 0.5f);
    for (int j = 0; j < 3; j++) indices[3 * i + j] = (uint32_t)(3 * i + j);
  }
  return (struct reference_mesh){
      .positions = positions, .indices = indices, .vertex_count = 3 * (size_t)count, .triangle_count = (size_t)count};
}

static void confetti_free(struct reference_mesh *mesh) {
  free((void *)mesh->positions);
  free((void *)mesh->indices);
}

static void threads_do_not_matter(void **state) {
  (void)state;
  struct reference_mesh mesh = confetti(3000);
  struct plane_points plane = plane_points(117, 93, -1.5f, 1.5f, -1.5f, 1.5f);
  for (int shape = 0; shape < 2; shape++) {
    struct reference_light light = light_down((enum reference_shape)shape, 3, 0.3, 0.2);
    float *one = trace(&mesh, &light, &plane.points, 256, 1);
    for (int threads = 2; threads <= 5; threads += 3) {
      float *many = trace(&mesh, &light, &plane.points, 256, threads);
      assert_memory_equal(one, many, 117 * 93 * sizeof *one);
      free(many);
    }
    double sum = 0;
    for (int i = 0; i < 117 * 93; i++) sum += (double)one[i];
    assert_true(sum > 117 * 93 * 0.1 && sum < 117 * 93 * 0.99); /* there is something to get wrong */
    free(one);
  }
  plane_points_free(&plane);
  confetti_free(&mesh);
}

struct asked {
  int calls, stop_at;
  double fraction;
};

static int ask(void *user, double fraction, double left) {
  struct asked *asked = user;
  assert_true(fraction >= asked->fraction && fraction <= 1);
  assert_true(left < 0 || isfinite(left));
  asked->fraction = fraction;
  return ++asked->calls == asked->stop_at;
}

/* So much work that it would take an hour: it ends after the third call of progress, and no worker goes on. */
static void progress_stops_the_work(void **state) {
  (void)state;
  struct reference_mesh mesh = confetti(20000);
  struct reference_casters casters = {&mesh, &placed, 1, 1};
  struct reference_light light = light_down(REFERENCE_RECTANGLE, 3, 0.3, 0.2);
  struct plane_points plane = plane_points(1024, 1024, -1.5f, 1.5f, -1.5f, 1.5f);
  struct asked asked = {0, 3, 0};
  struct reference_options options = {.samples = 65536, .progress = ask, .user = &asked};
  struct reference_result result;
  float *visibility = malloc(1024 * 1024 * sizeof *visibility);
  assert_int_equal(reference_trace(&casters, &light, &plane.points, &options, visibility, &result), REFERENCE_STOPPED);
  assert_int_equal(asked.calls, 3);
  asked = (struct asked){0, -1, 0};
  options.samples = 1;
  assert_int_equal(reference_trace(&casters, &light, &plane.points, &options, visibility, &result), REFERENCE_OK);
  assert_true(asked.calls > 0 && asked.fraction == 1);
  assert_int_equal(result.rays, 1024 * 1024);
  free(visibility);
  plane_points_free(&plane);
  confetti_free(&mesh);
}

/* A sane square beside triangles that are not: what is left is the sane square's shadow. */
static void broken_triangles_block_nothing(void **state) {
  (void)state;
  struct quad quad = horizontal_quad(1.5f, -1, 1, -1, 1);
  float positions[8 * 3];
  memcpy(positions, quad.positions, sizeof quad.positions);
  const float broken[12] = {NAN, 1, 0, 0, INFINITY, 0, 3, 1, 3, -3, 1, 3};
  memcpy(positions + 12, broken, sizeof broken);
  uint32_t indices[] = {4, 6, 7, 0, 1, 2, 5, 6, 7, 0, 2, 3, 0, 1, 99, 6, 6, 7, 7, 7, 7, 0xffffffffu, 0, 1};
  struct reference_mesh mesh = {.positions = positions, .indices = indices, .vertex_count = 8, .triangle_count = 8},
                        sane = quad_mesh(&quad);
  struct reference_light light = light_down(REFERENCE_RECTANGLE, 3, 0.5, 0.5);
  struct plane_points plane = plane_points(50, 50, -3, 3, -3, 3);
  float *found = trace(&mesh, &light, &plane.points, 64, 2), *expected = trace(&sane, &light, &plane.points, 64, 2);
  assert_memory_equal(found, expected, 2500 * sizeof *found);
  free(found);
  free(expected);
  plane_points_free(&plane);
}

static void impossible_input_is_refused(void **state) {
  (void)state;
  struct quad quad = horizontal_quad(1.5f, -1, 1, -1, 1);
  struct reference_mesh mesh = quad_mesh(&quad);
  struct reference_casters casters = {&mesh, &placed, 1, 1};
  struct plane_points plane = plane_points(4, 4, -3, 3, -3, 3);
  struct reference_light good = light_down(REFERENCE_RECTANGLE, 3, 0.5, 0.5), light = good;
  struct reference_options options = {.samples = 17};
  float visibility[16];
  assert_int_equal(reference_trace(&casters, &light, &plane.points, &options, visibility, NULL), REFERENCE_ARGUMENT);
  options.samples = 16;
  light.half[0] = (double)INFINITY;
  assert_int_equal(reference_trace(&casters, &light, &plane.points, &options, visibility, NULL), REFERENCE_ARGUMENT);
  light = good;
  light.center[2] = (double)NAN;
  assert_int_equal(reference_trace(&casters, &light, &plane.points, &options, visibility, NULL), REFERENCE_ARGUMENT);
  light = good;
  memset(light.direction, 0, sizeof light.direction);
  assert_int_equal(reference_trace(&casters, &light, &plane.points, &options, visibility, NULL), REFERENCE_ARGUMENT);
  struct reference_instance lost = {3, IDENTITY};
  casters.instances = &lost;
  assert_int_equal(reference_trace(&casters, &good, &plane.points, &options, visibility, NULL), REFERENCE_ARGUMENT);
  casters.instance_count = 0; /* nothing casts: all lit */
  memset(visibility, 0, sizeof visibility);
  assert_int_equal(reference_trace(&casters, &good, &plane.points, &options, visibility, NULL), REFERENCE_OK);
  for (int i = 0; i < 16; i++) assert_true(visibility[i] == 1);
  plane_points_free(&plane);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(square_over_plane),
      cmocka_unit_test(square_over_plane_multi_jittered),
      cmocka_unit_test(sun_over_half_plane),
      cmocka_unit_test(light_is_cut_at_the_horizon),
      cmocka_unit_test(no_acne_and_no_leak),
      cmocka_unit_test(ceiling_at_the_light),
      cmocka_unit_test(alpha_makes_holes),
      cmocka_unit_test(instances_are_placed),
      cmocka_unit_test(threads_do_not_matter),
      cmocka_unit_test(progress_stops_the_work),
      cmocka_unit_test(broken_triangles_block_nothing),
      cmocka_unit_test(impossible_input_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
