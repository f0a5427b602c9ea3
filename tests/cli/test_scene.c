/* Built-in scenes are what they say: closed, wound outwards, flat where they are flat, with the set-ups they exist
 * for. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scene/builtin.h"
#include "scene/load.h"
#include "scene/setup.h"
#include "scene/vector.h"

static struct scene *load(const char *name) {
  struct scene_request request = {.name = name};
  struct scene *scene = NULL;
  assert_int_equal(scene_load(&request, &scene), 0);
  assert_int_equal(setup_finish(scene), 0);
  return scene;
}

static int compare_edges(const void *a, const void *b) {
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

/* Every directed edge occurs once, and so does its opposite: a closed surface, consistently wound. */
static void assert_closed(const struct mesh *mesh) {
  size_t count = 3 * (size_t)mesh->triangle_count;
  uint64_t *edges = malloc(count * sizeof *edges);
  assert_non_null(edges);
  for (size_t i = 0; i < count; i++) {
    uint64_t from = mesh->indices[i], to = mesh->indices[i % 3 == 2 ? i - 2 : i + 1];
    edges[i] = from << 32 | to;
  }
  qsort(edges, count, sizeof *edges, compare_edges);
  for (size_t i = 0; i < count; i++) {
    uint64_t opposite = edges[i] << 32 | edges[i] >> 32;
    assert_non_null(bsearch(&opposite, edges, count, sizeof *edges, compare_edges));
    if (i) assert_true(edges[i] != edges[i - 1]);
  }
  free(edges);
}

static void corners(const struct mesh *mesh, uint32_t triangle, double out[3][3]) {
  for (int k = 0; k < 3; k++) {
    const float *p = &mesh->positions[3 * (size_t)mesh->indices[3 * (size_t)triangle + (size_t)k]];
    for (int i = 0; i < 3; i++) out[k][i] = p[i];
  }
}

/* Six times the volume by the divergence theorem: positive where triangles wind counter-clockwise seen from outside. */
static double volume6(const struct mesh *mesh) {
  double sum = 0;
  for (uint32_t t = 0; t < mesh->triangle_count; t++) {
    double p[3][3], n[3];
    corners(mesh, t, p);
    v3_cross(p[1], p[2], n);
    sum += v3_dot(p[0], n);
  }
  return sum;
}

static void assert_areas(const struct mesh *mesh) {
  for (uint32_t t = 0; t < mesh->triangle_count; t++) {
    double p[3][3], n[3];
    corners(mesh, t, p);
    v3_sub(p[1], p[0], p[1]);
    v3_sub(p[2], p[0], p[2]);
    v3_cross(p[1], p[2], n);
    assert_true(v3_length(n) > 0);
  }
}

static void test_builtins(void **state) {
  (void)state;
  static const char *const open_casters[] = {"square", "leaves", "terrain"};
  for (int i = 0; i < builtin_count; i++) {
    char name[64];
    snprintf(name, sizeof name, "builtin:%s", builtins[i].name);
    struct scene *scene = load(name);
    int solid = 1, casters = 0, receivers = 0;
    for (size_t k = 0; k < sizeof open_casters / sizeof *open_casters; k++)
      solid &= strcmp(builtins[i].name, open_casters[k]) != 0;
    for (int k = 0; k < scene->instance_count; k++) {
      const struct instance *instance = &scene->instances[k];
      assert_areas(&scene->meshes[instance->mesh]);
      casters += instance->casts;
      receivers += instance->receives;
      if (!solid || !instance->casts) continue;
      assert_closed(&scene->meshes[instance->mesh]);
      assert_true(volume6(&scene->meshes[instance->mesh]) > 0);
    }
    assert_true(casters > 0 && receivers > 0);
    scene_free(&scene);
    assert_null(scene);
  }
}

