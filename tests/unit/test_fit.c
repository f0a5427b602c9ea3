/* Fitting: what the maps of a light cover. */
#include "gl_context.h"
#include "maps/trim.h"
#include "vector.h"

#include <float.h>
#include <string.h>

enum { BOXES = PN_GROUP_COUNT };

/* Fitting looks at boxes only, so casters need no GL here. */
static void no_draw(void *user, const pn_caster_pass *pass) { (void)user, (void)pass; }

static pni_box box_at(vec centre, vec half) {
  return (pni_box){{(float)(centre.x - half.x), (float)(centre.y - half.y), (float)(centre.z - half.z)},
                   {(float)(centre.x + half.x), (float)(centre.y + half.y), (float)(centre.z + half.z)}};
}

static void put_box(pn_casters *c, int i, vec centre, vec half) {
  c->callbacks[i].draw = no_draw;
  c->callbacks[i].bounds = box_at(centre, half);
}

static vec box_corner(const pni_box *b, int i) {
  return v3(i & 1 ? b->max[0] : b->min[0], i & 2 ? b->max[1] : b->min[1], i & 4 ? b->max[2] : b->min[2]);
}

/* A light at the origin that shines along z, u along x, v = u x z along -y. */
static pni_frame frame_along_z(bool sun) {
  static const float z[3] = {0, 0, 1}, u[3] = {1, 0, 0};
  pni_frame f = {.projection = sun ? PNI_PARALLEL : PNI_CENTRAL};
  assert_true(pni_frame_axes(z, u, &f));
  return f;
}

static pni_fit_request request_of(const pni_frame *f, int size) {
  static const pni_emission half = {{0.5, 0.5}};
  return (pni_fit_request){.frame = f, .emission = &half, .width = size, .height = size};
}

static pni_fit_result fit(const pn_casters *c, const pni_fit_request *request) {
  pni_fit_result out;
  pni_fit_maps(c, PN_GROUPS_ALL, request, &out);
  return out;
}

static vec map_of(const pni_frame *f, vec p) {
  pni_matrix light = pni_light_from_scene(f);
  double in[3] = {p.x, p.y, p.z}, q[3], m[3];
  pni_matrix_point(&light, in, q);
  pni_map_point(q, f->projection, m);
  return v3(m[0], m[1], m[2]);
}

static void random_boxes(pn_casters *c, uint64_t *seed, vec middle, double spread, double least_z) {
  memset(c, 0, sizeof *c);
  int count = 1 + (int)random_in(seed, 0, 8);
  for (int i = 0; i < count; i++) {
    vec half = v3(random_in(seed, 0.01, 0.5), random_in(seed, 0.01, 0.5), random_in(seed, 0.01, 0.5));
    vec at = add(middle, random_point(seed, spread));
    at.z = fmax(at.z, least_z + half.z);
    put_box(c, i, at, half);
  }
}

/* ---- what is covered, and how tightly ---- */

typedef struct {
  vec least, most;
} extent3;

static extent3 exact_extent(const pn_casters *c, const pni_frame *f, const double shear[2]) {
  extent3 e = {{1e30, 1e30, 1e30}, {-1e30, -1e30, -1e30}};
  for (int b = 0; b < BOXES; b++)
    for (int i = 0; i < 8 && c->callbacks[b].draw; i++) {
      vec m = map_of(f, box_corner(&c->callbacks[b].bounds, i));
      m.x -= shear[0] * m.z;
      m.y -= shear[1] * m.z;
      e.least = v3(fmin(e.least.x, m.x), fmin(e.least.y, m.y), fmin(e.least.z, m.z));
      e.most = v3(fmax(e.most.x, m.x), fmax(e.most.y, m.y), fmax(e.most.z, m.z));
    }
  return e;
}

/* A texel is 2^(k/4): at most 2^(1/4) times as wide as it would have to be, were ends in between allowed, and the map
 * at most four of 64 texels wider for that; so (1 + 4/60) 2^(1/4) as wide in all. Bounds are at most a texel from what
 * they hold, and there is a texel that is empty beside them. */
