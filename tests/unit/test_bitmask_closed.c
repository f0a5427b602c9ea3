/* Scenes with a closed form for backprojection and bitmask, and bad ones: a plate parallel to a light, one that is
 * tilted, lights inside casters, maps of one texel, windows as large as the map. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "over_ground.h"

enum { SIZE = 24 };

typedef over_ground scene;

static void scene_open(scene *c, double half_height) { over_ground_open(c, SIZE, half_height); }

/* ---- a plate parallel to the light ---- */

static const double half_u = 0.5, half_v = 0.3, plate = 0.6, plate_h = 1.5;

static const struct {
  const char *spec;
  int grid;
  double texels;
} parallel[] = {
    /* A patch is in or out by its texel's centre: half a texel. Quads lie between centres: inside by up to one texel,
     * or with edges by half of one. */
    {"bitmask:samples=16j,primitive=patch,maps=front,merge=0", 16, 0.5},
    {"bitmask:samples=8,primitive=patch,merge=0,hierarchy=hsm", 8, 0.5},
    {"bitmask:samples=32,primitive=quad,merge=0,edges=on", 32, 0.5},
    {"bitmask:samples=16,primitive=quad,merge=0,edges=off", 16, 1},
    {"bitmask:samples=32,primitive=quad-exact,merge=0,edges=off", 32, 1},
    {"bitmask:samples=16j,primitive=quad-exact,edges=on,merge=0.01", 16, 0.5},
    {"backprojection:primitive=patch,gaps=off,merge=0", 0, 0.5},
    {"backprojection:primitive=patch,gaps=on,merge=0", 0, 0.5},
    {"backprojection:primitive=quad,merge=0,edges=off", 0, 1},
    {"backprojection:primitive=quad,merge=0,edges=on", 0, 0.5},
    {"backprojection:merge=0.01", 0, 0.5},
    {"backprojection:layers=2,merge=0", 0, 0.5}};

/* Each of two edges an axis moves by `texels` and the raster's snapping (1/256 each way), seen from the ground through
 * the plate; a grid's count of a length is off by at most one row of samples. A product of two shares, each at most 1,
 * is off by at most the sum of what they are off. */
static void check_parallel(int i) {
  scene c = {0};
  soup_patch(&c.casters, v3(0, plate_h, 0), v3(plate, 0, 0), v3(0, 0, plate));
  scene_open(&c, 2.2);
  pn_light_desc light = light_over_ground(half_u, half_v, 128);
  float *visibility = stage_visibility(&c.s, &light, parallel[i].spec);
  pn_maps_info info;
  assert_ok(pn_light_maps(c.s.light, &info));
  double texel =
      fmax(info.s1 - info.s0, info.t1 - info.t0) / info.width * (LIGHT_HEIGHT - plate_h) * LIGHT_HEIGHT / plate_h;
  double moved = 2 * (parallel[i].texels + 1.0 / 128) * texel, row = parallel[i].grid ? 1.0 / parallel[i].grid : 0;
  double allowed = moved / (2 * half_u) + moved / (2 * half_v) + 2 * row + 1e-4, worst = 0;
  int penumbra = 0;
  for (int k = 0; k < SIZE * SIZE; k++) {
    vec p = view_point(&c.v, k % SIZE, k / SIZE);
    double want = 1 - hidden_by_plate(p.x, half_u, plate, plate_h) * hidden_by_plate(p.z, half_v, plate, plate_h);
    worst = fmax(worst, fabs(visibility[k] - want));
    penumbra += want > 0 && want < 1;
  }
  print_message("%s: off by %.4f, at most %.4f\n", parallel[i].spec, worst, allowed);
  assert_true(penumbra > 50 && worst <= allowed);
  free(visibility);
  over_ground_close(&c);
}

static void test_parallel(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof parallel / sizeof *parallel; i++) check_parallel((int)i);
}

/* ---- a tilted plate that hides the whole light ---- */

/* Quads share their corners, and those are clamped to the light together: a slanted sheet leaves no hole. Exactly 0,
 * for areas up to the rounding of their sum: 2^-24 for each of the texels that the light's projection spans. */