/* The ball's and the cylinder's volumes approach their formulas; a missing or doubled part would not. */
static void test_volumes(void **state) {
  (void)state;
  const double pi = 3.14159265358979323846;
  struct scene *balls = load("builtin:balls"), *cylinder = load("builtin:cylinder"), *boxes = load("builtin:boxes");
  assert_true(fabs(volume6(&balls->meshes[0]) / 6 - 4 / 3.0 * pi * pow(0.13, 3)) < 0.02 * 4 / 3.0 * pi * pow(0.13, 3));
  double inscribed = 0.5 * 96 * sin(2 * pi / 96) * 0.25 * 0.25; /* the regular 96-gon's area */
  assert_true(fabs(volume6(&cylinder->meshes[0]) / 6 - inscribed) < 1e-6);
  assert_true(fabs(volume6(&boxes->meshes[0]) / 6 - (0.7 * 0.28 * 0.5 + 0.32 * 0.3 * 0.42)) < 1e-6);
  scene_free(&balls);
  scene_free(&cylinder);
  scene_free(&boxes);
}

/* Seen from the light's centre, the upper plate covers the lower box, which sticks out beyond the plate. */
static void test_silhouette(void **state) {
  (void)state;
  static const char *const names[] = {"builtin:silhouette", "builtin:silhouette-standing"};
  for (int i = 0; i < 2; i++) {
    struct scene *scene = load(names[i]);
    const struct mesh *mesh = &scene->meshes[0];
    const double *light = scene->setup.light.center;
    double plate = 0, plate_slope = INFINITY, box = 0, box_slope = 0, lowest = INFINITY;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
      const float *p = &mesh->positions[3 * v];
      double x = fabs(p[0]), slope = x / (light[1] - p[1]);
      if (p[1] > 0.8f) {
        plate = fmax(plate, x);
        if (p[1] < 0.92f) plate_slope = slope; /* the lower face is the smaller one from above */
      } else {
        box = fmax(box, x);
        box_slope = fmax(box_slope, slope);
        lowest = fmin(lowest, p[1]);
      }
    }
    assert_true(box > plate);
    assert_true(box_slope < plate_slope);
    assert_true(i ? lowest == 0 : lowest > 0.1);
    scene_free(&scene);
  }
}

static void test_room_opens_wide(void **state) {
  (void)state;
  struct scene *scene = load("builtin:room");
  const struct light *light = &scene->setup.light;
  double widest = 0;
  for (int i = 0; i < scene->instance_count; i++) {
    const struct instance *instance = &scene->instances[i];
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    for (uint32_t v = 0; instance->casts && v < mesh->vertex_count; v++) {
      double p[3] = {mesh->positions[3 * v], mesh->positions[3 * v + 1], mesh->positions[3 * v + 2]}, d[3];
      v3_sub(p, light->center, d);
      double z = v3_dot(d, light->direction);
      assert_true(z > 0); /* nothing is above the lamp */
      widest = fmax(widest, atan(fmax(fabs(v3_dot(d, light->u)), fabs(v3_dot(d, light->v))) / z));
    }
  }
  assert_true(2 * widest * 180 / 3.14159265358979323846 > 120);
  scene_free(&scene);
}

static void test_copies(void **state) {
  (void)state;
  struct scene *one = load("builtin:copies=1"), *many = load("builtin:copies=64");
  assert_int_equal(one->instance_count, 2);
  assert_int_equal(many->instance_count, 65);
  assert_int_equal(many->mesh_count, one->mesh_count);
  assert_int_equal(many->triangle_count - 2, 64 * (one->triangle_count - 2));
  scene_free(&one);
  scene_free(&many);
}