static void assert_tight(const pni_fit_result *r, const extent3 *e, int size) {
  double least[2] = {e->least.x, e->least.y}, most[2] = {e->most.x, e->most.y};
  for (int k = 0; k < 2; k++) {
    double texel = (r->tile[0][2 + k] - r->tile[0][k]) / size, quarters = 4 * log2(texel), slack = 1e-9 * texel;
    assert_true(fabs(quarters - round(quarters)) < 1e-6);
    assert_true(texel <= fmax((most[k] - least[k]) / (size - 6) * 1.1893, 1e-9));
    assert_true(r->bounds[k] <= least[k] + slack && r->bounds[k] >= least[k] - texel - slack);
    assert_true(r->bounds[2 + k] >= most[k] - slack && r->bounds[2 + k] <= most[k] + texel + slack);
    assert_true(r->tile[0][k] <= r->bounds[k] - texel + slack && r->tile[0][2 + k] >= r->bounds[2 + k] + texel - slack);
    double steps = r->tile[0][k] / texel / (size / 32); /* blocks of a pyramid, too, lie on a grid of their own */
    assert_true(fabs(steps - round(steps)) < 1e-6);
  }
}

static void check_cover(bool sun, bool sheared) {
  uint64_t seed = sun ? 2 : 1;
  for (int round = 0; round < 2000; round++) {
    static pn_casters c;
    pni_frame f = frame_along_z(sun);
    pni_fit_request request = request_of(&f, 64);
    for (int k = 0; k < 2; k++) request.shear[k] = sheared ? random_in(&seed, -0.5, 0.5) : 0;
    random_boxes(&c, &seed, v3(0, 0, 5), 2, 2.5);
    pni_fit_result r = fit(&c, &request);
    extent3 e = exact_extent(&c, &f, request.shear);
    assert_false(r.empty || r.clamped);
    assert_int_equal(r.tiles, 1);
    assert_tight(&r, &e, 64);
    assert_true(r.w_far < e.least.z && e.most.z < r.w_near);
    if (sun) assert_true(r.w_near - r.w_far <= (e.most.z - e.least.z) * (1 + 8.0 / 64) + 1e-4);
    else assert_true(r.w_near <= e.most.z * (1 + 2.0 / 7) && r.w_far >= e.least.z * (1 - 2.0 / 8));
  }
}

static void test_cover(void **state) {
  (void)state;
  for (int i = 0; i < 4; i++) check_cover(i & 1, i & 2);
}

/* Boxes of a turned mesh count by their turned corners, not by a box around them. */
static void test_turned_instance(void **state) {
  (void)state;
  pni_box box = {{-1, -1, -0.01f}, {1, 1, 0.01f}};
  pni_mesh_data mesh = {.id = 1, .boxes = &box, .box_count = 1};
  double a = 0.7;
  pni_instance_data instance = {
      .id = 2, .scene_from_object = {{cos(a), sin(a), 0, 0, -sin(a), cos(a), 0, 0, 0, 0, 1, 0, 0.3, 0, 4, 1}}};
  pn_casters c = {.meshes = &mesh, .mesh_count = 1, .instances = &instance, .instance_count = 1};
  pni_frame f = frame_along_z(false);
  pni_fit_request request = request_of(&f, 64);
  pni_fit_result r = fit(&c, &request);
  extent3 e = {{1e30, 1e30, 1e30}, {-1e30, -1e30, -1e30}};
  for (int i = 0; i < 8; i++) {
    vec k = box_corner(&box, i), p = v3(cos(a) * k.x - sin(a) * k.y + 0.3, sin(a) * k.x + cos(a) * k.y, k.z + 4);
    vec m = map_of(&f, p);
    e.least = v3(fmin(e.least.x, m.x), fmin(e.least.y, m.y), 0);
    e.most = v3(fmax(e.most.x, m.x), fmax(e.most.y, m.y), 0);
  }
  assert_tight(&r, &e, 64);
}

/* ---- snapping ---- */

static pni_fit_result fit_two(double x, double y, double z, bool sun) {
  static pn_casters c;
  memset(&c, 0, sizeof c);
  put_box(&c, 0, v3(0, 0, 5), v3(1.7, 1.3, 0.5)); /* stays, and holds the bounds at three sides */
  put_box(&c, 1, v3(x, y, z), v3(0.2, 0.2, 0.2));
  pni_frame f = frame_along_z(sun);
  pni_fit_request request = request_of(&f, 100);
  return fit(&c, &request);
}

static void test_moving_inside(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int sun = 0; sun < 2; sun++) {
    pni_fit_result still = fit_two(0, 0, 5, sun);
    for (int i = 0; i < 2000; i++) {
      pni_fit_result moved =
          fit_two(random_in(&seed, -1.2, 1.2), random_in(&seed, -0.8, 0.8), random_in(&seed, 4.75, 5.25), sun);
      assert_memory_equal(&still, &moved, sizeof still);
    }
  }
}

