/* The same scene far from the origin, in a host that loses what floats lose there: it knows nothing but floats, and its
 * vertex shader goes through scene space. What no shadow falls on stays lit, whatever casts and however it came there;
 * and shadows stay where they are, up to what such a host's depth has lost. The truth is that of the scene at the
 * origin. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "agreement.h"
#include "host.h"
#include "truth.h"

enum { WIDTH = 160, HEIGHT = 120, PIXELS = WIDTH * HEIGHT };

/* How the scene gets there: by its transforms; by its vertices; by vertices from where transforms bring them back. */
typedef enum { PLACED, BAKED, BACK, KINDS } far_kind;
static const char *const kind_names[KINDS] = {"placed", "baked", "back"};
static const char *const cast_names[] = {"memory", "buffers", "callback"};

/* ---- scenes ------------------------------------------------------------------------------------------------------ */

/* On a grid of 1/64, which floats have up to 2^18: what comes back from there is the same mesh. */
static vec3 on_grid(vec3 p) { return v3(round(64 * p.x) / 64, round(64 * p.y) / 64, round(64 * p.z) / 64); }

/* Vertices after the matrix and the way, rounded: that is the mesh from now on. */
static void bake(mesh *m, const mat4 *matrix, vec3 way) {
  m->wave = 0;
  for (int i = 0; i < m->vertex_count; i++) {
    vec3 q = add(project(matrix, on_grid(v3_of(m->posed + 3 * i)), NULL), way);
    float *p = m->rest + 3 * i;
    p[0] = (float)q.x, p[1] = (float)q.y, p[2] = (float)q.z;
  }
  mesh_pose(m, 0);
}

static void displace(scene *world, far_kind kind, vec3 way) {
  mat4 away = translation(way.x, way.y, way.z), back = translation(-way.x, -way.y, -way.z), one = identity();
  for (int i = 0; i < world->count; i++) {
    mesh *m = &world->meshes[i];
    mat4 place = from_float(m->place);
    if (kind == BAKED) bake(m, &place, way);
    else bake(m, &one, kind == BACK ? way : v3(0, 0, 0));
    place = kind == BAKED ? one : kind == BACK ? multiply(&place, &back) : multiply(&away, &place);
    to_float(&place, m->place);
  }
}

/* Where the scene stands in the end. */
static vec3 place_of(far_kind kind, vec3 way) { return kind == BACK ? v3(0, 0, 0) : way; }

static void open_far(host *h, far_kind kind, vec3 way) {
  memset(h, 0, sizeof *h);
  assert_true(headless_open(&h->window));
  scene_make(&h->world);
  displace(&h->world, kind, way);
  assert_true(renderer_open(&h->draw, &h->world));
  assert_int_equal(host_context(h), PN_OK);
}

static camera camera_there(vec3 place) {
  camera out = camera_from(add(v3(0.4, 2.7, 5.2), place), add(v3(0, 0.6, 0), place));
  out.width = out.target_width = WIDTH;
  out.height = out.target_height = HEIGHT;
  return out;
}

static pn_light_desc light_there(pn_light_shape shape, vec3 place) {
  pn_light_desc out = shape == PN_LIGHT_SUN ? host_sun_desc() : host_light_desc();
  const double way[3] = {place.x, place.y, place.z};
  for (int i = 0; i < 3; i++) out.center[i] = (float)(out.center[i] + way[i]);
  out.fit = PN_FIT_VISIBLE;
  return out;
}

/* ---- truth ------------------------------------------------------------------------------------------------------- */

static surfaces seen;
static unsigned char lit[2][PIXELS];  /* [shape]: sees the whole light, and so does what is around it */
static unsigned char away[2][PIXELS]; /* turned from all of it: whether anything hides it then means nothing */

/* The pixel and those around it show one flat face: a pixel that a moved edge reaches shows something else. */
static int alone(int x, int y) {
  int i = y * WIDTH + x;
  if (x < 3 || y < 3 || x >= WIDTH - 3 || y >= HEIGHT - 3 || seen.position[4 * i + 3] < 0) return 0;
  vec3 p = v3_of(seen.position + 4 * i), n = v3_of(seen.normal + 3 * i);
  for (int k = 0; k < 9; k++) {
    int j = i + (k / 3 - 1) * WIDTH + k % 3 - 1;
    vec3 q = v3_of(seen.position + 4 * j);
    if (seen.position[4 * i + 3] != seen.position[4 * j + 3] || dot(n, v3_of(seen.normal + 3 * j)) < 0.999 ||
        fabs(dot(n, sub(q, p))) > 1e-3)
      return 0;
  }
  return truth_plane_known(&seen, x, y);
}

