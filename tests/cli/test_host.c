/* The renderer that plays the host: what it hands the library is where and what a ray finds, and its shading is the
 * integral it stands for. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "host/host.h"
#include "host/shade.h"
#include "host/view.h"
#include "scene/load.h"
#include "scene/setup.h"
#include "scene/vector.h"

static const double pi = 3.14159265358979323846;

struct hit {
  double t, normal[3];
  int instance;
};

/* A distance on the triangle's plane, from barycentric coordinates, as it shows across the ray: by the least
 * altitude and the slant. */
static double across(double barycentric, const double a[3], const double b[3], const double n[3], double cosine) {
  double c[3];
  v3_sub(b, a, c);
  double longest = fmax(fmax(v3_length(a), v3_length(b)), v3_length(c));
  return fabs(barycentric) * v3_length(n) / longest * cosine;
}

/* Moeller-Trumbore in double over every triangle: slow, and sharing nothing with the rasteriser. Returns the least
 * angle between the ray and an edge that it passes. */
static double cast(const struct scene *scene, const double origin[3], const double direction[3], struct hit *hit) {
  double margin = 1;
  *hit = (struct hit){.t = INFINITY, .instance = -1};
  for (int i = 0; i < scene->instance_count; i++) {
    const struct instance *instance = &scene->instances[i];
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    for (uint32_t k = 0; k < mesh->triangle_count; k++) {
      double p[3][3], a[3], b[3], n[3], s[3], q[3];
      for (int c = 0; c < 3; c++) {
        const float *v = &mesh->positions[3 * (size_t)mesh->indices[3 * (size_t)k + (size_t)c]];
        const double object[3] = {mesh->center[0] + v[0], mesh->center[1] + v[1], mesh->center[2] + v[2]};
        m4_point(instance->scene_from_object, object, p[c]);
      }
      v3_sub(p[1], p[0], a);
      v3_sub(p[2], p[0], b);
      v3_cross(a, b, n);
      v3_sub(origin, p[0], s);
      double det = -v3_dot(direction, n);
      if (det == 0) continue;
      double t = v3_dot(s, n) / det;
      v3_cross(s, direction, q);
      double u = v3_dot(b, q) / det, v = -v3_dot(a, q) / det, inside = fmin(fmin(u, v), 1 - u - v);
      if (t > 0) margin = fmin(margin, across(inside, a, b, n, fabs(det) / v3_length(n)) / t);
      if (inside < 0 || t <= 0 || t >= hit->t) continue;
      hit->t = t;
      hit->instance = i;
      v3_normalize(n);
      for (int d = 0; d < 3; d++) hit->normal[d] = det > 0 ? n[d] : -n[d];
    }
  }
  return margin;
}

static struct scene *load(const char *name, int width, int height) {
  struct scene_request request = {.name = name};
  struct scene *scene = NULL;
  assert_int_equal(scene_load(&request, &scene), 0);
  scene->setup.size[0] = width;
  scene->setup.size[1] = height;
  return scene;
}

static void pixel_ray(const struct scene *scene, int x, int y, double origin[3], double direction[3]) {
  const struct camera *camera = &scene->setup.camera;
  double forward[3], right[3], up[3], scale = tan(camera->fov * pi / 360);
  int w = scene->setup.size[0], h = scene->setup.size[1];
  v3_sub(camera->target, camera->position, forward);
  v3_normalize(forward);
  v3_cross(forward, camera->up, right);
  v3_normalize(right);
  v3_cross(right, forward, up);
  memcpy(origin, camera->position, 3 * sizeof *origin);
  memcpy(direction, forward, 3 * sizeof *direction);
  v3_add_scaled(direction, scale * w / h * (2 * (x + 0.5) / w - 1), right, direction);
  v3_add_scaled(direction, scale * (1 - 2 * (y + 0.5) / h), up, direction);
  v3_normalize(direction);
}

/* Rays that pass an edge this close, in pixels, may fall either way: a rasteriser snaps corners to 1/256 of a pixel
 * or finer. */
static const double edge_margin = 1 / 32.0;

static void check_view(const char *name, int least_pixels) {
  struct scene *scene = load(name, 64, 48);
  assert_int_equal(setup_finish(scene), 0);
  struct host host;
  struct view *view = NULL;
  assert_int_equal(host_open(scene, "software", &host), 0);
  assert_int_equal(view_read(host.gbuffer, scene, &view), 0);
  int compared = 0;
  double extent = scene_extent(scene), pixel = 2 * tan(scene->setup.camera.fov * pi / 360) / 48;
  for (int y = 0; y < 48; y++)
    for (int x = 0; x < 64; x++) {
      double origin[3], direction[3], p[3];
      struct hit hit;
      pixel_ray(scene, x, y, origin, direction);
      if (cast(scene, origin, direction, &hit) < edge_margin * pixel) continue;
      size_t i = (size_t)y * 64 + (size_t)x;
      compared++;
      if (hit.instance < 0) {
        assert_true(isnan(view->position[3 * i]) && isnan(view->normal[3 * i + 2]) && view->mask[i] == 0);
        continue;
      }
      const float *n = &view->normal[3 * i], *q = &view->position[3 * i];
      v3_add_scaled(origin, hit.t, direction, p);
      /* The screen's position is exact to about 1/256 of a pixel times slope in a rasteriser; what counts is that
       * the point lies on the surface: within the depth buffer's and float's precision. */
      double off = 0, along[3];
      for (int k = 0; k < 3; k++) {
        off += (q[k] - p[k]) * hit.normal[k];
        along[k] = q[k] - p[k];
        assert_true(fabs(n[k] - hit.normal[k]) < 1e-6);
      }
      double cosine = fabs(v3_dot(direction, hit.normal));
      assert_true(fabs(off) < 4e-6 * extent * 8);
      assert_true(v3_length(along) < 4e-6 * extent * 8 / cosine + 1e-5 * extent);
      assert_int_equal(view->receives[i], scene->instances[hit.instance].receives);
    }
  print_message("%s: %d of %d pixels compared\n", name, compared, 64 * 48);
  assert_true(compared > least_pixels);
  view_free(&view);
  host_close(&host);
  scene_free(&scene);
}

