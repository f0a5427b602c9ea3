/* A smaller frustum for layers past the first: texel by texel against the layers that hold all of the map. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "light.h"
#include "stage.h"

enum { LEAVES = 300, SIZE = 64, VIEW = 80, HIGH = 60 };

/* One mesh, its leaves sorted along x, so that boxes over runs of triangles tell them apart. */
static void leaves(soup *s, vec low, vec high) {
  uint64_t seed = 31;
  for (int i = 0; i < LEAVES; i++) {
    vec at =
        v3(low.x + (high.x - low.x) * i / LEAVES, random_in(&seed, low.y, high.y), random_in(&seed, low.z, high.z));
    soup_patch(s, at, mul(0.35, random_direction(&seed)), mul(0.35, random_direction(&seed)));
  }
}

typedef enum { BELOW, ASIDE, SUN, WIDE, SCENES } scene_kind;

static pn_light_desc put_up(stage *s, scene_kind kind) {
  soup all = {0};
  stage_open(s);
  if (kind == WIDE) leaves(&all, v3(-3, -0.9, -3), v3(3, -0.5, 3));
  else if (kind == ASIDE) leaves(&all, v3(3, -5, 1), v3(8, -3, 6));
  else leaves(&all, v3(-3, -5, -3), v3(3, -3, 3));
  stage_cast(s, &all);
  soup_free(&all);
  if (kind == SUN) return sun_along(v3(0.3, -1, 0.2), 0.2, 0.1, SIZE);
  return light_at(v3(0, 0, 0), v3(0, -1, 0), 0.5, 0.5, SIZE);
}

static void update(stage *s, const pn_light_desc *light, const char *technique, double focus) {
  char spec[96];
  snprintf(spec, sizeof spec, "%s,focus=%.17g", technique, focus);
  assert_ok(pn_light_technique(s->light, spec, NULL, 0));
  assert_ok(pn_light_set(s->light, light));
  assert_ok(pn_maps_update(s->light, s->casters, PN_GROUPS_ALL, NULL, 0));
}

static float **read_layers(const stage *s) {
  const pni_texture *depth = &s->light->maps.depth;
  float **layers = calloc((size_t)depth->layers, sizeof *layers);
  for (int i = 0; i < depth->layers; i++) layers[i] = gl_read_depth(depth->id, i, depth->width, depth->height);
  return layers;
}

static void free_layers(float **layers, int count) {
  for (int i = 0; i < count; i++) free(layers[i]);
  free(layers);
}

/* How far a texel's middle lies beyond what the focus promises, in texels, below 0 inside: from the bounds that
 * pn_light_maps tells, and from the tile's place. */
static double beyond(const stage *s, int map, int x, int y, double share, bool sun) {
  pn_maps_info info;
  assert_ok(pn_light_maps(s->light, &info));
  const pni_map_block *tile = &s->light->maps.block.maps[map];
  double least[2] = {info.s0, info.t0}, most[2] = {info.s1, info.t1}, far = -1e9;
  for (int i = 0; i < 2; i++) {
    double half = share / 2 * (most[i] - least[i]), middle = (least[i] + most[i]) / 2;
    if (!sun) middle = fmin(fmax(0, least[i] + half), most[i] - half);
    double at = tile->origin[i] + ((i ? y : x) + 0.5) / tile->density[i];
    far = fmax(far, (fabs(at - middle) - half) * tile->density[i]);
  }
  return far;
}

/* First layers are untouched; later ones are, inside, bit by bit what they would be, and outside nothing. */
static void check_texels(scene_kind kind, const char *technique, double focus) {
  stage s;
  pn_light_desc light = put_up(&s, kind);
  update(&s, &light, technique, 100);
  int count = s.light->maps.depth.layers, each = pni_want_layers(&s.light->maps.want);
  bool farthest = s.light->maps.want.farthest;
  float **whole = read_layers(&s);
  update(&s, &light, technique, focus);
  assert_int_equal(s.light->maps.depth.layers, count);
  assert_true(kind == WIDE ? count > each : count == each);
  float **part = read_layers(&s);
  int kept = 0, lost = 0;
  for (int i = 0; i < count; i++)
    for (int k = 0; k < SIZE * SIZE; k++) {
      double far = beyond(&s, i / each, k % SIZE, k / SIZE, focus / 100, kind == SUN);
      bool later = i % each > 0, last = farthest && i % each == each - 1;
      float nothing = last ? 0.0f : 1.0f;
      if (!later || far <= 0) assert_true(part[i][k] == whole[i][k]);
      if (later && far > 1) assert_true(part[i][k] == nothing);
      kept += later && part[i][k] != nothing;
      lost += later && part[i][k] != whole[i][k];
    }
  assert_true(focus < 5 || kept > 20); /* there is something to look at */
  if (focus < 99) assert_true(lost > 20);
  else if (kind != WIDE) assert_true(lost == 0); /* there casters go on beyond the fit's limit */
  free_layers(whole, count);
  free_layers(part, count);
  stage_close(&s);
}

