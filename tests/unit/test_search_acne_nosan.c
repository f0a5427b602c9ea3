/* No self-shadowing, whatever the search: flat faces that cast and receive at once and face the whole light are exactly
 * 1, for every kind of primitive, samples, maps, merging, cap and hierarchy, at many tilts, lights, distances and map
 * sizes. test_self_shadow.c looks longer, at defaults. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stage.h"

enum { SIZE = 24 };

typedef struct {
  int faces, dark;
  float least;
} tally;

/* whole: every texel of a window is looked at, which in large maps takes long and shows nothing new. */
static pn_light_desc pick_light(uint64_t *seed, vec towards, bool whole) {
  static const double sizes[] = {0.01, 0.1, 0.5, 1, 3}, distances[] = {1.3, 3, 30, 1000};
  static const int maps[] = {1, 2, 3, 17, 512};
  double size = sizes[(int)random_in(seed, 0, 5)], distance = distances[(int)random_in(seed, 0, 4)],
         aspect = random_bits(seed) & 1 ? 1 : 0.2;
  int count = whole ? 4 : 5, map = maps[(int)random_in(seed, 0, count)];
  pn_light_desc light = random_bits(seed) & 1
                            ? sun_along(mul(-1, towards), fmin(size, 1), fmin(size, 1) * aspect, map)
                            : light_at(mul(distance, towards), mul(-1, towards), size, size * aspect, map);
  if (random_bits(seed) % 3 == 0) light.map_height = maps[(int)random_in(seed, 0, count)];
  return light;
}

/* A block or a sheet, a face of it tilted away from the light. */
static void make_solid(uint64_t *seed, vec towards, soup *out) {
  static const double tilts[] = {0, 1, 20, 45, 60, 75, 85, 89, 89.9};
  double angle = tilts[(int)random_in(seed, 0, 9)] * 0.017453292519943295;
  vec aside = unit(cross(towards, random_direction(seed))),
      normal = add(mul(cos(angle), towards), mul(sin(angle), aside));
  vec a = unit(cross(normal, random_direction(seed))), b = cross(normal, a);
  if (random_bits(seed) & 1) soup_patch(out, v3(0, 0, 0), mul(0.5, a), mul(0.4, b));
  else soup_block(out, v3(0, 0, 0), mul(0.3, a), mul(0.4, b), mul(0.35, normal));
}

static void look(stage *s, const char *spec, uint64_t seed, tally *c) {
  vec towards = random_bits(&seed) & 1 ? v3(0, 1, 0) : random_direction(&seed), from;
  soup solid = {0};
  make_solid(&seed, towards, &solid);
  do from = unit(add(mul(0.7, towards), random_direction(&seed)));
  while (dot(from, towards) < 0.1);
  camera k = {.width = SIZE,
              .height = SIZE,
              .eye = mul(2, from),
              .target = v3(0, 0, 0),
              .up = v3(0.1, 1, 0.2),
              .half_height = 0.3,
              .near = 0.1,
              .far = 10};
  view v;
  view_draw(&v, &k, &solid);
  pn_casters_destroy(&s->casters);
  assert_ok(pn_casters_create(s->context, &s->casters));
  stage_cast(s, &solid);
  stage_receive(s, &v, random_bits(&seed) & 1);
  pn_light_desc light =
      pick_light(&seed, towards, strstr(spec, "merge=0") && (!strstr(spec, "cap") || strstr(spec, "exact")));
  light_axes axes = axes_of(&light);
  float *visibility = stage_visibility(s, &light, spec);
  for (int i = 0; i < SIZE * SIZE; i++) {
    int x = i % SIZE, y = i / SIZE;
    if (v.shown[i] < 0 || !view_flat_around(&v, x, y, 1) ||
        !faces_whole_light(&axes, view_point(&v, x, y), view_normal(&v, x, y), 1e-5))
      continue;
    c->faces++;
    c->dark += visibility[i] != 1.0f;
    c->least = fminf(c->least, visibility[i]);
  }
  free(visibility);
  view_free(&v);
  soup_free(&solid);
}

static int failures;

/* rounds of one spec, in one context: compiling takes longer than looking. */
static void check(const char *spec, uint64_t first, int rounds) {
  stage s;
  stage_open(&s);
  int faces = 0;
  for (int i = 0; i < rounds; i++) {
    tally c = {0, 0, 1};
    look(&s, spec, 1000 + first + (uint64_t)i, &c);
    faces += c.faces;
    if (!c.dark) continue;
    failures++;
    print_message("%s, seed %d: %d of %d pixels dark, down to %g\n", spec, (int)(1000 + first) + i, c.dark, c.faces,
                  c.least);
  }
  assert_true(faces > 10 * rounds);
  stage_close(&s);
}

/* The next of a list, a different stride for each, so that few specs meet many pairs of values. */
#define NEXT(list, stride) list[(i / (stride)) % (int)(sizeof(list) / sizeof *(list))]

static void test_bitmask(void **state) {
  (void)state;
  static const char *const samples[] = {"16j", "8", "32", "16"}, *const primitives[] = {"patch", "quad", "quad-exact"};
  static const char *const maps[] = {"front", "two-sided", "layers,layers=3"}, *const edges[] = {"on", "off"};
  static const char *const ways[] = {"merge=0,hierarchy=mssm",        "merge=1",
                                     "merge=0,cap=4,hierarchy=hsm",   "merge=4",
                                     "merge=0,cap=16,hierarchy=mssm", "merge=0,hierarchy=none",
                                     "merge=0,cap=4,hierarchy=mssm"};
  const char *longer = getenv("PENUMBRA_TEST_ROUNDS");
  failures = 0;
  for (int i = 0; i < (longer ? 14 : 8); i++) {
    char spec[160];
    snprintf(spec, sizeof spec, "bitmask:samples=%s,primitive=%s,maps=%s,edges=%s,%s", NEXT(samples, 1),
             NEXT(primitives, 1), NEXT(maps, 2), NEXT(edges, 3), NEXT(ways, 1));
    check(spec, 100 * (uint64_t)i, longer ? atoi(longer) : 12);
  }
  assert_int_equal(failures, 0);
}

static void test_backprojection(void **state) {
  (void)state;
  static const char *const specs[] = {"primitive=patch,merge=0",
                                      "primitive=patch,gaps=off,merge=0,cap=4,hierarchy=hsm",
                                      "primitive=quad,merge=0,cap=16",
                                      "primitive=patch,merge=4,layers=2",
                                      "primitive=quad,merge=1",
                                      "primitive=quad,merge=0,edges=off,layers=2",
                                      "primitive=patch,merge=0,cap=4,layers=2"};
  const char *longer = getenv("PENUMBRA_TEST_ROUNDS");
  failures = 0;
  for (int i = 0; i < 7; i++) {
    char spec[160];
    snprintf(spec, sizeof spec, "backprojection:%s", specs[i]);
    check(spec, 5000 + 100 * (uint64_t)i, longer ? atoi(longer) : 12);
  }
  assert_int_equal(failures, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_bitmask), cmocka_unit_test(test_backprojection)};
  return GL_RUN("searches and self-shadowing", tests);
}