static int find_truth(void **state) {
  (void)state;
  host h;
  if (!headless_open(&h.window)) {
    fprintf(stderr, "no GL here: skipped\n");
    exit(77);
  }
  headless_close(&h.window);
  open_far(&h, PLACED, v3(0, 0, 0));
  camera view = camera_there(v3(0, 0, 0));
  assert_true(surfaces_draw(&seen, &h.draw, &h.world, &view));
  for (int shape = 0; shape < 2; shape++) {
    pn_light_desc desc = light_there((pn_light_shape)shape, v3(0, 0, 0));
    /* Texels larger than the maps' will be: by so much a shadow's edge moves where floats have steps of 1/64. */
    pn_maps_info maps = {
        .s1 = shape == PN_LIGHT_SUN ? 5 : 1.5f, .t1 = shape == PN_LIGHT_SUN ? 5 : 1.5f, .width = 256, .height = 256};
    truth_light light = truth_light_of(&desc, &maps);
    for (int i = 0; i < PIXELS; i++) {
      vec3 p = v3_of(seen.position + 4 * i), n = v3_of(seen.normal + 3 * i);
      away[shape][i] = seen.position[4 * i + 3] >= 0 && truth_corners(&light, p, n) == 0;
      lit[shape][i] = alone(i % WIDTH, i / WIDTH) && seen.position[4 * i + 3] != SCENE_FLAG &&
                      truth_sees_all(&light, &h.world, p, n) != 0;
    }
  }
  host_close(&h);
  return 0;
}

static int forget_truth(void **state) {
  (void)state;
  surfaces_free(&seen);
  return 0;
}

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

typedef struct {
  far_kind kind;
  vec3 way;
  cast_kind cast;
  pn_light_shape shape;
  int normals;
  const char *spec;
  float position_error;
  int exact_depth; /* BACK only: depth is drawn of the scene that never went away */
} setting;

static GLuint normal_texture(void) {
  GLuint texture = make_texture(GL_RGBA32F, WIDTH, HEIGHT);
  gl.BindTexture(GL_TEXTURE_2D, texture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, WIDTH, HEIGHT, 0, GL_RGB, GL_FLOAT, seen.normal);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  return texture;
}

/* The camera's depth of another scene, in the same GL context. */
static void draw_depth_of(const scene *world, const camera_view *v) {
  renderer other;
  assert_true(renderer_open(&other, world));
  renderer_depth(&other, world, &v->view, &v->target);
  renderer_close(&other);
}

static float *draw(const setting *s) {
  host h;
  camera_view v;
  pn_light *light;
  vec3 place = place_of(s->kind, s->way);
  camera view = camera_there(place);
  open_far(&h, s->kind, s->way);
  assert_int_equal(host_view(&h, &view, &v), PN_OK);
  if (s->exact_depth) {
    scene home;
    scene_make(&home);
    displace(&home, PLACED, v3(0, 0, 0));
    draw_depth_of(&home, &v);
    scene_free(&home);
  }
  pn_receiver_desc desc = host_receiver_desc(&view, &v.target);
  if (s->normals) desc.normal_texture = normal_texture();
  desc.position_error = s->position_error;
  assert_int_equal(pn_receiver_set(v.receiver, &desc), PN_OK);
  assert_int_equal(host_cast(&h, s->cast), PN_OK);
  pn_light_desc shining = light_there(s->shape, place);
  assert_int_equal(host_light(&h, &shining, s->spec, &light), PN_OK);
  assert_int_equal(pn_maps_update(light, h.casters, PN_GROUPS_ALL, &v.receiver, 1), PN_OK);
  assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
  float *out = host_result(light, v.receiver);
  assert_non_null(out);
  assert_int_equal(gl_errors(), 0);
  gl.DeleteTextures(1, &desc.normal_texture);
  host_view_close(&v);
  host_close(&h);
  return out;
}

static void name(const setting *s, char *out, size_t size) {
  snprintf(out, size, "%s %s %s %s %g %s", s->spec ? s->spec : "default", s->shape ? "sun" : "rectangle",
           cast_names[s->cast], kind_names[s->kind], sqrt(dot(s->way, s->way)), s->normals ? "with normals" : "depth");
}