/* Casters that fill any part of the snapped bounds which contains the first casters give the same bounds: what moves
 * inside them, up to their very edge, changes nothing. */
static void test_snapping_is_stable(void **state) {
  (void)state;
  uint64_t seed = 4;
  for (int i = 0; i < 5000; i++) {
    static pn_casters c;
    memset(&c, 0, sizeof c);
    pni_frame f = frame_along_z(true);
    pni_fit_request request = request_of(&f, 100);
    vec centre = random_point(&seed, 3), half = v3(exp2(random_in(&seed, -4, 2)), exp2(random_in(&seed, -4, 2)), 1);
    put_box(&c, 0, centre, half);
    pni_fit_result first = fit(&c, &request);
    /* A second box from a corner of the snapped bounds, a float's width inside, to somewhere in the first box. v is
     * -y. */
    double s = first.bounds[0] + 1e-6 * (1 + fabs(first.bounds[0])),
           t = first.bounds[3] - 1e-6 * (1 + fabs(first.bounds[3]));
    vec corner = v3(s, -t, centre.z), size = mul(0.5, sub(centre, corner));
    put_box(&c, 1, add(corner, size), v3(fabs(size.x), fabs(size.y), 0.5));
    pni_fit_result second = fit(&c, &request);
    assert_memory_equal(first.bounds, second.bounds, sizeof first.bounds);
    assert_true(first.w_near == second.w_near && first.w_far == second.w_far);
  }
}

/* As long as texels keep their size, they keep their places: ends that move put whole texels to the map, in blocks. */
static void test_texels_stay(void **state) {
  (void)state;
  uint64_t seed = 14;
  int same = 0;
  for (int i = 0; i < 4000; i++) {
    static pn_casters c;
    pni_frame f = frame_along_z(i & 1);
    pni_fit_request request = request_of(&f, 100);
    vec half = v3(random_in(&seed, 0.1, 2), random_in(&seed, 0.1, 2), 0.3), at = random_point(&seed, 1);
    pni_fit_result r[2];
    for (int step = 0; step < 2; step++) {
      memset(&c, 0, sizeof c);
      at.z = 5;
      put_box(&c, 0, at, half);
      r[step] = fit(&c, &request);
      at.x += random_in(&seed, -0.3, 0.3) * half.x;
      half.y *= random_in(&seed, 0.9, 1.1);
    }
    for (int k = 0; k < 2; k++) {
      double texel[2];
      for (int step = 0; step < 2; step++) texel[step] = (r[step].tile[0][2 + k] - r[step].tile[0][k]) / 100;
      if (fabs(texel[0] / texel[1] - 1) > 1e-9) continue;
      same++;
      double moved = (r[1].tile[0][k] - r[0].tile[0][k]) / texel[0];
      assert_true(fabs(moved - 2 * round(moved / 2)) < 1e-6); /* 100 / 32: the power of two below is 2 */
    }
  }
  assert_true(same > 3000);
}

/* ---- the light's plane ---- */

static void test_crossing_and_behind(void **state) {
  (void)state;
  static pn_casters c;
  pni_frame f = frame_along_z(false);
  pni_fit_request request = request_of(&f, 64);
  memset(&c, 0, sizeof c);
  put_box(&c, 0, v3(0, 0, -3), v3(1, 1, 1)); /* wholly behind */
  assert_true(fit(&c, &request).empty);
  put_box(&c, 1, v3(0.5, 0, 4), v3(0.5, 0.5, 0.5));
  pni_fit_result alone = fit(&c, &request);
  assert_false(alone.empty);
  c.callbacks[0].draw = NULL;
  pni_fit_result without = fit(&c, &request);
  assert_memory_equal(&alone, &without, sizeof alone);
  /* One that crosses the plane beside the light: what lies before the light is inside. */
  put_box(&c, 0, v3(2, 0, 1), v3(0.25, 0.25, 3));
  pni_fit_result crossing = fit(&c, &request);
  assert_false(crossing.empty);
  for (double z = 0.5; z <= 4; z += 0.25)
    for (int i = 0; i < 4; i++) {
      vec m = map_of(&f, v3(i & 1 ? 2.25 : 1.75, i & 2 ? 0.25 : -0.25, z));
      assert_true(m.x >= crossing.bounds[0] && m.x <= crossing.bounds[2]);
      assert_true(m.y >= crossing.bounds[1] && m.y <= crossing.bounds[3]);
      assert_true(m.z > crossing.w_far && m.z < crossing.w_near);
    }
}

