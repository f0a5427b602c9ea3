/* No self-shadowing: a flat face of a convex solid, or a sheet, that casts and receives at once and faces the whole
 * light is exactly 1, whatever the light, the map, the camera's depth.
 *
 * Pixels right at an edge of the face are counted but allowed: GL snaps vertices to 1/256 pixel, so such a pixel may
 * show a point that lies beyond the face; and where fewer than two pixels of a face lie along an axis, depth does not
 * tell its plane. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stage.h"

typedef struct {
  const char *technique;
  bool sheet, sun, normals, reversed, orthographic;
  GLenum depth_format;
  double tilt, size, aspect, distance; /* degrees; half extent of the light and distance, in sizes of the solid */
  int map;
} configuration;

static void describe(const configuration *c, char out[256]) {
  snprintf(out, 256, "%s, %s tilted by %g, %s of half extents %g and %g at %g, map %d, %s%s, depth 0x%x%s",
           c->technique, c->sheet ? "sheet" : "block", c->tilt, c->sun ? "sun" : "rectangle", c->size,
           c->size * c->aspect, c->distance, c->map, c->orthographic ? "orthographic" : "perspective",
           c->normals ? " with normals" : "", c->depth_format, c->reversed ? " reversed" : "");
}

/* The solid has one face whose normal is the tilt away from the direction to the light, turned about it at random. */
static void make_solid(const configuration *c, vec towards, uint64_t *seed, soup *out) {
  vec aside = unit(cross(towards, random_direction(seed)));
  double angle = c->tilt * 0.017453292519943295;
  vec normal = add(mul(cos(angle), towards), mul(sin(angle), aside));
  vec a = unit(cross(normal, random_direction(seed))), b = cross(normal, a);
  if (c->sheet) soup_patch(out, v3(0, 0, 0), mul(0.5, a), mul(0.4, b));
  else soup_block(out, v3(0, 0, 0), mul(0.3, a), mul(0.4, b), mul(0.35, normal));
}

