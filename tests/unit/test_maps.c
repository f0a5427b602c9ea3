/* Depth maps as they are drawn: against closed forms, layer by layer, texel by texel. */
#include <stdlib.h>
#include <string.h>

#include "gl/bound.h"
#include "gl/state.h"
#include "maps/maps.h"
#include "maps/range.h"
#include "stage.h"

#include "context.h"

/* A light at the origin along z, u along x, v = u x z along -y: so t = -y w. */
typedef struct {
  stage s;
  pni_gpu *gpu;
  pni_frame frame;
  pni_maps maps;
  pni_map_draw draw;
  pni_emission emission;
} bench;

static void bench_open(bench *b, bool sun) {
  static const float z[3] = {0, 0, 1}, u[3] = {1, 0, 0};
  memset(b, 0, sizeof *b);
  stage_open(&b->s);
  b->gpu = &b->s.context->gpu;
  assert_true(pni_frame_axes(z, u, &b->frame));
  b->frame.projection = sun ? PNI_PARALLEL : PNI_CENTRAL;
  b->emission = (pni_emission){{0.5, 0.5}};
  b->draw = (pni_map_draw){.frame = &b->frame,
                           .casters = b->s.casters,
                           .groups = PN_GROUPS_ALL,
                           .bounds = {-1, -1, 1, 1},
                           .w_near = sun ? -1 : 1,
                           .w_far = sun ? -9 : 0.1};
}

static void bench_close(bench *b) {
  pni_maps_free(b->gpu, &b->maps, false);
  stage_close(&b->s);
}

static void bench_draw(bench *b, const pni_maps_want *want, int width, int height) {
  assert_ok(pni_maps_shape(b->gpu, &b->maps, want, 1, width, height));
  pni_maps_describe(b->gpu, &b->maps, &b->frame, &b->emission);
  assert_ok(pni_maps_add(b->gpu, &b->maps, &b->draw));
  if (want->range.structure) {
    pni_buffer buffer = {0};
    const pni_light_block *block = &b->maps.block;
    assert_ok(pni_buffer_fill(b->gpu, &buffer, "light", PNI_BUFFER_BLOCK, block, sizeof *block));
    pni_bind_block(b->gpu, &buffer);
    assert_ok(pni_range_build(b->gpu, &b->maps));
    pni_buffer_free(b->gpu, &buffer, false);
  }
  pni_state_reset(b->gpu);
  pni_forget(b->gpu);
}

static float *layer_of(const bench *b, int layer) {
  return gl_read_depth(b->maps.depth.id, layer, b->maps.depth.width, b->maps.depth.height);
}

static double w_of(const bench *b, double depth) {
  double scale[2];
  pni_depth_scale(b->draw.w_near, b->draw.w_far, scale);
  return scale[0] + scale[1] * depth;
}

static const pni_maps_want one_layer = {.near_layers = 1};

/* ---- one plane ---- */

/* Where the plane n . P = c shows at (s, t): rectangle w = (n_x s + n_y t + n_z) / c, sun n_x s + n_y t - n_z w = c. */
static double plane_w(const bench *b, vec n, double c, double s, double t) {
  double along = n.x * s - n.y * t;
  return (b->frame.projection == PNI_PARALLEL) ? (along - c) / n.z : (along + n.z) / c;
}

/* The block says what error it expects: of a stored depth in w, and of the raster in texels, which a slope turns into
 * w. */
