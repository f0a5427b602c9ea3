/* Range pyramid, range stack and the hybrid of both over every layer of every tile, as techniques have them drawn:
 * largest and smallest w of each neighbourhood, texel by texel. test_maps.c looks at sizes and levels of single maps.
 * */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "light.h"
#include "stage.h"

static double w_at(const pni_maps *maps, int map, const float *depth, int x, int y) {
  bool inside = x >= 0 && y >= 0 && x < maps->depth.width && y < maps->depth.height;
  double d = inside ? depth[y * maps->depth.width + x] : 0;
  return d <= 0 || d >= 1 ? -1e30 : maps->block.maps[map].w_of_depth[0] + maps->block.maps[map].w_of_depth[1] * d;
}

/* Over texels from (x0, y0) up to, not including, (x1, y1); for a descent over quads each brings its right and upper
 * neighbours.
 * found: largest, smallest, and where it is kept the smallest of what is there. */
static void assert_range(const pni_maps *maps, int map, const float *depth, const int box[4], const float *found) {
  int more = maps->want.range.quads && maps->want.range.least_there ? 1 : 0;
  double most = -1e30, least = 1e30, there = 1e30;
  for (int y = box[1]; y < box[3] + more; y++)
    for (int x = box[0]; x < box[2] + more; x++) {
      most = fmax(most, w_at(maps, map, depth, x, y));
      least = fmin(least, w_at(maps, map, depth, x, y));
      if (w_at(maps, map, depth, x, y) > -1e30) there = fmin(there, w_at(maps, map, depth, x, y));
    }
  const double want[3] = {most, least, there};
  /* One product and one sum in float. */
  for (int i = 0; i < (maps->want.range.least_there ? 3 : 2); i++) {
    double allowed =
        fabs(want[i]) > 1e29
            ? 1e24
            : 4 * 0x1p-24 * (fabs(maps->block.maps[map].w_of_depth[0]) + fabs(maps->block.maps[map].w_of_depth[1]));
    if (!(fabs(found[i] - want[i]) <= allowed))
      fail_msg("map %d, texels %d..%d x %d..%d: %.9g, not %.9g", map, box[0], box[2], box[1], box[3], found[i],
               want[i]);
  }
}

static int at_most(int a, int b) { return a < b ? a : b; }
static int at_least(int a, int b) { return a > b ? a : b; }

/* The hybrid: blocks of 1, 2 and 4 texels, and above them neighbourhoods of blocks of 4, in cells: see maps/range.c. */
static void check_hybrid(const pni_maps *maps, int index, const float *depth) {
  static const int cells[][2] = {{0, 0}, {2, 0}, {3, 0}, {2, 1}, {3, 1}, {0, 2}, {1, 2}, {2, 2}};
  const pni_texture *range = &maps->range;
  int width = range->width, height = range->height, channels = maps->want.range.quads ? 4 : 2;
  float *first = gl_read_texture(range->id, 0, 2 * index, width, height, channels);
  float *above = gl_read_texture(range->id, 0, 2 * index + 1, width, height, channels);
  for (int level = 0, done = 0; !done; level++) {
    int shrink = at_most(level, 2), w = width >> shrink, h = height >> shrink, size = 1 << (level - shrink);
    done = level >= 2 && size >= at_least(w, h);
    for (int i = 0; i < w * h; i++) {
      int x = i % w, y = i / w, cell_x = level ? cells[level - 1][0] * width / 4 : 0,
          cell_y = level ? cells[level - 1][1] * height / 4 : 0;
      const int box[4] = {at_least(x - size / 2, 0) << shrink, at_least(y - size / 2, 0) << shrink,
                          at_most(x + size - size / 2, w) << shrink, at_most(y + size - size / 2, h) << shrink};
      assert_range(maps, index / pni_want_layers(&maps->want), depth, box,
                   (level ? above : first) + channels * ((y + cell_y) * width + x + cell_x));
    }
  }
  free(first);
  free(above);
}