/* What of a box lies nearer than 1/256 of the farthest caster is cut off: of a beam beside the light the map takes what
 * opens to x / (z_max / 256), though its near end opens four times as far. */
static void test_beam_beside_the_light(void **state) {
  (void)state;
  static pn_casters c;
  pni_frame f = frame_along_z(false);
  pni_fit_request request = request_of(&f, 64);
  memset(&c, 0, sizeof c);
  put_box(&c, 0, v3(0, 0, 9.5), v3(1, 1, 0.5));
  put_box(&c, 1, v3(0.055, 0, 0.505), v3(0.005, 0.005, 0.495)); /* z from 0.01 to 1 */
  pni_fit_result r = fit(&c, &request);
  double most = 0.06 / (10 / 256.0), step = 1 / 16.0; /* 32 to 64 steps in an extent of 1.6 to 2 */
  assert_true(r.bounds[2] >= most - 1e-6 && r.bounds[2] <= most + step);
}

static void test_near_and_range(void **state) {
  (void)state;
  static pn_casters c;
  pni_frame f = frame_along_z(false);
  pni_fit_request request = request_of(&f, 64);
  memset(&c, 0, sizeof c);
  put_box(&c, 0, v3(0, 0, 2), v3(0.25, 0.25, 0.5));
  put_box(&c, 1, v3(0, 0, 9), v3(3, 3, 0.5));
  pni_fit_result both = fit(&c, &request);
  request.range = 8; /* the second begins at 8.5 */
  pni_fit_result near = fit(&c, &request);
  assert_true(near.bounds[2] < both.bounds[2] && near.w_far > both.w_far);
  request.range = 8.75; /* part of it lies within */
  pni_fit_result reaching = fit(&c, &request);
  assert_memory_equal(&reaching, &both, sizeof both);
  request.range = 0;
  request.near_distance = 2; /* w_near: nearer casters are taken to be there */
  pni_fit_result clamped = fit(&c, &request);
  assert_true(clamped.w_near > 0.5 && clamped.w_near <= 0.5 * (1 + 2.0 / 7));
  request.near_distance = 20; /* all of them nearer: taken to be there, not left out */
  pni_fit_result all_near = fit(&c, &request);
  assert_false(all_near.empty);
  assert_true(all_near.bounds[2] >= both.bounds[2] && all_near.w_near > 0.05 && all_near.w_far < 0.05);
}

/* A caster so close to the light that the map's depth cannot reach it and the far one both. */
static void test_close_to_the_light(void **state) {
  (void)state;
  static pn_casters c;
  pni_frame f = frame_along_z(false);
  pni_fit_request request = request_of(&f, 64);
  memset(&c, 0, sizeof c);
  put_box(&c, 0, v3(0, 0, 0.01), v3(0.001, 0.001, 0.001));
  put_box(&c, 1, v3(0, 0, 100), v3(1, 1, 0.5));
  pni_fit_result r = fit(&c, &request);
  assert_true(r.bounds[2] >= 0.1 && r.bounds[0] <= -0.1); /* the small box opens wider than the large one */
}

/* ---- wide lights ---- */

static void assert_tiles_cover(const pni_fit_result *r) {
  double edges[2][2] = {{r->bounds[0], r->bounds[2]}, {r->bounds[1], r->bounds[3]}};
  uint64_t seed = 5;
  for (int i = 0; i < 20000; i++) {
    double at[2];
    for (int k = 0; k < 2; k++) /* over angles, so that every tile gets its share; and the very ends */
      at[k] = i < 4 ? edges[k][i >> k & 1] : tan(random_in(&seed, atan(edges[k][0]), atan(edges[k][1])));
    int found = 0;
    for (int t = 0; t < r->tiles; t++) {
      const double *b = r->tile[t];
      found += at[0] >= b[0] && at[0] <= b[2] && at[1] >= b[1] && at[1] <= b[3];
    }
    assert_true(found >= 1);
  }
}

static pni_fit_result fit_wall(double tangent, bool both_ways) {
  static pn_casters c;
  memset(&c, 0, sizeof c);
  put_box(&c, 0, v3(0, 0, 5), v3(5 * tangent, both_ways ? 5 * tangent : 1, 0));
  pni_frame f = frame_along_z(false);
  pni_fit_request request = request_of(&f, 64);
  return fit(&c, &request);
}