static void test_texels(void **state) {
  (void)state;
  static const char *const techniques[] = {"bitmask:maps=layers,layers=4", "bitmask:maps=two-sided",
                                           "backprojection:layers=3"};
  static const double shares[] = {1, 37.5, 60, 99.99};
  for (int kind = 0; kind < SCENES; kind++)
    for (int t = 0; t < 3; t++)
      for (int i = 0; i < 4; i++) check_texels((scene_kind)kind, techniques[t], shares[i]);
}

/* ---- what comes of it -------------------------------------------------------------------------------------------- */

static float *look(scene_kind kind, const char *technique) {
  stage s;
  view v;
  soup ground = {0};
  pn_light_desc light = put_up(&s, kind);
  soup_patch(&ground, v3(0, -6, 0), v3(9, 0, 0), v3(0, 0, -9));
  camera c = {.width = VIEW,
              .height = HIGH,
              .eye = v3(2, 3, 9),
              .target = v3(0, -6, 0),
              .up = v3(0, 1, 0),
              .half_height = 0.7,
              .near = 1,
              .far = 40};
  view_draw(&v, &c, &ground);
  stage_receive(&s, &v, true);
  float *image = stage_visibility(&s, &light, technique);
  view_free(&v);
  soup_free(&ground);
  stage_close(&s);
  return image;
}

/* Every bit that a layer sets stays set, so more of a layer is never lighter; and there is something between. Not so
 * quads: where the part ends they lack corners, and what is left of them stands for more than its share of the whole
 * one's rectangle; and a single layer bridges gaps in depth behind which several know better. */
static void test_between(void **state) {
  (void)state;
  for (int kind = 0; kind < WIDE; kind++)
    for (int quad = 0; quad < 2; quad++) {
      char spec[3][96];
      static const char *const layers[3] = {"layers=1", "layers=4,focus=50", "layers=4"};
      float *image[3];
      for (int i = 0; i < 3; i++) {
        snprintf(spec[i], sizeof spec[i], "bitmask:merge=0,primitive=%s,maps=layers,%s", quad ? "quad" : "patch",
                 layers[i]);
        image[i] = look((scene_kind)kind, spec[i]);
      }
      int below = 0, above = 0;
      for (int i = 0; i < VIEW * HIGH; i++) {
        assert_true(quad || (image[0][i] >= image[1][i] && image[1][i] >= image[2][i]));
        below += image[0][i] > image[1][i];
        above += image[1][i] > image[2][i];
      }
      assert_true(below > 50 && (above > 50 || kind == ASIDE)); /* aside, what the camera sees lies within the part */
      for (int i = 0; i < 3; i++) free(image[i]);
    }
}

/* Where the smaller frustum is the whole, and where there is no later layer, the parameter changes no bit. */
static void test_same(void **state) {
  (void)state;
  static const char *const same[][2] = {
      {"bitmask:maps=layers,layers=3", "bitmask:maps=layers,layers=3,focus=100"},
      {"bitmask:maps=layers,layers=3", "bitmask:maps=layers,layers=3,focus=99.99"}, /* all but the empty border */
      {"bitmask:primitive=patch,merge=0", "bitmask:primitive=patch,merge=0,focus=99.99"},
      {"bitmask:maps=front", "bitmask:maps=front,focus=1"},
      {"backprojection", "backprojection:focus=1"},
      {"backprojection:layers=3", "backprojection:layers=3,focus=99.99"},
  };
  for (int kind = 0; kind < SCENES; kind++)
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
      float *a = look((scene_kind)kind, same[i][0]), *b = look((scene_kind)kind, same[i][1]);
      assert_memory_equal(a, b, VIEW * HIGH * sizeof *a);
      free(a);
      free(b);
    }
}

/* ---- what a draw callback is given ------------------------------------------------------------------------------- */

typedef struct {
  int passes[4], inside[4];
} seen_planes;

/* Which layers' planes have a point four units below the light, far aside of its middle. */
static void record(void *user, const pn_caster_pass *pass) {
  static const float aside[3] = {2.2f, -4, 0};
  seen_planes *seen = user;
  bool inside = true;
  assert_in_range(pass->layer, 0, 3);
  for (int i = 0; i < pass->plane_count; i++) {
    const float *p = pass->planes + 4 * i;
    inside = inside && p[0] * aside[0] + p[1] * aside[1] + p[2] * aside[2] + p[3] >= 0;
  }
  seen->passes[pass->layer]++;
  seen->inside[pass->layer] += inside;
}

static void test_planes(void **state) {
  (void)state;
  static const float bounds[6] = {-3, -5, -3, 3, -3, 3};
  for (int focus = 40; focus <= 100; focus += 60) {
    stage s;
    seen_planes seen = {{0}, {0}};
    stage_open(&s);
    assert_ok(pn_casters_draw(s.casters, 0, record, &seen, bounds));
    pn_light_desc light = light_at(v3(0, 0, 0), v3(0, -1, 0), 0.5, 0.5, SIZE);
    update(&s, &light, "bitmask:maps=layers,layers=4", focus);
    for (int layer = 0; layer < 4; layer++) {
      assert_int_equal(seen.passes[layer], 1);
      assert_int_equal(seen.inside[layer], layer == 0 || focus == 100);
    }
    stage_close(&s);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_texels), cmocka_unit_test(test_between),
                                     cmocka_unit_test(test_same), cmocka_unit_test(test_planes)};
  return GL_RUN("focus", tests);
}
