/* Tangent planes from depth where faces are narrow: at the rim of round things, on wires. Whatever the plane is taken
 * to be, what lies in the umbra is dark, and what nothing hides is lit.
 *
 * What is counted is light, as a host would show it: visibility times the cosine of the exact face. A face turned
 * away from the light shows none, and visibility says nothing about it. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stage.h"

enum { SIZE = 200 };

/* ---- scenes ------------------------------------------------------------------------------------------------------ */

static vec on_sphere(vec centre, double radius, int i, int j, int around, int up) {
  double a = 2 * M_PI * i / around, b = M_PI * j / up;
  return add(centre, mul(radius, v3(sin(b) * cos(a), cos(b), sin(b) * sin(a))));
}

static void add_sphere(soup *out, vec centre, double radius, int around, int up) {
  for (int j = 0; j < up; j++)
    for (int i = 0; i < around; i++) {
      vec a = on_sphere(centre, radius, i, j, around, up), b = on_sphere(centre, radius, i + 1, j, around, up),
          c = on_sphere(centre, radius, i, j + 1, around, up), d = on_sphere(centre, radius, i + 1, j + 1, around, up);
      if (j > 0) soup_triangle(out, a, b, c);
      if (j < up - 1) soup_triangle(out, b, d, c);
    }
}

/* A fence of square wires, upright and lying, each about a pixel wide. */
static void add_wires(soup *out, vec centre, double half_width) {
  for (int i = -6; i <= 6; i++) {
    soup_block(out, add(centre, v3(0.09 * i, 0, 0)), v3(half_width, 0, 0), v3(0, 0.6, 0), v3(0, 0, half_width));
    soup_block(out, add(centre, v3(0, 0.09 * i, -3 * half_width)), v3(0.6, 0, 0), v3(0, half_width, 0),
               v3(0, 0, half_width));
  }
}

/* Small leaves in any direction, about two pixels wide. */
static void add_leaves(soup *out, vec centre, double size) {
  uint64_t seed = 3;
  for (int i = 0; i < 1500; i++) {
    vec a = random_direction(&seed), b = unit(cross(a, random_direction(&seed)));
    soup_patch(out, add(centre, random_point(&seed, 0.5)), mul(size, a), mul(size, b));
  }
}

typedef struct {
  const char *name;
  int around, up;    /* of a sphere; 0: wires, or leaves */
  double half_width; /* of wires, of leaves */
  bool leaves;
} shape;

