/* Light map space in C, against formulas written down in scene space. */
#include "gl_context.h"
#include "space/space.h"
#include "vector.h"

#include <float.h>

enum { ROUNDS = 5000 };

/* Double arithmetic of a dozen steps on numbers that were checked to cancel by no more than a factor of 1e4. */
static const double tiny = 1e-11;

static void put(vec a, float out[3]) {
  out[0] = (float)a.x;
  out[1] = (float)a.y;
  out[2] = (float)a.z;
}

static vec get(const double a[3]) { return v3(a[0], a[1], a[2]); }

/* A light somewhere, turned somehow. */
static pni_frame random_frame(uint64_t *seed, bool sun) {
  pni_frame f = {.projection = sun ? PNI_PARALLEL : PNI_CENTRAL};
  float z[3], u[3];
  do {
    put(random_direction(seed), z);
    put(random_direction(seed), u);
  } while (!pni_frame_axes(z, u, &f));
  for (int i = 0; i < 3; i++) f.origin[i] = sun ? 0 : random_in(seed, -5, 5);
  return f;
}

/* From the light's frame to the scene, without the matrix. */
static vec in_scene(const pni_frame *f, vec p) {
  return add(get(f->origin), add(mul(p.x, get(f->u)), add(mul(p.y, get(f->v)), mul(p.z, get(f->z)))));
}

static vec in_light(const pni_frame *f, vec scene) {
  vec d = sub(scene, get(f->origin));
  return v3(dot(d, get(f->u)), dot(d, get(f->v)), dot(d, get(f->z)));
}

static void map_of(const pni_frame *f, vec scene, double m[3]) {
  vec p = in_light(f, scene);
  const double values[3] = {p.x, p.y, p.z};
  pni_map_point(values, f->projection, m);
}

static void close_to(double a, double b, double size) { assert_true(fabs(a - b) <= tiny * size); }

/* ---- frames ---- */

static void test_light_frame(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int i = 0; i < ROUNDS; i++) {
    vec z = random_direction(&seed), up = random_direction(&seed);
    float direction[3], upwards[3], out[3][3];
    put(mul(random_in(&seed, 0.01, 100), z), direction);
    put(up, upwards);
    vec across = cross(v3(direction[0], direction[1], direction[2]), v3(upwards[0], upwards[1], upwards[2]));
    if (length(unit(z)) * length(up) - fabs(dot(z, up)) < 1e-4) continue;
    assert_int_equal(pn_light_frame(direction, upwards, out[0], out[1], out[2]), PN_OK);
    vec u = unit(across), v = cross(u, unit(v3(direction[0], direction[1], direction[2])));
    const vec want[3] = {unit(v3(direction[0], direction[1], direction[2])), u, v};
    for (int k = 0; k < 3;
         k++) /* the outputs are floats: half a unit in the last place of 1, and the double arithmetic */
      assert_true(length(sub(v3(out[k][0], out[k][1], out[k][2]), want[k])) < 2 * FLT_EPSILON);
  }
}

static void assert_frame(const float direction[3], const float *up, vec u, vec v) {
  float out_u[3], out_v[3];
  assert_int_equal(pn_light_frame(direction, up, NULL, out_u, out_v), PN_OK);
  assert_true(length(sub(v3(out_u[0], out_u[1], out_u[2]), u)) < 2 * FLT_EPSILON);
  assert_true(length(sub(v3(out_v[0], out_v[1], out_v[2]), v)) < 2 * FLT_EPSILON);
}

