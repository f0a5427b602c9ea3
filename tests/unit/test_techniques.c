/* Techniques on scenes with a closed form: a square parallel to the light, over a plane, and what every technique must
 * do alike. */
#include <stdlib.h>
#include <string.h>

#include "over_ground.h"

/* The square hangs at height h. */
static const double L = LIGHT_HEIGHT, h = 1.5, half_square = 0.6, half_u = 0.5, half_v = 0.3;

enum { SIZE = 48 };

typedef over_ground scene;

static void add_square(scene *c) { soup_patch(&c->casters, v3(0, h, 0), v3(half_square, 0, 0), v3(0, 0, half_square)); }

static void scene_open(scene *c) {
  *c = (scene){.from_depth = true};
  add_square(c);
  over_ground_open(c, SIZE, 2.2);
}

static pn_light_desc light_above(int map) { return light_over_ground(half_u, half_v, map); }

/* One texel of the last map, at the height of the square. */
static double texel_at_square(const stage *s) {
  pn_maps_info info;
  assert_ok(pn_light_maps(s->light, &info));
  return (info.s1 - info.s0) / (info.width - 2) * (L - h);
}

/* ---- hard and filtered ---- */

/* Exact, but for the texel on either side of the silhouette. */
static void test_hard(void **state) {
  (void)state;
  scene c;
  scene_open(&c);
  pn_light_desc light = light_above(64);
  float *visibility = stage_visibility(&c.s, &light, "hard");
  double texel = texel_at_square(&c.s);
  int dark = 0, lit = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    vec p = view_point(&c.v, i % SIZE, i / SIZE);
    double x = fabs(p.x) * (1 - h / L) - half_square, z = fabs(p.z) * (1 - h / L) - half_square, out = fmax(x, z);
    if (fabs(out) < texel) continue;
    assert_true(visibility[i] == (out < 0 ? 0.0f : 1.0f));
    dark += out < 0;
    lit += out > 0;
  }
  assert_true(dark > 100 && lit > 100);
  free(visibility);
  over_ground_close(&c);
}

/* A given map twice as wide as the square, 32 texels: the square fills texels 8 to 24 exactly. */
static const double map_edge = 8, map_size = 32;

static pn_light_desc aligned_light(void) {
  pn_light_desc light = light_above((int)map_size);
  const float box[6] = {-1.2f, 1.5f, -1.2f, 1.2f, 1.5f, 1.2f};
  light.fit = PN_FIT_GIVEN;
  memcpy(light.fit_bounds, box, sizeof box);
  return light;
}

/* Ground position to texels, along either axis. */
static double texel_of(double x) { return map_size / 2 + x * (1 - h / L) / 1.2 * map_size / 2; }

/* Share of a box of n texels around x that lies in the square. */
static double box_share(double x, int n) {
  return (clamped(x + 0.5 * n, map_edge, map_size - map_edge) - clamped(x - 0.5 * n, map_edge, map_size - map_edge)) /
         n;
}

/* Integer translates of the cubic B-spline of width 4, over the centres of the square's texels. */
static double spline_share(double x, int n) {
  (void)n;
  double sum = 0;
  for (double i = map_edge + 0.5; i < map_size - map_edge; i++) {
    double d = fabs(x - i);
    sum += d >= 2 ? 0 : d >= 1 ? (2 - d) * (2 - d) * (2 - d) / 6 : (4 - 6 * d * d + 3 * d * d * d) / 6;
  }
  return sum;
}

/* Positions in texels are good to 32 texels times some float roundings, taken here as 16; the profile's slope is at
 * most 1 a texel. */
static void check_profile(const char *spec, double (*share)(double, int), int n) {
  scene c;
  scene_open(&c);
  pn_light_desc light = aligned_light();
  float *visibility = stage_visibility(&c.s, &light, spec);
  int between = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    vec p = view_point(&c.v, i % SIZE, i / SIZE);
    double want = 1 - share(texel_of(p.x), n) * share(texel_of(p.z), n);
    if (!(fabs(visibility[i] - want) <= 32 * 16 * 0x1p-24 + 1e-6))
      fail_msg("%s: %g, not %g, at %g, %g", spec, visibility[i], want, p.x, p.z);
    between += want > 0.01 && want < 0.99;
  }
  assert_true(n == 1 || between > 100);
  free(visibility);
  over_ground_close(&c);
}