static void check_watertight(const char *spec, double slope, double turn, int map, double allowed) {
  scene c = {0};
  vec a = v3(cos(turn), 0, sin(turn)), b = v3(-sin(turn), slope, cos(turn));
  soup_patch(&c.casters, v3(0, 2, 0), mul(2.5, a), mul(2.5 / (1 + fabs(slope)), b));
  scene_open(&c, 0.15);
  pn_light_desc light = light_over_ground(0.4, 0.25, map);
  float *visibility = stage_visibility(&c.s, &light, spec);
  for (int k = 0; k < SIZE * SIZE; k++)
    if (!(visibility[k] >= 0 && visibility[k] <= allowed))
      fail_msg("%s, slope %g turned %g, map %d: %g at pixel %d", spec, slope, turn, map, visibility[k], k);
  free(visibility);
  over_ground_close(&c);
}

static void test_watertight(void **state) {
  (void)state;
  static const char *const fields[] = {"bitmask:samples=32,primitive=quad-exact,maps=front,merge=0",
                                       "bitmask:samples=16j,primitive=quad-exact,merge=1",
                                       "bitmask:samples=16j,primitive=quad,maps=front,merge=1"};
  static const double slopes[] = {0, 0.05, 0.3, 0.5};
  /* 63 and 90: merged blocks with smaller ones beside them fall between sample points. */
  static const int maps[] = {63, 90, 130};
  for (int i = 0; i < 4; i++)
    for (int m = 0; m < 3; m++) {
      for (int k = 0; k < 3; k++) check_watertight(fields[k], slopes[i], 0.3 * i, maps[m], 0);
      check_watertight("backprojection:primitive=quad,merge=0", slopes[i], 0.3 * i, maps[m], 130 * 130 * 0x1p-24);
    }
}

/* ---- a window over the whole of a large map ---- */

/* A light so large that from the ground everything in the map may hide it. A scan turns coarser than that before
 * software GL's loops end: the shadow must still be the plate's, whose every texel counts. */
static void test_whole_map(void **state) {
  (void)state;
  static const struct {
    const char *spec;
    double row;
  } cases[] = {{"bitmask:samples=16,primitive=patch,maps=front,merge=0,hierarchy=none", 1.0 / 16},
               {"bitmask:samples=16,primitive=patch,maps=front,merge=0", 1.0 / 16},
               {"backprojection:gaps=off,merge=0,hierarchy=hsm", 0},
               {"bitmask:samples=16,primitive=quad-exact,maps=front,merge=1", 1.0 / 16 + 0.01}};
  for (int i = 0; i < 4; i++) {
    scene c = {0};
    soup_patch(&c.casters, v3(0, 2, 0), v3(1, 0, 0), v3(0, 0, 0.8));
    scene_open(&c, 0.5);
    pn_light_desc light = light_over_ground(3, 2.5, 2048);
    light.fit = PN_FIT_GIVEN;
    const float box[6] = {-1.02f, 2, -1.02f, 1.02f, 2, 1.02f};
    memcpy(light.fit_bounds, box, sizeof box);
    camera one = {.width = 4,
                  .height = 4,
                  .eye = v3(0.1, 10, 0.1),
                  .target = v3(0.1, 0, 0.1),
                  .up = v3(0, 0, -1),
                  .orthographic = true,
                  .half_height = 0.4,
                  .near = 1,
                  .far = 20};
    view few;
    view_draw(&few, &one, &c.ground);
    stage_receive(&c.s, &few, true);
    float *visibility = stage_visibility(&c.s, &light, cases[i].spec);
    /* Coarser levels of up to 8 texels a side: an edge is off by one of them. Seen from the ground at half the height,
     * twice as wide. */
    double texel = 8 * 2.04 / 2048 * 2 * 1.01, allowed = 2 * texel / 6 + 2 * texel / 5 + 2 * cases[i].row + 1e-3;
    for (int k = 0; k < 16; k++) {
      vec p = view_point(&few, k % 4, k / 4);
      double want = 1 - hidden_by_plate(p.x, 3, 1, 2) * hidden_by_plate(p.z, 2.5, 0.8, 2);
      if (!(fabs(visibility[k] - want) <= allowed))
        fail_msg("%s: %g, not %g +- %g", cases[i].spec, visibility[k], want, allowed);
    }
    free(visibility);
    view_free(&few);
    over_ground_close(&c);
  }
}

/* ---- bad input ---- */

static const char *const bad_specs[] = {"bitmask",
                                        "bitmask:preset=fast",
                                        "bitmask:preset=exact",
                                        "bitmask:merge=0,cap=4,maps=layers,layers=16",
                                        "bitmask:primitive=patch,merge=0,hierarchy=hsm",
                                        "backprojection:preset=exact",
                                        "backprojection:merge=0,primitive=quad"};