static void test_tiles(void **state) {
  (void)state;
  const double degree = 0.017453292519943295;
  for (double angle = 40; angle < 89; angle += 1) {
    pni_fit_result r = fit_wall(tan(angle * degree), false);
    double opening = (atan(r.bounds[2]) - atan(r.bounds[0])) / degree;
    assert_int_equal(r.tiles, opening > 120 ? (int)ceil(opening / 60) : 1);
    for (int t = 0; t < r.tiles && r.tiles > 1; t++) { /* 60 degrees at most, without the texel at each side */
      double texel = (r.tile[t][2] - r.tile[t][0]) / 64;
      assert_true((atan(r.tile[t][2] - texel) - atan(r.tile[t][0] + texel)) / degree < 60.001);
    }
    assert_tiles_cover(&r);
    if (angle < 84) assert_false(r.clamped);
    if (angle > 85) assert_true(r.clamped && r.bounds[2] == PNI_TANGENT_MAX && r.bounds[0] == -PNI_TANGENT_MAX);
  }
  pni_fit_result square = fit_wall(tan(80 * degree), true);
  assert_int_equal(square.tiles, 9);
  assert_tiles_cover(&square);
}

/* The warning says that casters are left out: it must not come when only the snapping reached over the limit. */
static void test_clamped_means_lost(void **state) {
  (void)state;
  for (double part = 0.9; part < 1; part += 0.001) {
    pni_fit_result r = fit_wall(part * PNI_TANGENT_MAX, false);
    assert_false(r.clamped);
    assert_true(r.bounds[2] <= PNI_TANGENT_MAX);
  }
}

/* ---- what a visible region keeps ---- */

static bool inside_box(const pni_region *g, vec m) {
  return m.x >= g->least[0] && m.x <= g->most[0] && m.y >= g->least[1] && m.y <= g->most[1] && m.z >= g->least[2] &&
         m.z <= g->most[2];
}

/* Points of a caster box, of the light and of the region, joined: whenever a caster's point lies between the light and
 * a receiver of the region, the map must hold it. And boxes that no such line meets should not widen the map: the tight
 * region says when. */
static void check_visible(bool sun, uint64_t seed, bool sheared) {
  static pn_casters c;
  pni_frame f = frame_along_z(sun);
  int hits = 0;
  for (int round = 0; round < 300; round++) {
    random_boxes(&c, &seed, v3(0, 0, 4), 3, 1.5);
    pni_region region = pni_region_empty();
    vec corner = v3(random_in(&seed, -4, 4), random_in(&seed, -4, 4), random_in(&seed, 3, 8)), some[8];
    for (int i = 0; i < 8; i++) { /* receivers, and the region they make */
      some[i] = add(corner, random_point(&seed, 0.5));
      vec m = map_of(&f, some[i]);
      for (int k = 0; k < 3; k++) {
        double value = k == 0 ? m.x : k == 1 ? m.y : m.z;
        region.least[k] = fmin(region.least[k], value);
        region.most[k] = fmax(region.most[k], value);
      }
    }
    static const pni_emission wide = {{0.8, 0.8}};
    pni_fit_request request = request_of(&f, 64);
    request.emission = &wide;
    for (int k = 0; k < 2 && sheared; k++) request.shear[k] = random_in(&seed, -0.8, 0.8);
    request.visible = &region;
    pni_fit_result r = fit(&c, &request);
    for (int i = 0; i < 2000; i++) {
      const vec p = some[i % 8];
      const pni_box *b = &c.callbacks[0].bounds;
      vec q = v3(random_in(&seed, b->min[0], b->max[0]), random_in(&seed, b->min[1], b->max[1]),
                 random_in(&seed, b->min[2], b->max[2]));
      vec mq = map_of(&f, q), mp = map_of(&f, p);
      if (!(mq.z > mp.z)) continue;
      double x = (mq.x - mp.x) / (mq.z - mp.z), y = (mq.y - mp.y) / (mq.z - mp.z);
      bool wanted = sheared ? fabs(x - request.shear[0]) < 1e-2 && fabs(y - request.shear[1]) < 1e-2
                            : fabs(x) <= 0.8 && fabs(y) <= 0.8;
      if (!wanted) continue;
      hits++;
      assert_false(r.empty);
      double s = mq.x - request.shear[0] * mq.z, t = mq.y - request.shear[1] * mq.z;
      assert_true(s >= r.bounds[0] && s <= r.bounds[2] && t >= r.bounds[1] && t <= r.bounds[3]);
      assert_true(mq.z > r.w_far && mq.z < r.w_near);
    }
    assert_true(inside_box(&region, map_of(&f, some[0])));
  }
  assert_true(sheared || hits > 1000);
}