/* ---- lit stays lit ----------------------------------------------------------------------------------------------- */

/* Where the technique at the origin is right, that is. */
static void check_lit(const setting *s, const float *image, const float *base) {
  int known = 0, wrong = 0;
  double least = 1;
  for (int i = 0; i < PIXELS; i++) {
    if (!lit[s->shape][i] || base[i] < 1) continue;
    known++;
    wrong += !(image[i] >= 254.0 / 255);
    least = fmin(least, image[i]);
  }
  char text[160];
  name(s, text, sizeof text);
  if (wrong) fprintf(stderr, "%s: %d of %d lit pixels are darker, down to %g\n", text, wrong, known, least);
  assert_true(known > PIXELS / 3);
  assert_int_equal(wrong, 0);
}

/* ---- shadows stay ------------------------------------------------------------------------------------------------ */

/* A point may move by what the host's products lose: twelve roundings of numbers as large as the way (three in the
 * transform and the vertex, three terms and four sums in the view's product, two of the view's own numbers). A caster's
 * shadow begins so much later by the tolerances of both ends. In pixels of the nearest surface. */
static double movement(const setting *s, const camera *view) {
  double lost = 3 * 12 * 0x1p-24 * sqrt(dot(s->way, s->way)), distance = 3;
  return view_error(view, &seen) + lost * HEIGHT / (2 * camera_fov_tangent * distance);
}

static void check_shadows(const setting *s, const float *image, const float *base) {
  camera view = camera_there(v3(0, 0, 0));
  double delta = movement(s, &view);
  agreement a = agree(base, WIDTH, HEIGHT, 0, 0, image, WIDTH, HEIGHT, away[s->shape]);
  char text[160];
  name(s, text, sizeof text);
  printf("%s: mean difference %.5f, allowed %.5f\n", text, a.sum / a.pixels,
         allowed_changes(a.range * delta) / a.pixels);
  assert_true(dark_pixels(base, WIDTH, HEIGHT) > 100);
  assert_true(a.sum <= allowed_changes(a.range * delta));
  /* What is promised for meshes in memory (docs/space.md). */
  if (s->cast == CAST_MEMORY) assert_true(a.sum / a.pixels <= 0.001);
}

/* Thirty thousand units away, and three hundred; the scene is five wide. */
static void check_everywhere(pn_light_shape shape, int normals) {
  static const vec3 ways[] = {{-18000, 9000, 21000}, {180, -90, 210}};
  for (int cast = 0; cast < 3; cast++) {
    setting s = {.kind = PLACED, .cast = (cast_kind)cast, .shape = shape, .normals = normals};
    float *base = draw(&s);
    for (int k = 0; k < (normals ? 2 : 1) * KINDS; k++) {
      s.kind = (far_kind)(k % KINDS);
      s.way = ways[k / KINDS];
      float *image = draw(&s);
      check_lit(&s, image, base);
      check_shadows(&s, image, base);
      free(image);
    }
    free(base);
  }
}

static void test_rectangle(void **state) {
  (void)state;
  check_everywhere(PN_LIGHT_RECTANGLE, 1);
}

static void test_rectangle_without_normals(void **state) {
  (void)state;
  check_everywhere(PN_LIGHT_RECTANGLE, 0);
}

static void test_sun(void **state) {
  (void)state;
  check_everywhere(PN_LIGHT_SUN, 1);
}

/* Far enough that each end alone would darken lit faces: the host's depth, where the library's own map is exact; and
 * the map of the host's buffers, under depth that is. */
static void check_one_end(pn_light_shape shape, int exact_depth) {
  setting s = {.kind = PLACED, .cast = exact_depth ? CAST_BUFFERS : CAST_MEMORY, .shape = shape, .normals = 1};
  float *base = draw(&s);
  s.kind = BACK;
  s.way = v3(-150000, 140000, 200000);
  s.exact_depth = exact_depth;
  s.position_error = exact_depth ? 1e-6f : 0;
  float *image = draw(&s);
  check_lit(&s, image, base);
  free(image);
  free(base);
}

static void test_host_end(void **state) {
  (void)state;
  check_one_end(PN_LIGHT_RECTANGLE, 0);
  check_one_end(PN_LIGHT_SUN, 0);
}

static void test_map_end(void **state) {
  (void)state;
  check_one_end(PN_LIGHT_RECTANGLE, 1);
  check_one_end(PN_LIGHT_SUN, 1);
}