static void test_pcf(void **state) {
  (void)state;
  check_profile("pcf:taps=1", box_share, 1);
  check_profile("pcf", box_share, 5);
  check_profile("pcf:taps=8", box_share, 8);
  check_profile("pcf:filter=bicubic", spline_share, 0);
}

/* ---- the product formula ---- */

/* bound: error of the light's sampling along both axes together; the map moves each edge by so many texels, seen as
 * part of the light. */
static void check_product(const char *spec, int map, double bound, double texels) {
  scene c;
  scene_open(&c);
  pn_light_desc light = light_above(map);
  float *visibility = stage_visibility(&c.s, &light, spec);
  double texel = texel_at_square(&c.s) * L / h, allowed = bound + texels * texel * (0.5 / half_u + 0.5 / half_v);
  double worst = 0;
  int penumbra = 0;
  for (int i = 0; i < SIZE * SIZE; i++) {
    vec p = view_point(&c.v, i % SIZE, i / SIZE);
    double want = 1 - hidden_by_plate(p.x, half_u, half_square, h) * hidden_by_plate(p.z, half_v, half_square, h);
    worst = fmax(worst, fabs(visibility[i] - want));
    penumbra += want > 0 && want < 1;
  }
  print_message("%s: off by %.4f, at most %.4f\n", spec, worst, allowed);
  assert_true(penumbra > 300);
  assert_true(worst <= allowed);
  free(visibility);
  over_ground_close(&c);
}

/* 1024 points of a (0, 10, 2)-net: a box at a corner of the light is off by at most m / 2 + 3 / 2 points
 * (Niederreiter's bound for base 2), two more since the points were moved within their strata. The square is wider than
 * the light looks, so no other boxes occur. A texel is in or out by its centre: half a texel, and the raster's
 * snapping. */
static void test_average(void **state) {
  (void)state;
  check_product("average", 256, (5 + 1.5 + 2) / 1024, 0.51);
  check_product("average:samples=256", 128, (4 + 1.5 + 2) / 256, 0.51);
}

/* N x N samples: an edge is off by at most one row of them; bilinear filtering smears it by a texel more, and the
 * blockers' search may do so at the other end. */
static void test_sampled(void **state) {
  (void)state;
  check_product("pcss:samples=32", 512, 2.0 / 32, 2);
  check_product("pcss", 512, 2.0 / 8, 2);
}

/* A 16 x 16 field has its edges at rows of samples, jittered by a quarter of a row; 8, 32 likewise. Back-projection
 * adds up areas and has no samples at all, only texels, of which it may count each edge's twice. */
static void test_fields(void **state) {
  (void)state;
  check_product("bitmask:merge=0", 256, 2.0 / 16, 2);
  check_product("bitmask:samples=8,merge=0", 256, 2.0 / 8, 2);
  check_product("bitmask:samples=32,merge=0", 256, 2.0 / 32, 2);
  check_product("backprojection:merge=0", 256, 0, 2);
}

/* ---- what holds for every technique ---- */

static const char *spec_at(int i) {
  const char *name = pn_technique_at(i)->name;
  return strcmp(name, "average") ? name : "average:samples=64";
}

/* Visibility is the unblocked share of what lies above the horizon. A wall at x = 0 faces +x, so it sees half the
 * light; the square, from x = 0.05 to 0.25, hides a part of that half. */