static vec towards_light(uint64_t *seed) {
  static const vec axes[] = {{0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
  int i = (int)random_in(seed, 0, 8);
  return i < 4 ? axes[i] : random_direction(seed);
}

static camera camera_near(const configuration *c, vec towards, uint64_t *seed) {
  vec from;
  do from = unit(add(mul(0.7, towards), random_direction(seed)));
  while (dot(from, towards) < 0.05);
  camera k = {.width = 48,
              .height = 40,
              .eye = mul(random_in(seed, 1.2, 4), from),
              .target = v3(0, 0, 0),
              .up = v3(0.1, 1, 0.2),
              .orthographic = c->orthographic,
              .near = 0.1,
              .far = 30,
              .reversed = c->reversed,
              .depth_format = c->depth_format};
  k.half_height = c->orthographic ? 0.6 : 0.6 / length(k.eye);
  return k;
}

typedef struct {
  int lit, dark, edge;
  float least;
} count; /* edge: dark ones next to another surface, or to none */

static void count_pixels(const view *v, const float *visibility, const light_axes *light, count *out) {
  for (int y = 0; y < v->camera.height; y++)
    for (int x = 0; x < v->camera.width; x++) {
      if (view_shown(v, x, y) < 0) continue;
      /* Rounding of a float normal decides closer to the horizon than this. */
      if (!faces_whole_light(light, view_point(v, x, y), view_normal(v, x, y), 1e-5)) continue;
      float value = visibility[y * v->camera.width + x];
      out->lit++;
      if (value == 1.0f) continue;
      if (!view_flat_around(v, x, y, 1)) {
        out->edge++;
        continue;
      }
      out->dark++;
      out->least = fminf(out->least, value);
    }
}

static count look(const configuration *c, uint64_t *seed) {
  vec towards = towards_light(seed);
  soup solid = {0};
  make_solid(c, towards, seed, &solid);
  camera k = camera_near(c, towards, seed);
  view v;
  view_draw(&v, &k, &solid);
  stage s;
  stage_open(&s);
  stage_cast(&s, &solid);
  stage_receive(&s, &v, c->normals);
  pn_light_desc light =
      c->sun ? sun_along(mul(-1, towards), fmin(c->size, 1), fmin(c->size * c->aspect, 1), c->map)
             : light_at(mul(c->distance, towards), mul(-1, towards), c->size, c->size * c->aspect, c->map);
  float *visibility = stage_visibility(&s, &light, c->technique);
  light_axes axes = axes_of(&light);
  count found = {0, 0, 0, 1};
  count_pixels(&v, visibility, &axes, &found);
  free(visibility);
  stage_close(&s);
  view_free(&v);
  soup_free(&solid);
  return found;
}

static configuration pick(const char *technique, uint64_t *seed) {
  static const double tilts[] = {0, 1, 20, 45, 60, 75, 85, 89, 89.9}, sizes[] = {0.01, 0.1, 0.5, 1, 3, 10};
  static const double distances[] = {1, 3, 30, 1000};
  static const int maps[] = {1, 2, 16, 100, 512, 2048};
#define ANY(list) list[(int)random_in(seed, 0, (double)(sizeof(list) / sizeof *(list)))]
  configuration c = {.technique = technique,
                     .sheet = random_bits(seed) & 1,
                     .sun = random_bits(seed) & 1,
                     .normals = random_bits(seed) & 1,
                     .orthographic = random_bits(seed) % 4 == 0};
  c.depth_format = random_bits(seed) & 1 ? GL_DEPTH_COMPONENT24 : GL_DEPTH_COMPONENT32F;
  c.reversed = c.depth_format == GL_DEPTH_COMPONENT32F && (random_bits(seed) & 1) &&
               epoxy_has_gl_extension("GL_ARB_clip_control");
  c.tilt = ANY(tilts);
  c.size = ANY(sizes);
  c.aspect = random_bits(seed) & 1 ? 1 : 0.2;
  c.distance = ANY(distances);
  c.map = ANY(maps);
#undef ANY
  return c;
}

/* Rounds of every technique; more than usual for a longer look: PENUMBRA_TEST_ROUNDS. */
static int round_count(void) {
  const char *given = getenv("PENUMBRA_TEST_ROUNDS");
  return given ? atoi(given) : TEST_ROUNDS(40);
}

static int failures_of(const char *spec) {
  uint64_t seed = 11;
  int failures = 0, lit = 0, edge = 0;
  for (int i = 0; i < round_count(); i++) {
    configuration c = pick(spec, &seed);
    /* Scattering costs texels times texels: what a light of ten times the solid's size covers of 2048^2 takes hours. */
    if (!strcmp(spec, "ssm") && c.map > 64) c.map = 64;
    count found = look(&c, &seed);
    lit += found.lit;
    edge += found.edge;
    if (found.dark == 0) continue;
    char text[256];
    describe(&c, text);
    print_message("round %d: %d of %d pixels dark, down to %g: %s\n", i, found.dark, found.lit, found.least, text);
    failures++;
  }
  print_message("%s: %d pixels lit, %d dark at edges\n", spec, lit, edge);
  assert_true(lit > 100 * round_count());
  return failures;
}

/* Every technique in the registry, so that a new one is tested the day it comes. */
static void test_every_technique(void **state) {
  (void)state;
  int failures = 0;
  for (int i = 0; i < pn_technique_count(); i++) {
    const char *name = pn_technique_at(i)->name;
    if (pn_technique_at(i)->self_shadows)
      failures += failures_of(!strcmp(name, "average") ? "average:samples=4" : name);
  }
  assert_int_equal(failures, 0);
}

static void test_variants(void **state) {
  (void)state;
  static const char *const specs[] = {"pcf:filter=bicubic", "pcf:taps=16", "pcss:samples=3"};
  int failures = 0;
  for (size_t i = 0; i < sizeof specs / sizeof *specs; i++) failures += failures_of(specs[i]);
  assert_int_equal(failures, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_technique), cmocka_unit_test(test_variants)};
  return GL_RUN("self-shadowing", tests);
}