static void check_plane(bool sun, uint64_t *seed, int width, int height) {
  bench b;
  bench_open(&b, sun);
  double s = random_in(seed, -0.5, 0.5), t = random_in(seed, -0.5, 0.5);
  const double bounds[4] = {s - random_in(seed, 0.05, 0.6), t - random_in(seed, 0.05, 0.6), s + 0.2, t + 0.3};
  memcpy(b.draw.bounds, bounds, sizeof bounds);
  vec n = unit(v3(random_in(seed, -0.4, 0.4), random_in(seed, -0.4, 0.4), 1));
  double c = 4 * n.z; /* through (0, 0, 4) */
  vec across = unit(cross(n, v3(0, 1, 0))), along = cross(n, across);
  soup plane = {0};
  soup_patch(&plane, v3(0, 0, 4), mul(12, across), mul(12, along));
  stage_cast(&b.s, &plane);
  bench_draw(&b, &one_layer, width, height);
  float *depth = layer_of(&b, 0);
  double ds = (bounds[2] - bounds[0]) / width, dt = (bounds[3] - bounds[1]) / height;
  double slope = fabs(plane_w(&b, n, c, ds, dt) - plane_w(&b, n, c, 0, dt)) +
                 fabs(plane_w(&b, n, c, ds, dt) - plane_w(&b, n, c, ds, 0));
  /* The soup's floats move its corners by half a unit in the last place of 12. */
  double allowed = b.maps.block.w_error + b.maps.block.raster_error * slope + 12 * 0x1p-24 * (sun ? 4 : 1);
  for (int i = 0; i < width * height; i++) {
    double at_s = bounds[0] + (i % width + 0.5) * ds, at_t = bounds[1] + (i / width + 0.5) * dt;
    double want = plane_w(&b, n, c, at_s, at_t), found = w_of(&b, depth[i]);
    if (!(fabs(found - want) <= allowed))
      fail_msg("texel %d, %d of %d x %d: w %.9g, not %.9g +- %.3g", i % width, i / width, width, height, found, want,
               allowed);
  }
  free(depth);
  soup_free(&plane);
  bench_close(&b);
}

static void test_plane(void **state) {
  (void)state;
  static const int sizes[][2] = {{64, 64}, {33, 17}, {1, 1}, {2, 9}, {300, 5}};
  uint64_t seed = 1;
  for (int sun = 0; sun < 2; sun++)
    for (int i = 0; i < 5; i++) check_plane(sun, &seed, sizes[i][0], sizes[i][1]);
}

/* ---- layers ---- */

enum { QUADS = 6 };
static const double distances[QUADS] = {2, 3, 4, 5, 6, 7};

/* Parallel squares, half as wide as the map at their distances, added in an order of no meaning; nested: the nearer the
 * smaller. */
static void cast_stack(bench *b) {
  static const int order[QUADS] = {3, 0, 5, 1, 4, 2};
  for (int i = 0; i < QUADS; i++) {
    soup quad = {0};
    double z = distances[order[i]], half = (b->frame.projection == PNI_PARALLEL) ? 0.5 : 0.5 * z;
    soup_patch(&quad, v3(0, 0, z), v3(half, 0, 0), v3(0, half, 0));
    stage_cast(&b->s, &quad);
    soup_free(&quad);
  }
}

static bool inside_half(int texel, int size) { return texel >= size / 4 && texel < size - size / 4; }

static void check_layer(const bench *b, int layer, double z, float nothing) {
  float *depth = layer_of(b, layer);
  int size = b->maps.depth.width;
  double w = (b->frame.projection == PNI_PARALLEL) ? -z : 1 / z;
  for (int i = 0; i < size * size; i++) {
    if (z > 0 && inside_half(i % size, size) && inside_half(i / size, size))
      assert_true(fabs(w_of(b, depth[i]) - w) <= b->maps.block.w_error);
    else assert_true(depth[i] == nothing);
  }
  free(depth);
}

static void test_layers(void **state) {
  (void)state;
  for (int sun = 0; sun < 2; sun++)
    for (int layers = 1; layers <= QUADS + 2; layers++) {
      bench b;
      bench_open(&b, sun);
      cast_stack(&b);
      const pni_maps_want want = {.near_layers = layers, .farthest = layers & 1};
      bench_draw(&b, &want, 16, 16);
      assert_int_equal(b.maps.depth.layers, layers + (layers & 1));
      for (int i = 0; i < layers; i++) check_layer(&b, i, i < QUADS ? distances[i] : 0, 1);
      if (want.farthest) check_layer(&b, layers, distances[QUADS - 1], 0);
      bench_close(&b);
    }
}