static void test_horizon(void **state) {
  (void)state;
  static const struct {
    const char *spec;
    double bound;
  } cases[] = {{"average", 2 * 8.5 / 1024},
               {"pcss:samples=32", 2 * 2.0 / 32},
               {"bitmask:samples=32,merge=0", 2 * 2.0 / 32},
               {"backprojection:merge=0", 0}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    scene c = {0};
    soup_patch(&c.ground, v3(0, 0.5, 0), v3(0, 0, 2), v3(0, 0.5, 0));
    soup_patch(&c.casters, v3(0.15, h, 0), v3(0.1, 0, 0), v3(0, 0, 0.1));
    camera from_side = {.width = SIZE,
                        .height = SIZE,
                        .eye = v3(5, 0.5, 0),
                        .target = v3(0, 0.5, 0),
                        .up = v3(0, 1, 0),
                        .orthographic = true,
                        .half_height = 0.45,
                        .near = 1,
                        .far = 10};
    over_ground_see(&c, &from_side);
    pn_light_desc light = light_above(256);
    float *visibility = stage_visibility(&c.s, &light, cases[k].spec);
    double worst = 0;
    int penumbra = 0;
    pn_maps_info info;
    assert_ok(pn_light_maps(c.s.light, &info));
    double texel = fmax(info.s1 - info.s0, info.t1 - info.t0) / (info.width - 2) * (L - h), allowed = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
      vec p = view_point(&c.v, i % SIZE, i / SIZE);
      double part = (h - p.y) / (L - p.y); /* along the way from p to the light */
      double low = clamped(0.05 / part, 0, half_u), high = clamped(0.25 / part, 0, half_u);
      double from = (-0.1 - p.z * (1 - part)) / part, to = (0.1 - p.z * (1 - part)) / part;
      double v = (clamped(to, -half_v, half_v) - clamped(from, -half_v, half_v)) / (2 * half_v);
      double want = 1 - (high - low) / half_u * v;
      allowed = fmax(allowed, cases[k].bound + 2 * texel / part / half_u + 2 * texel / part / (2 * half_v));
      worst = fmax(worst, fabs(visibility[i] - want));
      penumbra += want > 0 && want < 1;
    }
    print_message("%s: off by %.4f, at most %.4f\n", cases[k].spec, worst, allowed);
    assert_true(penumbra > 300);
    assert_true(worst <= allowed);
    free(visibility);
    over_ground_close(&c);
  }
}

/* A slab above the light, and the ground below the square turned face down: nothing there counts, whatever casts. */
static void test_behind_and_away(void **state) {
  (void)state;
  for (int i = 0; i < pn_technique_count(); i++) {
    scene c = {0};
    soup_patch(&c.ground, v3(0, L + 1, 0), v3(3, 0, 0), v3(0, 0, 3));
    /* Between the light and the slab. */
    soup_patch(&c.casters, v3(0, L + 0.5, 0), v3(half_square, 0, 0), v3(0, 0, half_square));
    add_square(&c);
    camera below = {.width = SIZE,
                    .height = SIZE,
                    .eye = v3(0, -5, 0),
                    .target = v3(0, 0, 0),
                    .up = v3(0, 0, 1),
                    .orthographic = true,
                    .half_height = 2,
                    .near = 1,
                    .far = 20};
    over_ground_see(&c, &below);
    pn_light_desc light = light_above(64);
    for (int normals = 0; normals < 2; normals++) {
      stage_receive(&c.s, &c.v, normals);
      float *visibility = stage_visibility(&c.s, &light, spec_at(i));
      for (int k = 0; k < SIZE * SIZE; k++) assert_true(visibility[k] == 1);
      free(visibility);
    }
    /* The same camera under the ground: it sees the side that faces away. */
    soup ground = {0};
    soup_patch(&ground, v3(0, 0, 0), v3(3, 0, 0), v3(0, 0, 3));
    view under;
    view_draw(&under, &below, &ground);
    for (int normals = 0; normals < 2; normals++) {
      stage_receive(&c.s, &under, normals);
      float *visibility = stage_visibility(&c.s, &light, spec_at(i));
      for (int k = 0; k < SIZE * SIZE; k++) assert_true(visibility[k] == 1);
      free(visibility);
    }
    soup_free(&ground);
    view_free(&under);
    over_ground_close(&c);
  }
}

/* A ground that fills part of the picture; a mask over half of it. Where nothing is or nothing receives: 1. Elsewhere
 * the mask changes no bit. */