static void test_parallel_up(void **state) {
  (void)state;
  const float down[3] = {0, -2, 0}, up[3] = {0, 1, 0}, back[3] = {0, 0, -3}, forth[3] = {0, 0, 1},
              nothing[3] = {0, 0, 0};
  /* Down: up becomes (0, 0, -1); u = (0, -1, 0) x (0, 0, -1) = (1, 0, 0),
   * v = u x z = (1, 0, 0) x (0, -1, 0) = (0, 0, -1). */
  assert_frame(down, up, v3(1, 0, 0), v3(0, 0, -1));
  assert_frame(up, down, v3(-1, 0, 0), v3(0, 0, -1));
  assert_frame(down, nothing, v3(1, 0, 0), v3(0, 0, -1));
  assert_frame(down, NULL, v3(1, 0, 0), v3(0, 0, -1));
  /* Along (0, 0, -1) with an up parallel to it: up becomes (1, 0, 0); u = (0, 0, -1) x (1, 0, 0) = (0, -1, 0),
   * v = (1, 0, 0). */
  assert_frame(back, forth, v3(0, -1, 0), v3(1, 0, 0));
  const float bad_up[3] = {NAN, 0, 0};
  assert_frame(down, bad_up, v3(1, 0, 0), v3(0, 0, -1));
}

static void test_bad_frames(void **state) {
  (void)state;
  const float zero[3] = {0, 0, 0}, nan3[3] = {0, NAN, 0}, inf3[3] = {INFINITY, 0, 0}, x[3] = {1, 0, 0},
              x2[3] = {-2, 0, 0};
  const float up[3] = {0, 1, 0}, skew[3] = {1, 1, 0};
  pni_frame f;
  assert_int_equal(pn_light_frame(zero, up, NULL, NULL, NULL), PN_ERROR_ARGUMENT);
  assert_int_equal(pn_light_frame(nan3, up, NULL, NULL, NULL), PN_ERROR_ARGUMENT);
  assert_int_equal(pn_light_frame(inf3, up, NULL, NULL, NULL), PN_ERROR_ARGUMENT);
  assert_int_equal(pn_light_frame(NULL, up, NULL, NULL, NULL), PN_ERROR_ARGUMENT);
  assert_false(pni_frame_axes(zero, up, &f));
  assert_false(pni_frame_axes(up, zero, &f));
  assert_false(pni_frame_axes(x, x2, &f));
  assert_false(pni_frame_axes(nan3, up, &f));
  assert_false(pni_frame_axes(up, inf3, &f));
  assert_true(pni_frame_axes(x, skew, &f)); /* made perpendicular */
  assert_true(length(sub(get(f.u), v3(0, 1, 0))) < tiny);
  assert_true(length(sub(get(f.v), cross(v3(0, 1, 0), v3(1, 0, 0)))) < tiny);
}

static void test_light_from_scene(void **state) {
  (void)state;
  uint64_t seed = 2;
  for (int i = 0; i < ROUNDS; i++) {
    pni_frame f = random_frame(&seed, i & 1);
    pni_matrix m = pni_light_from_scene(&f);
    vec p = random_point(&seed, 10), scene = in_scene(&f, p);
    double s[3] = {scene.x, scene.y, scene.z}, out[3];
    pni_matrix_point(&m, s, out);
    assert_true(length(sub(get(out), p)) < tiny * 100);
  }
}

/* ---- points ---- */

static vec before_light(uint64_t *seed, bool sun) {
  return v3(random_in(seed, -5, 5), random_in(seed, -5, 5), random_in(seed, sun ? -10 : 0.05, 10));
}

static void test_map_point(void **state) {
  (void)state;
  const double p[3] = {3, -4, 2}, flat[3] = {1.5, -2, 0.5}, sun[3] = {3, -4, -2};
  double m[3];
  pni_map_point(p, false, m);
  assert_memory_equal(m, flat, sizeof m);
  pni_map_point(p, true, m);
  assert_memory_equal(m, sun, sizeof m);
  uint64_t seed = 3;
  for (int i = 0; i < ROUNDS; i++) {
    vec at = before_light(&seed, i & 1);
    double in[3] = {at.x, at.y, at.z}, out[3];
    pni_map_point(in, i & 1, m);
    pni_light_point(m, i & 1, out);
    assert_true(length(sub(get(out), at)) <= 8 * DBL_EPSILON * length(at));
  }
}

/* Where the line from R through Q meets the light's plane, by intersecting it there; for a sun, the direction's
 * tangents. */