static void test_visible_keeps(void **state) {
  (void)state;
  check_visible(false, 6, false);
  check_visible(true, 7, false);
  check_visible(false, 8, true);
  check_visible(true, 9, true);
}

/* ---- what lies in front of nothing ---- */

static double plane_at(const double plane[3], double s, double t) { return plane[2] + plane[0] * s + plane[1] * t; }

/* Patches of a plane with something standing on it here and there. */
static void random_view(pni_patch_list *list, pni_patch *patches, int count, const double plane[3], uint64_t *seed) {
  *list = (pni_patch_list){patches, count, count};
  for (int i = 0; i < count; i++) {
    pni_patch *p = &patches[i];
    double size = random_in(seed, 0.01, 0.2), above = i % 5 == 0 ? random_in(seed, 0.05, 0.3) : 0;
    *p = (pni_patch){.slope = {plane[0], plane[1]}, .offset = plane[2] + above, .error = 1e-7};
    p->least[2] = INFINITY;
    p->most[2] = -INFINITY;
    for (int k = 0; k < 2; k++) {
      p->least[k] = random_in(seed, -1, 1);
      p->most[k] = p->least[k] + size;
    }
    for (int c = 0; c < 4; c++) {
      double w = plane_at(plane, c & 1 ? p->most[0] : p->least[0], c & 2 ? p->most[1] : p->least[1]) + above;
      p->least[2] = fmin(p->least[2], w);
      p->most[2] = fmax(p->most[2], w);
    }
  }
}

/* Against the definition: a caster takes light from a point of a patch where it lies nearer, and within the window. */
static bool takes_light(const pni_patch *p, const double extent[2], const double q[3], uint64_t *seed) {
  for (int i = 0; i < 40; i++) {
    double s = i < 4 ? (i & 1 ? p->most[0] : p->least[0]) : random_in(seed, p->least[0], p->most[0]);
    double t = i < 4 ? (i & 2 ? p->most[1] : p->least[1]) : random_in(seed, p->least[1], p->most[1]);
    if (i == 4) s = fmin(fmax(q[0], p->least[0]), p->most[0]), t = fmin(fmax(q[1], p->least[1]), p->most[1]);
    double dw = q[2] - (p->offset + p->slope[0] * s + p->slope[1] * t);
    if (dw > 1e-6 && fabs(q[0] - s) <= extent[0] * dw && fabs(q[1] - t) <= extent[1] * dw) return true;
  }
  return false;
}

static void test_grid_keeps(void **state) {
  (void)state;
  static pni_patch patches[300];
  static pni_gpu gpu;
  static const pni_caster_error exact = {0};
  uint64_t seed = 15;
  int hits = 0, lost = 0;
  for (int round = 0; round < 30; round++) {
    double plane[3] = {random_in(&seed, -0.8, 0.8), random_in(&seed, -0.8, 0.8), 1}, extent[2] = {0.3, 0.5};
    pni_patch_list list;
    pni_grid *grid;
    random_view(&list, patches, 300, plane, &seed);
    assert_int_equal(pni_grid_make(&gpu, &list, extent, &grid), PN_OK);
    for (int i = 0; i < 300; i++) {
      double q[1][3] = {{random_in(&seed, -1.5, 1.5), random_in(&seed, -1.5, 1.5), 0}};
      q[0][2] = plane_at(plane, q[0][0], q[0][1]) + random_in(&seed, -0.2, 0.4);
      bool any = false;
      for (int k = 0; k < list.count && !any; k++) any = takes_light(&patches[k], extent, q[0], &seed);
      bool told = pni_grid_shadowed(grid, (const double(*)[3])q, 1, &exact);
      assert_true(told || !any);
      hits += any;
      /* the lemma: on a plane that nothing seen is below, nothing is shadowed */
      q[0][2] = plane_at(plane, q[0][0], q[0][1]) - random_in(&seed, 0, 0.1);
      lost += pni_grid_shadowed(grid, (const double(*)[3])q, 1, &exact);
    }
    double found[3];
    assert_true(pni_grid_plane(grid, found));
    for (int k = 0; k < 3; k++) assert_true(fabs(found[k] - plane[k]) < 1e-6);
    pni_grid_free(&gpu, &grid);
  }
  assert_true(hits > 1000 && lost == 0);
}