static void check_layer(const pni_maps *maps, int index) {
  const pni_texture *range = &maps->range;
  int width = maps->depth.width, height = maps->depth.height, map = index / pni_want_layers(&maps->want);
  bool stack = maps->want.range.structure == PNI_RANGE_STACK;
  int levels = stack ? range->layers / maps->depth.layers : range->levels;
  float *depth = gl_read_depth(maps->depth.id, index, width, height);
  if (maps->want.range.structure == PNI_RANGE_HYBRID) {
    check_hybrid(maps, index, depth);
    free(depth);
    return;
  }
  int channels = maps->want.range.least_there ? 3 : 2;
  for (int level = 0; level < levels; level++) {
    int w = stack ? width : at_least(range->width >> level, 1),
        h = stack ? height : at_least(range->height >> level, 1), size = 1 << level;
    float *found = stack ? gl_read_texture(range->id, 0, index * levels + level, w, h, channels)
                         : gl_read_texture(range->id, level, index, w, h, channels);
    for (int i = 0; i < w * h; i++) {
      int x = i % w, y = i / w;
      /* Fig. 7: the neighbourhood is centred, half of it before its texel; the border is clamped. A pyramid's blocks
       * are padded with nothing. */
      const int around[4] = {at_least(x - size / 2, 0), at_least(y - size / 2, 0), at_most(x + size - size / 2, width),
                             at_most(y + size - size / 2, height)};
      const int block[4] = {x * size, y * size, at_most((x + 1) * size, range->width),
                            at_most((y + 1) * size, range->height)};
      assert_range(maps, map, depth, stack ? around : block, found + channels * i);
    }
    free(found);
  }
  free(depth);
}

/* Leaves all around below a light; wide: so near that the map splits into tiles. */
static void look(const char *spec, bool wide, int width, int height) {
  stage s;
  soup leaves = {0};
  uint64_t seed = 9;
  stage_open(&s);
  for (int i = 0; i < 60; i++) {
    vec at = v3(random_in(&seed, -3, 3), random_in(&seed, wide ? -0.9 : -5, wide ? -0.5 : -3), random_in(&seed, -3, 3));
    soup_patch(&leaves, at, mul(0.4, random_direction(&seed)), mul(0.4, random_direction(&seed)));
  }
  stage_cast(&s, &leaves);
  pn_light_desc light = light_at(v3(0, 0, 0), v3(0, -1, 0), 0.5, 0.5, width);
  light.map_height = height;
  assert_ok(pn_light_technique(s.light, spec, NULL, 0));
  assert_ok(pn_light_set(s.light, &light));
  assert_ok(pn_maps_update(s.light, s.casters, PN_GROUPS_ALL, NULL, 0));
  const pni_maps *maps = &s.light->maps;
  int tiles = (int)maps->block.map_count;
  assert_true(wide ? tiles > 1 : tiles == 1);
  assert_int_equal(maps->depth.layers, tiles * pni_want_layers(&maps->want));
  for (int i = 0; i < tiles * pni_want_layers(&maps->want); i++) check_layer(maps, i);
  soup_free(&leaves);
  stage_close(&s);
}

static const char *const kinds[] = {"bitmask:maps=two-sided,primitive=quad,merge=0,hierarchy=",
                                    "bitmask:maps=layers,layers=3,primitive=patch,merge=0,hierarchy=",
                                    "bitmask:maps=layers,layers=2,primitive=quad,focus=40,merge=0,hierarchy=",
                                    "bitmask:maps=two-sided,primitive=quad,merge=1,focus=60,hierarchy=",
                                    "backprojection:primitive=patch,merge=1,hierarchy="};

static void check(const char *hierarchy) {
  static const int sizes[][2] = {{1, 1}, {17, 17}, {16, 5}, {3, 20}};
  for (int i = 0; i < 5; i++)
    for (int wide = 0; wide < 2; wide++)
      for (int k = 0; k < 4; k++) {
        char spec[128];
        snprintf(spec, sizeof spec, "%s%s", kinds[i], hierarchy);
        look(spec, wide, sizes[k][0], sizes[k][1]);
      }
}

static void test_pyramid(void **state) {
  (void)state;
  check("hsm");
}

static void test_stack(void **state) {
  (void)state;
  check("mssm");
}

static void test_hybrid(void **state) {
  (void)state;
  check("hybrid");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_pyramid), cmocka_unit_test(test_stack),
                                     cmocka_unit_test(test_hybrid)};
  return GL_RUN("ranges of layers", tests);
}
