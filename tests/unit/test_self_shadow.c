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

/* What the library is given of normals. In eight bits they are off by half a degree. */
typedef enum { NORMALS_NONE, NORMALS_FLOAT, NORMALS_BYTES, NORMALS_OCTAHEDRON, NORMALS_KINDS } normal_kind;
static const char *const normal_names[] = {"no normals", "normals", "normals of 8 bits",
                                           "octahedral normals of 8 bits"};

typedef struct {
  const char *technique;
  bool sheet, sun, reversed, orthographic;
  normal_kind normals;
  GLenum depth_format;
  double tilt, size, aspect, distance; /* degrees; half extent of the light and distance, in sizes of the solid */
  int map;
} configuration;

static void describe(const configuration *c, char out[256]) {
  snprintf(out, 256, "%s, %s tilted by %g, %s of half extents %g and %g at %g, map %d, %s, %s, depth 0x%x%s",
           c->technique, c->sheet ? "sheet" : "block", c->tilt, c->sun ? "sun" : "rectangle", c->size,
           c->size * c->aspect, c->distance, c->map, c->orthographic ? "orthographic" : "perspective",
           normal_names[c->normals], c->depth_format, c->reversed ? " reversed" : "");
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

/* ---- normals ----------------------------------------------------------------------------------------------------- */

/* The octahedral map: |x| + |y| + |z| = 1 flattened along z, its lower half folded outwards over the edges. */
static void to_octahedron(vec n, float out[2]) {
  double size = fabs(n.x) + fabs(n.y) + fabs(n.z), x = n.x / size, y = n.y / size;
  out[0] = (float)(n.z >= 0 ? x : (1 - fabs(y)) * (x < 0 ? -1 : 1));
  out[1] = (float)(n.z >= 0 ? y : (1 - fabs(x)) * (y < 0 ? -1 : 1));
}

/* The view's normals in eight bits. */
static GLuint encoded_normals(const view *v, bool octahedron) {
  int width = v->camera.width, height = v->camera.height, channels = octahedron ? 2 : 4;
  float *texels = calloc((size_t)(width * height), (size_t)channels * sizeof *texels);
  assert_non_null(texels);
  for (int i = 0; i < width * height; i++) {
    float *to = texels + channels * i;
    if (v->shown[i] < 0) continue;
    vec n = view_normal(v, i % width, i / width);
    if (octahedron) to_octahedron(n, to);
    else to[0] = (float)(n.x / 2 + 0.5), to[1] = (float)(n.y / 2 + 0.5), to[2] = (float)(n.z / 2 + 0.5);
  }
  GLuint texture;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, octahedron ? GL_RG8_SNORM : GL_RGBA8, width, height, 0, octahedron ? GL_RG : GL_RGBA,
               GL_FLOAT, texels);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  free(texels);
  return texture;
}

/* The texture made for it, or 0. */
static GLuint receive(stage *s, const view *v, normal_kind kind) {
  pn_receiver_desc desc = view_desc(v, kind == NORMALS_FLOAT);
  GLuint made = kind > NORMALS_FLOAT ? encoded_normals(v, kind == NORMALS_OCTAHEDRON) : 0;
  if (made) {
    desc.normal_texture = made;
    desc.normal_encoding = kind == NORMALS_BYTES ? PN_NORMAL_UNSIGNED : PN_NORMAL_OCTAHEDRON;
  }
  assert_ok(pn_receiver_set(s->receiver, &desc));
  return made;
}

/* ---- pixels ------------------------------------------------------------------------------------------------------ */

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

static count look(stage *s, const configuration *c, uint64_t *seed) {
  vec towards = towards_light(seed);
  soup solid = {0};
  make_solid(c, towards, seed, &solid);
  camera k = camera_near(c, towards, seed);
  view v;
  view_draw(&v, &k, &solid);
  pn_casters_destroy(&s->casters);
  assert_ok(pn_casters_create(s->context, &s->casters));
  stage_cast(s, &solid);
  GLuint encoded = receive(s, &v, c->normals);
  pn_light_desc light =
      c->sun ? sun_along(mul(-1, towards), fmin(c->size, 1), fmin(c->size * c->aspect, 1), c->map)
             : light_at(mul(c->distance, towards), mul(-1, towards), c->size, c->size * c->aspect, c->map);
  float *visibility = stage_visibility(s, &light, c->technique);
  light_axes axes = axes_of(&light);
  count found = {0, 0, 0, 1};
  count_pixels(&v, visibility, &axes, &found);
  free(visibility);
  glDeleteTextures(1, &encoded);
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
                     .normals = (normal_kind)(random_bits(seed) % NORMALS_KINDS),
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
  stage s; /* one for all rounds: compiling takes longer than looking */
  stage_open(&s);
  for (int i = 0; i < round_count(); i++) {
    configuration c = pick(spec, &seed);
    /* Scattering costs texels times texels: what a light of ten times the solid's size covers of 2048^2 takes hours. */
    if (!strcmp(spec, "ssm") && c.map > 64) c.map = 64;
    /* As in the range stack, of which a map of 2048^2 has 1.6 GB. */
    if (strstr(spec, "merge=0") && c.map > 64) c.map = 64;
    count found = look(&s, &c, &seed);
    lit += found.lit;
    edge += found.edge;
    if (found.dark == 0) continue;
    char text[256];
    describe(&c, text);
    print_message("round %d: %d of %d pixels dark, down to %g: %s\n", i, found.dark, found.lit, found.least, text);
    failures++;
  }
  stage_close(&s);
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
  static const char *const specs[] = {"pcf:filter=bicubic", "pcf:taps=16", "pcss:samples=3", "bitmask:merge=0,cap=6",
                                      "backprojection:merge=0,cap=6"};
  int failures = 0;
  for (size_t i = 0; i < sizeof specs / sizeof *specs; i++) failures += failures_of(specs[i]);
  assert_int_equal(failures, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_technique), cmocka_unit_test(test_variants)};
  return GL_RUN("self-shadowing", tests);
}