static void test_farthest_alone(void **state) {
  (void)state;
  bench b;
  bench_open(&b, false);
  const pni_maps_want want = {.farthest = true};
  bench_draw(&b, &want, 16, 16); /* nothing casts */
  check_layer(&b, 0, 0, 0);
  cast_stack(&b);
  bench_draw(&b, &want, 16, 16);
  check_layer(&b, 0, distances[QUADS - 1], 0);
  bench_close(&b);
}

/* The faces of a block that a pass asks for: front faces are those whose outside the light sees. */
static void test_faces(void **state) {
  (void)state;
  static const struct {
    pn_faces faces;
    double nearest, farthest;
  } cases[] = {{PN_FACES_ANY, 3, 5}, {PN_FACES_FRONT, 3, 3}, {PN_FACES_BACK, 5, 5}};
  for (int i = 0; i < 3; i++) {
    bench b;
    soup block = {0};
    bench_open(&b, true);
    soup_block(&block, v3(0, 0, 4), v3(2, 0, 0), v3(0, 2, 0), v3(0, 0, 1));
    stage_cast(&b.s, &block);
    const pni_maps_want want = {
        .near_layers = 1, .farthest = true, .near_faces = cases[i].faces, .far_faces = cases[i].faces};
    bench_draw(&b, &want, 4, 4);
    float *near = layer_of(&b, 0), *far = layer_of(&b, 1);
    for (int k = 0; k < 16; k++) {
      assert_true(fabs(w_of(&b, near[k]) + cases[i].nearest) <= b.maps.block.w_error);
      assert_true(fabs(w_of(&b, far[k]) + cases[i].farthest) <= b.maps.block.w_error);
    }
    free(near);
    free(far);
    soup_free(&block);
    bench_close(&b);
  }
}

/* Many peeled layers of slanted sheets that cross each other: each texel's layers, sorted by hand. */
static void test_crossing_layers(void **state) {
  (void)state;
  enum { SHEETS = 7, SIZE = 24 };
  uint64_t seed = 2;
  bench b;
  bench_open(&b, true);
  vec normals[SHEETS];
  double offsets[SHEETS];
  for (int i = 0; i < SHEETS; i++) {
    vec n = unit(v3(random_in(&seed, -1, 1), random_in(&seed, -1, 1), 1)), across = unit(cross(n, v3(0, 1, 0)));
    normals[i] = n;
    offsets[i] = n.z * random_in(&seed, 4, 6);
    soup sheet = {0};
    soup_patch(&sheet, v3(0, 0, offsets[i] / n.z), mul(9, across), mul(9, cross(n, across)));
    stage_cast(&b.s, &sheet);
    soup_free(&sheet);
  }
  const pni_maps_want want = {.near_layers = SHEETS};
  bench_draw(&b, &want, SIZE, SIZE);
  float *layers[SHEETS];
  for (int k = 0; k < SHEETS; k++) layers[k] = layer_of(&b, k);
  int compared = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    double w[SHEETS], s = -1 + (i % SIZE + 0.5) * 2 / SIZE, t = -1 + (i / SIZE + 0.5) * 2 / SIZE, gap = 1;
    for (int k = 0; k < SHEETS; k++) { /* insertion, largest first */
      double value = plane_w(&b, normals[k], offsets[k], s, t);
      int at = k;
      for (; at > 0 && w[at - 1] < value; at--) w[at] = w[at - 1];
      w[at] = value;
    }
    double allowed =
        b.maps.block.w_error + b.maps.block.raster_error * 4.0 / SIZE + 1e-5; /* slopes up to 2 along s and t */
    for (int k = 1; k < SHEETS; k++) gap = fmin(gap, w[k - 1] - w[k]);
    if (gap < 4 * allowed) continue; /* two at one depth are one layer */
    compared++;
    for (int k = 0; k < SHEETS; k++) assert_true(fabs(w_of(&b, layers[k][i]) - w[k]) <= allowed);
  }
  assert_true(compared > SIZE * SIZE / 2);
  for (int k = 0; k < SHEETS; k++) free(layers[k]);
  bench_close(&b);
}

/* ---- the ends of the range ---- */