/* An image of a ground with a box on it: the box is found, to a sample on each side; the ground alone is nothing. */
static void test_trim(void **state) {
  (void)state;
  enum { SIZE = 128 };
  static pni_patch patches[200];
  static pni_gpu gpu;
  static float w[SIZE * SIZE];
  const double plane[3] = {0.4, -0.3, 2}, extent[2] = {0.1, 0.1}, box[4] = {-0.31, 0.12, 0.05, 0.44};
  uint64_t seed = 16;
  pni_patch_list list;
  pni_grid *grid;
  random_view(&list, patches, 200, plane, &seed);
  assert_int_equal(pni_grid_make(&gpu, &list, extent, &grid), PN_OK);
  for (int with_box = 0; with_box < 2; with_box++) {
    pni_trim_image image = {.w = w, .size = SIZE, .bounds = {-1, -1, 1, 1}, .error = {1e-6, {1e-6, 1e-6}}};
    for (int k = 0; k < SIZE * SIZE; k++) {
      double s = -1 + (k % SIZE + 0.5) * 2 / SIZE, t = -1 + (k / SIZE + 0.5) * 2 / SIZE;
      bool inside = with_box && s >= box[0] && s <= box[2] && t >= box[1] && t <= box[3];
      w[k] = (float)(plane_at(plane, s, t) + (inside ? 0.5 : 0));
    }
    double left[4];
    assert_int_equal(pni_trim_bounds(&image, grid, left), with_box);
    for (int k = 0; k < 2 && with_box; k++) {
      assert_true(left[k] <= box[k] && left[k] >= box[k] - 2 * 2.0 / SIZE);
      assert_true(left[2 + k] >= box[2 + k] && left[2 + k] <= box[2 + k] + 2 * 2.0 / SIZE);
    }
  }
  pni_grid_free(&gpu, &grid);
}

static void test_visible_cuts(void **state) {
  (void)state;
  static pn_casters c;
  pni_frame f = frame_along_z(false);
  pni_region region = {{-0.05, -0.05, 0.1}, {0.05, 0.05, 0.125}}; /* 8 to 10 before the light */
  pni_fit_request request = request_of(&f, 64);
  request.visible = &region;
  memset(&c, 0, sizeof c);
  put_box(&c, 0, v3(0, 0, 4), v3(0.1, 0.1, 0.1));
  pni_fit_result alone = fit(&c, &request);
  assert_false(alone.empty);
  put_box(&c, 1, v3(0, 0, 20), v3(5, 5, 1)); /* beyond every receiver */
  put_box(&c, 2, v3(3, 0, 4),
          v3(1, 0.5,
             0.5)); /* aside: s from 2 / 4.5, but the window at w = 1 / 3.5 ends at 0.05 + 0.5 (0.286 - 0.1) = 0.143 */
  pni_fit_result with = fit(&c, &request);
  assert_memory_equal(alone.bounds, with.bounds, sizeof alone.bounds);
  c.callbacks[0].draw = NULL;
  assert_true(fit(&c, &request).empty);
}

/* A camera's frustum: every point in it lies in the region that is made of it. */
static void test_frustum(void **state) {
  (void)state;
  uint64_t seed = 10;
  for (int round = 0; round < 400; round++) {
    bool sun = round & 1, infinite = round & 2, zero_to_one = round & 4;
    pni_frame f = frame_along_z(sun);
    double near = 0.5, far = 6, low = zero_to_one ? 0 : -1;
    double b = (1 - low) / (infinite ? -1 / near : 1 / far - 1 / near), a = infinite ? 1 : 1 - b / far;
    pni_matrix projection = {{1.2, 0, 0, 0, 0, 1.5, 0, 0, 0.1, -0.2, -a, -1, 0, 0, b, 0}};
    vec back = random_direction(&seed), right = unit(cross(random_direction(&seed), back)), up = cross(back, right);
    vec eye = random_point(&seed, 4);
    pni_matrix camera = {{right.x, up.x, back.x, 0, right.y, up.y, back.y, 0, right.z, up.z, back.z, 0,
                          -dot(right, eye), -dot(up, eye), -dot(back, eye), 1}};
    pni_matrix clip = pni_matrix_multiply(&projection, &camera), inverse;
    assert_true(pni_matrix_invert(&clip, &inverse));
    pni_region region = pni_region_empty();
    pni_region_add_frustum(&region, &f, &inverse, low);
    for (int i = 0; i < 200; i++) {
      double at[4] = {random_in(&seed, -1, 1), random_in(&seed, -1, 1), random_in(&seed, low, infinite ? 0.999 : 1), 1},
             h[4];
      pni_matrix_apply(&inverse, at, h);
      vec p = v3(h[0] / h[3], h[1] / h[3], h[2] / h[3]);
      if (!sun && p.z <= 1e-6) continue; /* v = -y, so z is the light's z */
      vec m = map_of(&f, p);
      for (int k = 0; k < 3; k++) {
        double value = k == 0 ? m.x : k == 1 ? m.y : m.z, slack = 1e-9 * (1 + fabs(value));
        if (!(value >= region.least[k] - slack && value <= region.most[k] + slack))
          fail_msg("round %d: coordinate %d is %g, not in %g .. %g", round, k, value, region.least[k], region.most[k]);
      }
    }
  }
}