/* B and H of the contract, and the frame of the light: z x up = u, u x z = v. */
static void test_standard_setup(void **state) {
  (void)state;
  struct scene *scene = load("builtin:boxes");
  const struct light *light = &scene->setup.light;
  const double center[3] = {0, 3, 0}, down[3] = {0, -1, 0}, u[3] = {1, 0, 0}, v[3] = {0, 0, -1}, eye[3] = {0, 1.8, 2.6};
  for (int k = 0; k < 3; k++) {
    assert_true(fabs(light->center[k] - center[k]) < 1e-12);
    assert_true(fabs(light->direction[k] - down[k]) < 1e-12);
    assert_true(fabs(light->u[k] - u[k]) < 1e-7);
    assert_true(fabs(light->v[k] - v[k]) < 1e-7);
    assert_true(fabs(scene->setup.camera.position[k] - eye[k]) < 1e-12);
  }
  assert_true(light->half[0] == 0.5 && light->half[1] == 0.5);
  scene_free(&scene);
}

static void test_sun_half_is_a_tangent(void **state) {
  (void)state;
  struct scene *scene = load("builtin:terrain");
  assert_int_equal(scene->setup.light.shape, PN_LIGHT_SUN);
  assert_true(fabs(scene->setup.light.half[0] - tan(3.14159265358979323846 / 180)) < 1e-12); /* 2 degrees wide */
  scene_free(&scene);
}

static void test_split_and_ground(void **state) {
  (void)state;
  struct scene *scene = NULL;
  struct scene_request request = {.name = "builtin:boxes", .split = 1};
  assert_int_equal(scene_load(&request, &scene), 0);
  for (int i = 0; i < scene->instance_count; i++)
    assert_int_not_equal(scene->instances[i].casts, scene->instances[i].receives);
  scene_free(&scene);
  request = (struct scene_request){.name = "builtin:boxes", .ground = GROUND_OFF};
  assert_int_equal(scene_load(&request, &scene), 0);
  assert_int_equal(scene->instance_count, 1);
  scene_free(&scene);
  request = (struct scene_request){.name = "builtin:terrain", .ground = GROUND_ON, .split = 1};
  assert_int_equal(scene_load(&request, &scene), 0);
  assert_int_equal(scene->instance_count, 2);
  assert_true(scene->instances[1].receives && !scene->instances[1].casts);
  scene_free(&scene);
}

/* Two texels, 0 and 255, side by side: bilinear between their centres, then by the wrapping mode. */
static void test_texture_alpha(void **state) {
  (void)state;
  uint8_t texels[2] = {0, 255};
  struct texture t = {.width = 2, .height = 1, .alpha = texels};
  assert_true(texture_alpha(&t, 0.25f, 0.5f) == 0);
  assert_true(texture_alpha(&t, 0.75f, 0.5f) == 1);
  assert_true(texture_alpha(&t, 0.5f, 0.5f) == 0.5f);
  assert_true(texture_alpha(&t, 0.0f, 0.5f) == 0.5f); /* repeat: halfway between the last and the first */
  assert_true(texture_alpha(&t, 1.75f, 7.5f) == 1);
  assert_true(texture_alpha(&t, -0.25f, 0.5f) == 1);
  t.wrap_u = WRAP_CLAMP;
  assert_true(texture_alpha(&t, 0.0f, 0.5f) == 0);
  assert_true(texture_alpha(&t, 5.0f, 0.5f) == 1);
  assert_true(texture_alpha(&t, -1e30f, 0.5f) == 0);
  t.wrap_u = WRAP_MIRROR;
  assert_true(texture_alpha(&t, 1.25f, 0.5f) == 1);
  assert_true(texture_alpha(&t, 1.75f, 0.5f) == 0);
  assert_true(texture_alpha(&t, -0.25f, 0.5f) == 0);
  assert_true(texture_alpha(&t, NAN, INFINITY) == 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_builtins),
      cmocka_unit_test(test_volumes),
      cmocka_unit_test(test_silhouette),
      cmocka_unit_test(test_room_opens_wide),
      cmocka_unit_test(test_copies),
      cmocka_unit_test(test_standard_setup),
      cmocka_unit_test(test_sun_half_is_a_tangent),
      cmocka_unit_test(test_split_and_ground),
      cmocka_unit_test(test_texture_alpha),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