static void test_view_boxes(void **state) {
  (void)state;
  check_view("builtin:boxes", 2500);
}

static void test_view_copies(void **state) {
  (void)state;
  check_view("builtin:copies=4", 1000); /* small triangles: most rays pass an edge closely */
}

static void test_view_room(void **state) {
  (void)state;
  check_view("builtin:room", 2500);
}

/* Mask by hand: the top of a box faces the light above; its sides and what is behind the lamp do not. */
static void test_mask(void **state) {
  (void)state;
  struct scene *scene = load("builtin:room", 64, 48);
  assert_int_equal(setup_finish(scene), 0);
  struct host host;
  struct view *view = NULL;
  assert_int_equal(host_open(scene, "software", &host), 0);
  assert_int_equal(view_read(host.gbuffer, scene, &view), 0);
  int up = 0, ceiling = 0;
  for (size_t i = 0; i < 64 * 48; i++) {
    const float *p = &view->position[3 * i], *n = &view->normal[3 * i];
    if (n[1] > 0.99f && p[1] < 2.5f) {
      assert_true(view->mask[i] == 1);
      up++;
    }
    if (p[1] > 2.56f) {
      assert_true(view->mask[i] == 0);
      ceiling++;
    }
  }
  assert_true(up > 100 && ceiling > 10);
  view_free(&view);
  host_close(&host);
  scene_free(&scene);
}

/* Closed form for a point under the middle of a parallel rectangle (four corner terms), and a midpoint sum for
 * tilted and clipped ones. */
static void test_form_factor(void **state) {
  (void)state;
  struct light light = {
      .shape = PN_LIGHT_RECTANGLE, .center = {0, 2, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .size = {1, 3}};
  assert_int_equal(light_finish(&light), 0);
  const double p[3] = {0, 0, 0}, n[3] = {0, 1, 0};
  double a = 0.25, b = 0.75, ra = sqrt(1 + a * a), rb = sqrt(1 + b * b);
  double exact = 4 / (2 * pi) * (a / ra * atan(b / ra) + b / rb * atan(a / rb));
  assert_true(fabs(light_form_factor(&light, p, n) - exact) < 1e-12);
  const double normals[][3] = {{0.6, 0.8, 0}, {0.9, 0.1, 0.3}, {-0.2, 0.05, 0.9}, {0.1, -0.3, -0.9}},
               q[3] = {0.3, 0.7, -0.2};
  for (size_t i = 0; i < sizeof normals / sizeof *normals; i++) {
    double m[3], sum = 0;
    memcpy(m, normals[i], sizeof m);
    v3_normalize(m);
    enum { N = 600 };
    for (int k = 0; k < N * N; k++) {
      double s = (k % N + 0.5) / N - 0.5, t = ((k / N) + 0.5) / N - 0.5, d[3];
      for (int c = 0; c < 3; c++) d[c] = light.center[c] + s * light.u[c] + 3 * t * light.v[c] - q[c];
      double r = v3_normalize(d), cosine = v3_dot(d, m), back = -v3_dot(d, light.direction);
      if (cosine > 0) sum += cosine * back / (pi * r * r) * 3 / (N * (double)N);
    }
    assert_true(fabs(light_form_factor(&light, q, m) - sum) < 1e-4 * fmax(sum, 0.01));
  }
  const double above[3] = {0, 2.5, 0};
  assert_true(light_form_factor(&light, above, n) == 0);
}

static void test_shading(void **state) {
  (void)state;
  float position[6] = {0, 0, 0, NAN, NAN, NAN}, normal[6] = {0, 1, 0, NAN, NAN, NAN}, visibility[2] = {1, 1}, rgb[6];
  struct view view = {.width = 2, .height = 1, .position = position, .normal = normal};
  struct light light = {
      .shape = PN_LIGHT_RECTANGLE, .center = {0, 3, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .size = {1, 1}};
  assert_int_equal(light_finish(&light), 0);
  shade(&view, &light, visibility, rgb);
  assert_true(rgb[0] > 0.75f && rgb[0] < 0.85f && rgb[1] == rgb[0] && rgb[2] == rgb[0]);
  float lit = rgb[0], empty = rgb[3];
  visibility[0] = 0.5f;
  visibility[1] = 0;
  shade(&view, &light, visibility, rgb);
  float half = rgb[0];
  visibility[0] = 0;
  shade(&view, &light, visibility, rgb);
  assert_true(fabsf(half - 0.5f * (lit + rgb[0])) < 1e-6f); /* linear in visibility */
  assert_true(rgb[0] > 0 && rgb[0] < 0.1f);                 /* a little ambient */
  assert_true(rgb[3] == empty);                             /* background has no visibility */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_view_boxes), cmocka_unit_test(test_view_copies), cmocka_unit_test(test_view_room),
      cmocka_unit_test(test_mask),       cmocka_unit_test(test_form_factor), cmocka_unit_test(test_shading),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