/* ---- oddities ---- */

static void test_flat(void **state) {
  (void)state;
  static pn_casters c;
  const vec halves[] = {{0, 1, 1}, {1, 0, 1}, {0, 0, 1}, {0, 0, 0}, {1, 1, 0}};
  for (int sun = 0; sun < 2; sun++)
    for (int i = 0; i < 5; i++) {
      pni_frame f = frame_along_z(sun);
      pni_fit_request request = request_of(&f, 64);
      memset(&c, 0, sizeof c);
      put_box(&c, 0, v3(0, 0, 5), halves[i]);
      pni_fit_result r = fit(&c, &request);
      double none[2] = {0, 0};
      extent3 e = exact_extent(&c, &f, none);
      assert_false(r.empty);
      assert_true(r.bounds[0] < r.bounds[2] && r.bounds[1] < r.bounds[3]);
      assert_true(r.bounds[0] <= e.least.x && r.bounds[2] >= e.most.x && r.bounds[1] <= e.least.y &&
                  r.bounds[3] >= e.most.y);
      assert_true(r.w_far < e.least.z && e.most.z < r.w_near);
    }
  memset(&c, 0, sizeof c);
  pni_frame f = frame_along_z(false);
  pni_fit_request request = request_of(&f, 64);
  assert_true(fit(&c, &request).empty);
  put_box(&c, 3, v3(0, 0, 5), v3(1, 1, 1));
  pni_fit_result r;
  pni_fit_maps(&c, ~8u, &request, &r); /* groups */
  assert_true(r.empty);
}

static void test_given(void **state) {
  (void)state;
  static pn_casters c;
  memset(&c, 0, sizeof c);
  put_box(&c, 0, v3(0, 0, 3), v3(2, 2, 0.5));
  pni_frame f = frame_along_z(false);
  pni_fit_request request = request_of(&f, 64);
  const float given[6] = {-0.3f, -0.7f, 4, 1.1f, 0.9f, 5};
  request.given = given;
  pni_fit_result r = fit(&c, &request);
  /* t = -y / z; the box at its nearer side */
  const double want[4] = {-0.3f / 4.0, -0.9f / 4.0, 1.1f / 4.0, 0.7f / 4.0};
  for (int k = 0; k < 4; k++) {
    assert_true(fabs(r.bounds[k] - want[k]) < 1e-12);
    assert_true(r.tile[0][k] == r.bounds[k]); /* no border */
  }
  assert_int_equal(r.tiles, 1);
  assert_true(r.w_near > 1 / 2.5 && r.w_far < 1 / 3.5); /* depth is the casters' */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_cover),
      cmocka_unit_test(test_turned_instance),
      cmocka_unit_test(test_moving_inside),
      cmocka_unit_test(test_snapping_is_stable),
      cmocka_unit_test(test_crossing_and_behind),
      cmocka_unit_test(test_beam_beside_the_light),
      cmocka_unit_test(test_near_and_range),
      cmocka_unit_test(test_close_to_the_light),
      cmocka_unit_test(test_tiles),
      cmocka_unit_test(test_clamped_means_lost),
      cmocka_unit_test(test_visible_keeps),
      cmocka_unit_test(test_visible_cuts),
      cmocka_unit_test(test_texels_stay),
      cmocka_unit_test(test_grid_keeps),
      cmocka_unit_test(test_trim),
      cmocka_unit_test(test_frustum),
      cmocka_unit_test(test_flat),
      cmocka_unit_test(test_given),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