/* The farthest and worst for each technique: vertices in buffers. */
static void test_techniques(void **state) {
  (void)state;
  for (int i = 0; host_spec(i); i++) {
    setting s = {.kind = PLACED, .cast = CAST_BUFFERS, .normals = i % 2, .spec = host_spec(i)};
    float *base = draw(&s);
    for (int kind = BAKED; kind <= BACK; kind++) {
      s.kind = (far_kind)kind;
      s.way = v3(-6000, 3000, 7000);
      float *image = draw(&s);
      check_lit(&s, image, base);
      free(image);
    }
    free(base);
  }
}

/* ---- position_error ---------------------------------------------------------------------------------------------- */

/* Whoever says that nothing is lost is believed: then tolerances are those at the origin, and what was lost all the
 * same shows. Whoever says that very much is, gets no shadow from what is nearer than that. */
static void test_given(void **state) {
  (void)state;
  setting s = {.kind = PLACED, .cast = CAST_MEMORY, .normals = 1};
  float *base = draw(&s);
  s.position_error = 1e-9f;
  float *exact = draw(&s);
  agreement a = agree(base, WIDTH, HEIGHT, 0, 0, exact, WIDTH, HEIGHT, NULL);
  assert_true(a.sum / a.pixels < 1e-4);
  s.position_error = 100;
  float *none = draw(&s);
  for (int i = 0; i < PIXELS; i++) assert_true(none[i] == 1);
  free(base);
  free(exact);
  free(none);
}

static void test_refused(void **state) {
  (void)state;
  host h;
  camera_view v;
  camera view = camera_there(v3(0, 0, 0));
  open_far(&h, PLACED, v3(0, 0, 0));
  assert_int_equal(host_view(&h, &view, &v), PN_OK);
  const float wrong[] = {-1e-3f, NAN, INFINITY};
  for (int i = 0; i < 3; i++) {
    pn_receiver_desc desc = host_receiver_desc(&view, &v.target);
    desc.position_error = wrong[i];
    assert_int_equal(pn_receiver_set(v.receiver, &desc), PN_ERROR_ARGUMENT);
    assert_int_equal(h.log.counts[PN_MESSAGE_RECEIVER_POSITION], i + 1);
  }
  host_view_close(&v);
  host_close(&h);
}

/* What a host is told of a sun's map is in the space that begins at the scene's origin, wherever the library's own
 * frame begins. */
static void test_sun_bounds(void **state) {
  (void)state;
  double corner[2][3];
  for (int i = 0; i < 2; i++) {
    vec3 place = i ? v3(4096, -2048, 8192) : v3(0, 0, 0);
    host h;
    pn_light *light;
    pn_maps_info maps;
    open_far(&h, PLACED, place);
    assert_int_equal(host_cast(&h, CAST_MEMORY), PN_OK);
    pn_light_desc desc = host_sun_desc();
    assert_int_equal(host_light(&h, &desc, NULL, &light), PN_OK);
    assert_int_equal(pn_maps_update(light, h.casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
    assert_int_equal(pn_light_maps(light, &maps), PN_OK);
    float z[3], u[3], v[3];
    static const float up[3] = {0, 1, 0};
    assert_int_equal(pn_light_frame(desc.direction, up, z, u, v), PN_OK);
    corner[i][0] = 0.5 * ((double)maps.s0 + maps.s1) - dot(place, v3_of(u));
    corner[i][1] = 0.5 * ((double)maps.t0 + maps.t1) - dot(place, v3_of(v));
    corner[i][2] = 0.5 * ((double)maps.w_near + maps.w_far) + dot(place, v3_of(z));
    pn_light_destroy(&light);
    host_close(&h);
  }
  /* Bounds snap by up to a 32nd of the scene's size, which is four, on grids that begin elsewhere; and a float at 8192
   * has steps of 1/1024. */
  for (int k = 0; k < 3; k++) assert_true(fabs(corner[1][k] - corner[0][k]) < 0.25);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_rectangle),  cmocka_unit_test(test_rectangle_without_normals),
      cmocka_unit_test(test_sun),        cmocka_unit_test(test_host_end),
      cmocka_unit_test(test_map_end),    cmocka_unit_test(test_techniques),
      cmocka_unit_test(test_given),      cmocka_unit_test(test_refused),
      cmocka_unit_test(test_sun_bounds),
  };
  return cmocka_run_group_tests(tests, find_truth, forget_truth);
}