static const shape shapes[] = {
    {.name = "sphere of 12 x 8", .around = 12, .up = 8},    {.name = "sphere of 24 x 12", .around = 24, .up = 12},
    {.name = "sphere of 48 x 24", .around = 48, .up = 24},  {.name = "sphere of 200 x 100", .around = 200, .up = 100},
    {.name = "wires of one pixel", .half_width = 0.004},    {.name = "wires of two pixels", .half_width = 0.008},
    {.name = "leaves", .half_width = 0.01, .leaves = true},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static soup make_shape(const shape *s) {
  soup out = {0};
  if (s->around) add_sphere(&out, v3(0, 0.6, 0), 0.6, s->around, s->up);
  else if (s->leaves) add_leaves(&out, v3(0, 0.6, 0), s->half_width);
  else add_wires(&out, v3(0, 0.6, 0), s->half_width);
  return out;
}

/* ---- what is seen of them ---------------------------------------------------------------------------------------- */

typedef struct {
  const char *spec;
  bool sun, plate, orthographic;
  GLenum depth_format;
} setting;

static camera camera_of(const setting *c) {
  return (camera){.width = SIZE,
                  .height = SIZE,
                  .eye = v3(0.3, 1.1, 4),
                  .target = v3(0, 0.6, 0),
                  .up = v3(0, 1, 0),
                  .orthographic = c->orthographic,
                  .half_height = c->orthographic ? 0.8 : 0.2,
                  .near = 0.1,
                  .far = 50,
                  .depth_format = c->depth_format};
}

static pn_light_desc light_of(const setting *c) {
  vec from = v3(-1, 4, 1), way = sub(v3(0, 0.6, 0), from);
  return c->sun ? sun_along(way, 0.05, 0.05, 512) : light_at(from, way, 0.2, 0.2, 512);
}

static float *visibility_of(stage *st, const setting *c, const shape *s, const view *v, bool normals) {
  soup casts = make_shape(s);
  if (c->plate) soup_box(&casts, v3(-2, 1.95, -1.2), v3(1.2, 2.05, 2));
  pn_casters_destroy(&st->casters);
  assert_ok(pn_casters_create(st->context, &st->casters));
  stage_cast(st, &casts);
  stage_receive(st, v, normals);
  pn_light_desc light = light_of(c);
  float *out = stage_visibility(st, &light, c->spec);
  soup_free(&casts);
  return out;
}

typedef struct {
  int facing, wrong[2]; /* pixels that face the whole light; those too bright or too dark: from depth, with normals */
  double sum[2], worst[2];
} tally;

/* By how much light is off, over the pixels that face the whole light. */
static tally look(stage *st, const setting *c, const shape *s) {
  soup surfaces = make_shape(s);
  camera k = camera_of(c);
  view v;
  view_draw(&v, &k, &surfaces);
  pn_light_desc light = light_of(c);
  light_axes axes = axes_of(&light);
  tally out = {0};
  for (int normals = 0; normals < 2; normals++) {
    float *visibility = visibility_of(st, c, s, &v, normals);
    for (int i = 0; i < SIZE * SIZE; i++) {
      int x = i % SIZE, y = i / SIZE;
      if (view_shown(&v, x, y) < 0) continue;
      vec p = view_point(&v, x, y), n = view_normal(&v, x, y);
      if (!faces_whole_light(&axes, p, n, 1e-5)) continue;
      double off = dot(n, unit(to_light(&axes, p, 0, 0))) * fabs(visibility[i] - (c->plate ? 0 : 1));
      out.facing += !normals;
      out.wrong[normals] += off > 0.1;
      out.sum[normals] += off;
      out.worst[normals] = fmax(out.worst[normals], off);
    }
    free(visibility);
  }
  view_free(&v);
  soup_free(&surfaces);
  print_message("%s, %s, %s%s%s, depth 0x%x: %d pixels; from depth %d wrong, worst %.3f, mean %.5f; with normals %d, "
                "%.3f, %.5f\n",
                c->spec, s->name, c->plate ? "umbra" : "light", c->sun ? ", sun" : "",
                c->orthographic ? ", orthographic" : "", c->depth_format, out.facing, out.wrong[0], out.worst[0],
                out.sum[0] / out.facing, out.wrong[1], out.worst[1], out.sum[1] / out.facing);
  return out;
}

/* Light that is wrong by more than a tenth shows. From depth none of it may be that with normals is right; where wires
 * shade each other, an error may be 1.25 times as large, plus 0.002. */
static void check(stage *st, const setting *c, const shape *s, int allowed) {
  tally t = look(st, c, s);
  assert_true(t.facing > 1000);
  assert_true(t.wrong[0] <= 1.25 * t.wrong[1] + allowed);
  assert_true(t.sum[0] <= 1.25 * t.sum[1] + 0.002 * t.facing);
}

static void test_default(void **state) {
  (void)state;
  stage st; /* one for all: compiling takes longer than looking */
  stage_open(&st);
  for (int i = 0; i < 8; i++)
    for (int s = i / 4; s < SHAPES; s += i < 4 ? 1 : 3) /* orthographic: two of them */
      check(&st,
            &(setting){.spec = "bitmask",
                       .plate = i & 1,
                       .sun = i & 2,
                       .orthographic = i & 4,
                       .depth_format = s & 1 ? GL_DEPTH_COMPONENT32F : GL_DEPTH_COMPONENT24},
            &shapes[s], shapes[s].leaves ? 1 : 0); /* of 2500, each perhaps of another leaf than its neighbours */
  stage_close(&st);
}

/* Where two faces meet right in a pixel, a technique without partial values is off by a whole pixel: of each picture
 * a few in ten thousand. */
static void test_every_technique(void **state) {
  (void)state;
  static const int some[] = {2, 5};
  for (int i = 0; i < pn_technique_count(); i++) {
    const char *name = pn_technique_at(i)->name;
    stage st;
    stage_open(&st);
    for (int k = 0; k < 4; k++)
      check(&st,
            &(setting){.spec = !strcmp(name, "average") ? "average:samples=4" : name,
                       .plate = k & 1,
                       .depth_format = GL_DEPTH_COMPONENT24},
            &shapes[some[k / 2]], 5);
    stage_close(&st);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_default), cmocka_unit_test(test_every_technique)};
  return GL_RUN("rims", tests);
}