static void test_back_projection(void **state) {
  (void)state;
  uint64_t seed = 4;
  for (int i = 0; i < ROUNDS; i++) {
    bool sun = i & 1;
    pni_frame f = random_frame(&seed, sun);
    vec r = in_scene(&f, v3(random_in(&seed, -5, 5), random_in(&seed, -5, 5), random_in(&seed, 2, 10)));
    vec q = in_scene(&f, v3(random_in(&seed, -5, 5), random_in(&seed, -5, 5), random_in(&seed, 0.05, 1.5)));
    double mq[3], mr[3], found[2], want[2];
    map_of(&f, q, mq);
    map_of(&f, r, mr);
    pni_back_project(mq, mr, found);
    vec d = sub(q, r);
    if (sun) {
      want[0] = dot(d, get(f.u)) / -dot(d, get(f.z));
      want[1] = dot(d, get(f.v)) / -dot(d, get(f.z));
    } else {
      double t = dot(sub(get(f.origin), r), get(f.z)) / dot(d, get(f.z));
      vec hit = sub(add(r, mul(t, d)), get(f.origin));
      want[0] = dot(hit, get(f.u));
      want[1] = dot(hit, get(f.v));
    }
    for (int k = 0; k < 2; k++) close_to(found[k], want[k], 1e3);
  }
}

/* ---- planes and horizons ---- */

/* (Q - R) . n in the scene, times w_Q for a rectangle; counts how often the light's centre lay behind the plane. */
static void test_plane_front(void **state) {
  (void)state;
  uint64_t seed = 5;
  int behind = 0, front = 0;
  for (int i = 0; i < ROUNDS; i++) {
    bool sun = i & 1;
    pni_frame f = random_frame(&seed, sun);
    vec r = before_light(&seed, sun), q = before_light(&seed, sun), n = random_direction(&seed);
    vec scene_n = sub(in_scene(&f, n), get(f.origin));
    double mq[3], mr[3], normal[3] = {n.x, n.y, n.z}, at[3] = {r.x, r.y, r.z};
    map_of(&f, in_scene(&f, q), mq);
    map_of(&f, in_scene(&f, r), mr);
    double k = pni_plane_offset(normal, at, sun);
    double want = dot(scene_n, sub(in_scene(&f, q), in_scene(&f, r))) * (sun ? 1 : 1 / q.z);
    double found = pni_plane_front(normal, k, mq, mr);
    close_to(found, want, 1e4);
    if (fabs(want) > 1e-6) assert_true((found > 0) == (want > 0));
    bool centre_behind = sun ? n.z > 0 : dot(scene_n, sub(get(f.origin), in_scene(&f, r))) < 0;
    behind += centre_behind;
    front += !centre_behind;
  }
  assert_true(behind > ROUNDS / 4 && front > ROUNDS / 4);
}

/* Above the horizon: n . (light's point - R) > 0; for a sun, n . direction to the point. */
static void test_horizon(void **state) {
  (void)state;
  uint64_t seed = 6;
  for (int i = 0; i < ROUNDS; i++) {
    bool sun = i & 1;
    pni_frame f = random_frame(&seed, sun);
    vec r = before_light(&seed, sun), n = random_direction(&seed);
    double point[2] = {random_in(&seed, -2, 2), random_in(&seed, -2, 2)};
    double normal[3] = {n.x, n.y, n.z}, at[3] = {r.x, r.y, r.z};
    vec scene_n = sub(in_scene(&f, n), get(f.origin)), to;
    if (sun) to = add(mul(point[0], get(f.u)), sub(mul(point[1], get(f.v)), get(f.z)));
    else to = sub(in_scene(&f, v3(point[0], point[1], 0)), in_scene(&f, r));
    close_to(pni_horizon(normal, pni_plane_offset(normal, at, sun), point), dot(scene_n, to), 1e3);
  }
}

/* ---- windows ---- */

/* A sample at the window's edge hides exactly the light's edge; one micropatch darkens exactly the receivers in its
 * penumbra extent. */