/* Whatever the casters: numbers from 0 to 1, and where wanted nothing dark, or nothing lit. */
static void check_sane(scene *c, const pn_light_desc *light, double least, double most) {
  for (size_t i = 0; i < sizeof bad_specs / sizeof *bad_specs; i++) {
    float *visibility = stage_visibility(&c->s, light, bad_specs[i]);
    for (int k = 0; k < SIZE * SIZE; k++)
      if (!(visibility[k] >= least && visibility[k] <= most))
        fail_msg("%s: %g at pixel %d, not from %g to %g", bad_specs[i], visibility[k], k, least, most);
    free(visibility);
  }
}

/* Blocks around the light, before it nearer than the near plane, behind it. */
static void test_casters_at_the_light(void **state) {
  (void)state;
  for (int i = 0; i < 4; i++) {
    scene c = {0};
    if (i == 0)
      soup_box(&c.casters, v3(-1, LIGHT_HEIGHT - 1, -1), v3(1, LIGHT_HEIGHT + 1, 1)); /* the light is inside */
    if (i == 1) soup_patch(&c.casters, v3(0, LIGHT_HEIGHT - 1e-4, 0), v3(1, 0, 0), v3(0, 0, 1)); /* hides all of it */
    if (i == 2) soup_patch(&c.casters, v3(0, LIGHT_HEIGHT, 0), v3(1, 0, 0), v3(0, 0, 1));        /* in its plane */
    if (i == 3) soup_box(&c.casters, v3(-0.1, 0.5, -0.1), v3(0.1, LIGHT_HEIGHT + 2, 0.1));       /* a pole through it */
    scene_open(&c, 2);
    for (int near = 0; near < 2; near++) {
      pn_light_desc light = light_over_ground(0.5, 0.5, 64);
      light.near_distance = near ? 1.5f : 0;
      check_sane(&c, &light, 0, 1);
    }
    over_ground_close(&c);
  }
}

/* A plate between the light and the near plane is taken to be at the near plane: below it all is dark. */
static void test_before_the_near_plane(void **state) {
  (void)state;
  scene c = {0};
  soup_patch(&c.casters, v3(0, LIGHT_HEIGHT - 0.5, 0), v3(3, 0, 0), v3(0, 0, 3));
  scene_open(&c, 0.5);
  pn_light_desc light = light_over_ground(0.3, 0.3, 64);
  light.near_distance = 1.5f;
  check_sane(&c, &light, 0, 0);
  over_ground_close(&c);
}

static void test_small_maps(void **state) {
  (void)state;
  static const int sizes[][2] = {{1, 1}, {2, 1}, {1, 7}, {3, 3}};
  for (int i = 0; i < 4; i++) {
    scene c = {0};
    soup_patch(&c.casters, v3(0, 2, 0), v3(0.5, 0.1, 0), v3(0, 0, 0.5));
    soup_patch(&c.casters, v3(0.2, 1, 0), v3(0.5, 0.1, 0), v3(0, 0, 0.5));
    scene_open(&c, 2);
    for (int wide = 0; wide < 2; wide++) {
      pn_light_desc light = light_over_ground(wide ? 6 : 0.5, 0.5, sizes[i][0]);
      light.map_height = sizes[i][1];
      check_sane(&c, &light, 0, 1);
    }
    over_ground_close(&c);
  }
}

/* Layers that no caster reaches, and maps that hold nothing: casters elsewhere in the box that the map is given. */
static void test_empty_maps(void **state) {
  (void)state;
  scene c = {0};
  soup_patch(&c.casters, v3(8, 2, 8), v3(0.1, 0, 0), v3(0, 0, 0.1));
  scene_open(&c, 2);
  pn_light_desc light = light_over_ground(0.5, 0.5, 32);
  check_sane(&c, &light, 1, 1); /* far aside */
  light.fit = PN_FIT_GIVEN;
  const float box[6] = {-1, 1, -1, 1, 2, 1};
  memcpy(light.fit_bounds, box, sizeof box);
  check_sane(&c, &light, 1, 1); /* outside the map */
  over_ground_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_parallel),
                                     cmocka_unit_test(test_watertight),
                                     cmocka_unit_test(test_whole_map),
                                     cmocka_unit_test(test_casters_at_the_light),
                                     cmocka_unit_test(test_before_the_near_plane),
                                     cmocka_unit_test(test_small_maps),
                                     cmocka_unit_test(test_empty_maps)};
  return GL_RUN("closed forms", tests);
}