static void test_background_and_mask(void **state) {
  (void)state;
  scene c = {0};
  soup_patch(&c.ground, v3(0, 0, 0), v3(1, 0, 0), v3(0, 0, 1));
  add_square(&c);
  over_ground_open(&c, SIZE, 1.5);
  unsigned char mask[SIZE * SIZE];
  for (int i = 0; i < SIZE * SIZE; i++) mask[i] = (i % SIZE + i / SIZE / 3) % 4 < 2 ? 0 : 255;
  GLuint texture;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, SIZE, SIZE, 0, GL_RED, GL_UNSIGNED_BYTE, mask);
  glBindTexture(GL_TEXTURE_2D, 0);
  pn_light_desc light = light_above(64);
  for (int i = 0; i < pn_technique_count(); i++) {
    pn_receiver_desc desc = view_desc(&c.v, true);
    assert_ok(pn_receiver_set(c.s.receiver, &desc));
    float *plain = stage_visibility(&c.s, &light, spec_at(i));
    desc.mask_texture = texture;
    assert_ok(pn_receiver_set(c.s.receiver, &desc));
    float *masked = stage_visibility(&c.s, &light, spec_at(i));
    int dark = 0;
    for (int p = 0; p < SIZE * SIZE; p++) {
      if (c.v.shown[p] < 0) assert_true(plain[p] == 1);
      assert_true(masked[p] == (mask[p] ? plain[p] : 1));
      dark += masked[p] < 1;
    }
    assert_true(dark > 50);
    free(plain);
    free(masked);
  }
  glDeleteTextures(1, &texture);
  over_ground_close(&c);
}

/* A caster that moves while the snapped bounds stay: shadows of the others do not change by a bit. With a fit to what
 * is seen that is so because only the still caster's shadow is. */
static void test_still_shadow(void **state) {
  (void)state;
  for (int sun = 0; sun < 2; sun++)
    for (int i = 0; i < pn_technique_count(); i++) {
      scene c = {.from_depth = true};
      soup mover = {0};
      soup_patch(&c.casters, v3(-1, h, 0), v3(0.4, 0, 0.1), v3(0, 0.1, 0.5)); /* its shadow is looked at */
      soup_patch(&c.casters, v3(3, h, 0), v3(1.5, 0, 0), v3(0, 0.4, 2.5));    /* holds the bounds */
      soup_block(&mover, v3(0, 0, 0), v3(0.2, 0, 0), v3(0, 0.1, 0), v3(0, 0, 0.2));
      camera k = camera_over_ground(SIZE, 1.2);
      k.eye.x = k.target.x = -1.2;
      over_ground_see(&c, &k);
      pn_instance instance;
      float place[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, (float)h, 0, 1};
      assert_ok(pn_instance_add(c.s.casters, stage_mesh(&c.s, &mover), place, 0, &instance));
      pn_light_desc light = sun ? sun_along(v3(0.1, -1, 0), 0.1, 0.1, 128) : light_over_ground(0.2, 0.2, 128);
      light.fit = i % 2 ? PN_FIT_CASTERS : PN_FIT_VISIBLE;
      float *before = stage_visibility(&c.s, &light, spec_at(i));
      pn_maps_info first, then;
      assert_ok(pn_light_maps(c.s.light, &first));
      uint64_t seed = 1;
      for (int step = 0; step < 4; step++) {
        place[12] = (float)random_in(&seed, 2.5, 4);
        place[13] = (float)random_in(&seed, 1.3, 1.7);
        place[14] = (float)random_in(&seed, -1.5, 1.5);
        assert_ok(pn_instance_move(c.s.casters, instance, place));
        assert_ok(pn_maps_update(c.s.light, c.s.casters, PN_GROUPS_ALL, &c.s.receiver, 1));
        assert_ok(pn_light_maps(c.s.light, &then));
        assert_true(first.s0 == then.s0 && first.s1 == then.s1 && first.t0 == then.t0 && first.t1 == then.t1);
        assert_true(first.w_near == then.w_near && first.w_far == then.w_far);
        float *after = stage_look(&c.s);
        assert_memory_equal(before, after, SIZE * SIZE * sizeof *before);
        free(after);
      }
      int dark = 0;
      for (int p = 0; p < SIZE * SIZE; p++) dark += before[p] < 1;
      assert_true(dark > 100);
      free(before);
      soup_free(&mover);
      over_ground_close(&c);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_hard),
      cmocka_unit_test(test_pcf),
      cmocka_unit_test(test_average),
      cmocka_unit_test(test_sampled),
      cmocka_unit_test(test_fields),
      cmocka_unit_test(test_horizon),
      cmocka_unit_test(test_behind_and_away),
      cmocka_unit_test(test_background_and_mask),
      cmocka_unit_test(test_still_shadow),
  };
  return GL_RUN("techniques", tests);
}