/* Nearer than w_near: at the near end, and still something. Behind the light: nothing. */
static void test_near_and_behind(void **state) {
  (void)state;
  bench b;
  soup near = {0}, behind = {0}, crossing = {0};
  bench_open(&b, false);
  soup_patch(&behind, v3(0, 0, -3), v3(1, 0, 0), v3(0, 1, 0));
  stage_cast(&b.s, &behind);
  bench_draw(&b, &one_layer, 8, 8);
  check_layer(&b, 0, 0, 1);
  soup_patch(&near, v3(0, 0, 0.25), v3(1, 0, 0), v3(0, 1, 0));
  pn_instance instance = stage_cast(&b.s, &near);
  bench_draw(&b, &one_layer, 8, 8);
  float *depth = layer_of(&b, 0);
  for (int i = 0; i < 64; i++) {
    assert_true(depth[i] > 0 && depth[i] < 1);
    assert_true(fabs(w_of(&b, depth[i]) - b.draw.w_near) <= b.maps.block.w_error);
  }
  free(depth);
  assert_ok(pn_instance_remove(b.s.casters, instance));
  /* A wall through the light's plane, at x = 1: in the map where s = 1 / z, from z = 1.25 on. */
  soup_patch(&crossing, v3(1, 0, 0), v3(0, 5, 0), v3(0, 0, 5));
  stage_cast(&b.s, &crossing);
  bench_draw(&b, &one_layer, 10, 10);
  depth = layer_of(&b, 0);
  for (int i = 0; i < 100; i++) {
    double s = -1 + (i % 10 + 0.5) * 0.2;
    if (s < 0.15) /* the wall ends at z = 5 */
      assert_true(depth[i] == 1);
    else if (s > 0.25)
      assert_true(fabs(w_of(&b, depth[i]) - s) <= b.maps.block.w_error + b.maps.block.raster_error * 0.2);
  }
  free(depth);
  soup_free(&near);
  soup_free(&behind);
  soup_free(&crossing);
  bench_close(&b);
}

/* ---- ranges ---- */

typedef struct {
  double most, least;
} range2;

static range2 join(range2 a, range2 b) { return (range2){fmax(a.most, b.most), fmin(a.least, b.least)}; }

/* What the first level holds at a texel: its own w, or where blocks of quads are to have all their corners, that of the
 * quad it is the lower left corner of. Nothing is beyond the map. */
static range2 first_level(const bench *b, const float *depth, int x, int y) {
  const pni_range_kind *kind = &b->maps.want.range;
  int width = b->maps.depth.width, height = b->maps.depth.height, size = kind->quads && kind->least_there ? 2 : 1;
  range2 range = {-1e30, 1e30};
  for (int k = 0; k < size * size; k++) {
    int i = x + k % size, j = y + k / size;
    bool something = i >= 0 && j >= 0 && i < width && j < height && depth[j * width + i] < 1;
    double w = something ? w_of(b, depth[j * width + i]) : -1e30;
    range = join(range, (range2){w, w});
  }
  return range;
}

static range2 over(const bench *b, const float *depth, int x0, int y0, int x1, int y1) {
  range2 range = {-1e30, 1e30};
  for (int y = y0; y < y1; y++)
    for (int x = x0; x < x1; x++) range = join(range, first_level(b, depth, x, y));
  return range;
}

/* Float arithmetic of scale and depth: one product, one sum, of terms up to 1. */
static void assert_range(const float *found, range2 want) {
  assert_true(fabs(found[0] - want.most) <= (want.most < -1e29 ? 1e24 : 4 * 0x1p-24));
  assert_true(fabs(found[1] - want.least) <= (want.least < -1e29 ? 1e24 : 4 * 0x1p-24));
}

static int at_least(int a, int b) { return a > b ? a : b; }
static int at_most(int a, int b) { return a < b ? a : b; }