static void test_windows(void **state) {
  (void)state;
  uint64_t seed = 7;
  for (int i = 0; i < ROUNDS; i++) {
    double extent = random_in(&seed, 0.01, 3), w_r = random_in(&seed, 0.1, 1), w = w_r + random_in(&seed, 0.1, 4),
           point[2];
    double r[3] = {random_in(&seed, -1, 1), random_in(&seed, -1, 1), w_r};
    double q[3] = {r[0] + pni_search_window(extent, w, w_r), r[1] - pni_search_window(extent, w, w_r), w};
    pni_back_project(q, r, point);
    close_to(point[0], extent, 100);
    close_to(point[1], -extent, 100);
    double reached[3] = {q[0] + pni_penumbra_extent(extent, w, w_r), q[1] - pni_penumbra_extent(extent, w, w_r), w_r};
    pni_back_project(q, reached, point);
    close_to(point[0], -extent, 100);
    close_to(point[1], extent, 100);
  }
  assert_true(pni_search_window(2, 1, 3) == 0 && pni_penumbra_extent(2, 1, 3) == 0);
}

/* ---- maps ---- */

static void test_depth(void **state) {
  (void)state;
  uint64_t seed = 8;
  for (int i = 0; i < ROUNDS; i++) {
    double w_far = random_in(&seed, -4, 4), w_near = w_far + random_in(&seed, 1e-3, 4), scale[2];
    pni_depth_scale(w_near, w_far, scale);
    close_to(scale[0] + scale[1] * PNI_DEPTH_MARGIN, w_near, 10);
    close_to(scale[0] + scale[1] * (1 - PNI_DEPTH_MARGIN), w_far, 10);
  }
}

/* A point of the light's frame lands where the light's point (a, b), taken for the eye, sees it: rectangle (x - a) / z;
 * sun: x carried along (a, b, -1) to z = 0, x + a z. Depth is affine in w from -1 at w_near to 1 at w_far. */
static void test_clip(void **state) {
  (void)state;
  uint64_t seed = 9;
  for (int i = 0; i < ROUNDS; i++) {
    bool sun = i & 1;
    vec p = v3(random_in(&seed, -5, 5), random_in(&seed, -5, 5), random_in(&seed, sun ? -10 : 0.1, 10));
    double shear[2] = {i & 2 ? random_in(&seed, -2, 2) : 0, i & 2 ? random_in(&seed, -2, 2) : 0};
    double s0 = random_in(&seed, -3, 3), t0 = random_in(&seed, -3, 3);
    double bounds[4] = {s0, t0, s0 + random_in(&seed, 0.1, 4), t0 + random_in(&seed, 0.1, 4)};
    double w_far = random_in(&seed, -4, 1), w_near = w_far + random_in(&seed, 0.1, 4);
    pni_matrix clip = pni_clip_from_light(sun, bounds, w_near, w_far, shear);
    double in[4] = {p.x, p.y, p.z, 1}, out[4], seen[2];
    pni_matrix_apply(&clip, in, out);
    for (int k = 0; k < 2; k++) {
      seen[k] = sun ? in[k] + shear[k] * p.z : (in[k] - shear[k]) / p.z;
      close_to(out[k] / out[3], 2 * (seen[k] - bounds[k]) / (bounds[2 + k] - bounds[k]) - 1, 1e4);
    }
    double w = sun ? -p.z : 1 / p.z;
    close_to(out[2] / out[3], 1 - 2 * (w - w_far) / (w_near - w_far), 1e4);
    assert_true(out[3] > 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_light_frame), cmocka_unit_test(test_parallel_up),
      cmocka_unit_test(test_bad_frames),  cmocka_unit_test(test_light_from_scene),
      cmocka_unit_test(test_map_point),   cmocka_unit_test(test_back_projection),
      cmocka_unit_test(test_plane_front), cmocka_unit_test(test_horizon),
      cmocka_unit_test(test_windows),     cmocka_unit_test(test_depth),
      cmocka_unit_test(test_clip),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