/* Level i over blocks of 2^i texels a side, down to one block, however long the map is. */
static void check_pyramid(const bench *b) {
  const pni_texture *range = &b->maps.range;
  float *depth = layer_of(b, 0);
  assert_true(range->width >= b->maps.depth.width && range->height >= b->maps.depth.height);
  for (int level = 0; level < range->levels; level++) {
    int w = at_least(range->width >> level, 1), h = at_least(range->height >> level, 1);
    float *found = gl_read_texture(range->id, level, 0, w, h, 2);
    for (int i = 0; i < w * h; i++) {
      int x = (i % w) << level, y = (i / w) << level, size = 1 << level;
      assert_range(found + 2 * i,
                   over(b, depth, x, y, at_most(x + size, range->width), at_most(y + size, range->height)));
    }
    free(found);
    if (level == range->levels - 1) assert_true(w == 1 && h == 1);
  }
  free(depth);
}

/* Level i, a layer of the array, over the 2^i x 2^i texels around each texel, as far as the map has them. */
static void check_stack(const bench *b) {
  const pni_texture *range = &b->maps.range;
  int width = b->maps.depth.width, height = b->maps.depth.height;
  float *depth = layer_of(b, 0);
  assert_true(range->width == width && range->height == height && 1 << (range->layers - 1) >= at_least(width, height));
  for (int level = 0; level < range->layers; level++) {
    float *found = gl_read_texture(range->id, 0, level, width, height, 2);
    int before = (1 << level) / 2, after = (1 << level) - before;
    for (int i = 0; i < width * height; i++) {
      int x = i % width, y = i / width;
      assert_range(found + 2 * i, over(b, depth, at_least(x - before, 0), at_least(y - before, 0),
                                       at_most(x + after, width), at_most(y + after, height)));
    }
    free(found);
  }
  free(depth);
}

static void cast_leaves(bench *b, uint64_t seed) {
  for (int i = 0; i < 40; i++) {
    soup leaf = {0};
    vec at = random_point(&seed, 3);
    at.z = random_in(&seed, 2, 8);
    soup_patch(&leaf, at, mul(0.7, random_direction(&seed)), mul(0.7, random_direction(&seed)));
    stage_cast(&b->s, &leaf);
    soup_free(&leaf);
  }
}

/* Small maps with several layers: every size and number of them can be drawn. */
static void test_small_layered(void **state) {
  (void)state;
  for (int structure = PNI_RANGE_PYRAMID; structure <= PNI_RANGE_STACK; structure++)
    for (int i = 0; i < 64; i++) {
      const pni_maps_want want = {
          .near_layers = 1 + i % 4, .farthest = i & 1, .range = {(pni_range_structure)structure, false, false}};
      bench b;
      bench_open(&b, false);
      cast_leaves(&b, 4);
      bench_draw(&b, &want, 1 + i / 4 % 4, 1 + i / 16);
      if (structure == PNI_RANGE_PYRAMID) check_pyramid(&b);
      bench_close(&b);
    }
}

static void check_ranges(pni_range_structure structure, void (*check)(const bench *)) {
  static const int more[][2] = {{64, 64}, {100, 37}, {1, 64}, {65, 2}};
  for (int kind = 0; kind < 3; kind++) {
    const pni_maps_want want = {.near_layers = 1, .range = {structure, kind > 0, kind > 1}};
    bench b;
    bench_open(&b, false);
    cast_leaves(&b, 3);
    for (int i = 0; i < 81; i += 5 - TEST_ROUNDS(4)) {
      bench_draw(&b, &want, 1 + i % 9, 1 + i / 9);
      check(&b);
    }
    for (int i = 0; i < 4; i++) {
      bench_draw(&b, &want, more[i][0], more[i][1]);
      check(&b);
    }
    bench_close(&b);
  }
}

static void test_pyramid(void **state) {
  (void)state;
  check_ranges(PNI_RANGE_PYRAMID, check_pyramid);
}

static void test_stack(void **state) {
  (void)state;
  check_ranges(PNI_RANGE_STACK, check_stack);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_plane),   cmocka_unit_test(test_layers),          cmocka_unit_test(test_farthest_alone),
      cmocka_unit_test(test_faces),   cmocka_unit_test(test_crossing_layers), cmocka_unit_test(test_near_and_behind),
      cmocka_unit_test(test_pyramid), cmocka_unit_test(test_stack),           cmocka_unit_test(test_small_layered),
  };
  return GL_RUN("maps", tests);
}
