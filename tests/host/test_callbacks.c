/* Draw callbacks: when they are called, under which state, and that whatever they leave behind reaches nobody else. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "agreement.h"
#include "host.h"
#include "state.h"

enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT, GROUPS = 3 };

static host h;
static camera_view v;
static odd_objects odd;
static GLuint programs[2]; /* without and with pn_peel() */

/* ---- three callbacks, a part of the scene each ------------------------------------------------------------------- */

typedef struct {
  int first, last; /* meshes */
  int messy;       /* leaves everything unlike it found it */
  int calls, peeled, wrong;
  GLint framebuffer; /* of the first call of an update */
} part;

static part parts[GROUPS];

static GLint integer(GLenum name) {
  GLint values[4] = {0};
  gl.GetIntegerv(name, values);
  return values[0];
}

/* What penumbra.h promises to a callback. */
static int state_as_promised(const pn_caster_pass *pass) {
  GLint viewport[4], function = integer(GL_DEPTH_FUNC);
  gl.GetIntegerv(GL_VIEWPORT, viewport);
  GLint peel = 0;
  if (pass->peel_texture) {
    gl.ActiveTexture(GL_TEXTURE0 + (GLenum)pass->peel_unit);
    peel = integer(GL_TEXTURE_BINDING_2D);
  }
  GLint faces = pass->faces == PN_FACES_BACK ? GL_FRONT : GL_BACK;
  return viewport[0] == 0 && viewport[1] == 0 && viewport[2] == pass->width && viewport[3] == pass->height &&
         (function == GL_LESS || function == GL_GREATER) && integer(GL_DEPTH_WRITEMASK) &&
         gl.IsEnabled(GL_DEPTH_TEST) && gl.IsEnabled(GL_DEPTH_CLAMP) && !gl.IsEnabled(GL_RASTERIZER_DISCARD) &&
         !gl.IsEnabled(GL_STENCIL_TEST) && !gl.IsEnabled(GL_PRIMITIVE_RESTART) && !gl.IsEnabled(GL_CLIP_DISTANCE0) &&
         integer(GL_POLYGON_MODE) == GL_FILL && integer(GL_FRONT_FACE) == GL_CCW &&
         gl.IsEnabled(GL_CULL_FACE) == (pass->faces != PN_FACES_ANY) &&
         (pass->faces == PN_FACES_ANY || integer(GL_CULL_FACE_MODE) == faces) && (GLuint)peel == pass->peel_texture &&
         gl.CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

static void draw_part(const part *p, const pn_caster_pass *pass) {
  GLuint program = programs[pass->peel_texture != 0];
  scene some = h.world;
  for (int i = 0; i < some.count; i++) some.meshes[i].casts = some.meshes[i].casts && i >= p->first && i <= p->last;
  if (pass->peel_texture) {
    gl.UseProgram(program);
    gl.Uniform1i(gl.GetUniformLocation(program, "pn_peel_map"), pass->peel_unit);
  }
  gl.BindSampler(0, 0);
  renderer_draw(&h.draw, &some, program, pass->clip_from_scene, DRAW_CASTERS);
}

/* Everything unlike its default; the queries that come with it are the test's own trouble. */
static void make_mess(void) {
  odd_set(&odd);
  gl.EndQuery(GL_TIME_ELAPSED);
  gl.EndQuery(GL_SAMPLES_PASSED);
}

static void callback(void *user, const pn_caster_pass *pass) {
  part *p = user;
  GLint framebuffer = integer(GL_DRAW_FRAMEBUFFER_BINDING);
  if (p->calls++ == 0) p->framebuffer = framebuffer;
  p->peeled += pass->peel_texture != 0;
  p->wrong += framebuffer == 0 || framebuffer != parts[0].framebuffer || !state_as_promised(pass);
  draw_part(p, pass);
  if (p->messy) make_mess();
}

static void set_callbacks(int messy) {
  static const int first[GROUPS] = {SCENE_BOX, SCENE_TORUS, SCENE_FLAG},
                   last[GROUPS] = {SCENE_SLAB, SCENE_TORUS, SCENE_FLAG};
  float bounds[6];
  scene_bounds(&h.world, bounds);
  assert_int_equal(pn_casters_create(h.context, &h.casters), PN_OK);
  for (int i = 0; i < GROUPS; i++) {
    parts[i] = (part){.first = first[i], .last = last[i], .messy = messy};
    assert_int_equal(pn_casters_draw(h.casters, 3 * i, callback, &parts[i], bounds), PN_OK);
  }
}

/* ---- lights ------------------------------------------------------------------------------------------------------ */

static pn_light *light_with(const char *spec) {
  pn_light *light = NULL;
  pn_light_desc desc = host_light_desc();
  desc.map_width = 64;
  desc.fit = PN_FIT_GIVEN; /* callbacks and meshes have the same map */
  scene_bounds(&h.world, desc.fit_bounds);
  assert_int_equal(host_light(&h, &desc, spec, &light), PN_OK);
  return light;
}

static int total_calls(void) {
  int calls = 0;
  for (int i = 0; i < GROUPS; i++) calls += parts[i].calls;
  return calls;
}

/* ---- when -------------------------------------------------------------------------------------------------------- */

/* In pn_maps_update and in no other call: not in pn_visibility, not in pn_prepare, not again for another view. */
static void test_when(void **state) {
  (void)state;
  for (int i = 0; host_spec(i); i++) {
    set_callbacks(0);
    pn_light *light = light_with(host_spec(i));
    assert_int_equal(total_calls(), 0);
    assert_int_equal(pn_maps_update(light, h.casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
    int calls = total_calls();
    assert_true(calls >= GROUPS);
    assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
    assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
    if (i == 0) assert_int_equal(pn_prepare(h.context, "hard", NULL), PN_OK);
    if (total_calls() != calls) fail_msg("%s calls back in pn_visibility", host_spec(i));
    for (int k = 0; k < GROUPS; k++) assert_int_equal(parts[k].calls, parts[0].calls);
    pn_light_destroy(&light);
    host_uncast(&h);
  }
}

/* Groups that are left out are not called. */
static void test_groups(void **state) {
  (void)state;
  set_callbacks(0);
  pn_light *light = light_with("average:samples=20");
  assert_int_equal(pn_maps_update(light, h.casters, 1u << 3, NULL, 0), PN_OK);
  assert_int_equal(parts[0].calls, 0);
  assert_true(parts[1].calls >= 20); /* each sample has its own map */
  assert_int_equal(parts[2].calls, 0);
  pn_light_destroy(&light);
  host_uncast(&h);
}

/* average keeps what the callbacks drew: a second view, and casters that are gone, change nothing. */
static void test_average_keeps(void **state) {
  (void)state;
  set_callbacks(0);
  pn_light *light = light_with("average:samples=40");
  float *first = host_visibility(&h, light, &v);
  host_uncast(&h);
  assert_int_equal(pn_visibility(light, v.receiver), PN_OK);
  float *second = host_result(light, v.receiver);
  assert_true(dark_pixels(first, WIDTH, HEIGHT) > 100);
  assert_memory_equal(first, second, PIXELS * sizeof *first);
  free(first), free(second);
  pn_light_destroy(&light);
}

/* More samples than were drawn in the last update are not there: they have to be drawn first. */
static void test_average_samples(void **state) {
  static const double counts[] = {200, 16, 17, 1};
  (void)state;
  for (int i = 0; i < 4; i++) {
    char spec[40];
    set_callbacks(0);
    pn_light *light = light_with("average:samples=40");
    free(host_visibility(&h, light, &v));
    assert_int_equal(pn_light_parameter(light, "samples", counts[i]), PN_OK);
    assert_int_equal(pn_visibility(light, v.receiver), PN_ERROR_NOT_READY);
    float *changed = host_visibility(&h, light, &v);
    snprintf(spec, sizeof spec, "average:samples=%g", counts[i]);
    pn_light *other = light_with(spec);
    float *fresh = host_visibility(&h, other, &v);
    assert_memory_equal(changed, fresh, PIXELS * sizeof *fresh);
    free(changed), free(fresh);
    pn_light_destroy(&light);
    pn_light_destroy(&other);
    host_uncast(&h);
  }
}

/* ---- what they draw ---------------------------------------------------------------------------------------------- */

static void draw_nothing(void *user, const pn_caster_pass *pass) { (void)user, (void)pass; }

/* The scene as meshes within the callbacks' bounds, which are wider than boxes around meshes: the same planes near and
 * far, and all that is placed by them. */
static void set_meshes(void) {
  float bounds[6];
  scene_bounds(&h.world, bounds);
  assert_int_equal(host_cast(&h, CAST_MEMORY), PN_OK);
  assert_int_equal(pn_casters_draw(h.casters, 31, draw_nothing, NULL, bounds), PN_OK);
}

/* As the same triangles given as meshes. The shaders differ, so that depth and edges may by rounding: at the borders of
 * texels, which are a few of a hundred pixels. */
static void test_as_meshes(void **state) {
  (void)state;
  for (int i = 0; host_spec(i); i++) {
    const pn_technique *technique = NULL;
    assert_int_equal(pn_technique_parse(host_spec(i), &technique, NULL, NULL, 0), PN_OK);
    if (technique->needs_meshes) continue;
    set_callbacks(0);
    pn_light *light = light_with(host_spec(i));
    float *called = host_visibility(&h, light, &v);
    host_uncast(&h);
    set_meshes();
    float *meshes = host_visibility(&h, light, &v);
    host_uncast(&h);
    int differ = 0;
    for (int p = 0; p < PIXELS; p++) differ += called[p] - meshes[p] > 1.0f / 256 || meshes[p] - called[p] > 1.0f / 256;
    printf("%s: %d of %d pixels differ by more than 1/256\n", host_spec(i), differ, PIXELS);
    assert_true(dark_pixels(meshes, WIDTH, HEIGHT) > 100);
    assert_true(differ < PIXELS / 50);
    free(called), free(meshes);
    pn_light_destroy(&light);
  }
}

/* ---- what they leave --------------------------------------------------------------------------------------------- */

static float *shadow(const char *spec, int messy) {
  set_callbacks(messy);
  pn_light *light = light_with(spec);
  float *image = host_visibility(&h, light, &v);
  if (messy) odd_unset(&odd);
  for (int i = 0; i < GROUPS; i++) {
    if (parts[i].wrong)
      fail_msg("%s, callback %d: %d of %d calls under another state", spec, i, parts[i].wrong, parts[i].calls);
    assert_true(parts[i].calls > 0);
  }
  assert_int_equal(gl_errors(), 0);
  pn_light_destroy(&light);
  host_uncast(&h);
  return image;
}

static void test_mess(void **state) {
  (void)state;
  for (int i = 0; host_spec(i); i++) {
    float *clean = shadow(host_spec(i), 0);
    float *messy = shadow(host_spec(i), 1);
    assert_non_null(clean);
    assert_non_null(messy);
    assert_true(dark_pixels(clean, WIDTH, HEIGHT) > 100);
    if (memcmp(clean, messy, PIXELS * sizeof *clean) != 0)
      fail_msg("%s: a callback's mess changes the shadow", host_spec(i));
    free(clean), free(messy);
  }
}

static state_list before, after;

/* The mess of a callback is cleared up with the library's own state: the host finds its own. */
static void test_mess_restored(void **state) {
  (void)state;
  for (int i = 0; host_spec(i); i++) {
    set_callbacks(1);
    pn_light *light = light_with(host_spec(i));
    state_read(&before);
    assert_int_equal(pn_maps_update(light, h.casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
    state_read(&after);
    /* What the library never sets is the callback's own doing: it is told to leave only what a caster's draw needs. */
    static const char *const saved[] = {"VIEWPORT",
                                        "SCISSOR_BOX",
                                        "CURRENT_PROGRAM",
                                        "DRAW_FRAMEBUFFER_BINDING",
                                        "READ_FRAMEBUFFER_BINDING",
                                        "DEPTH_FUNC",
                                        "DEPTH_TEST",
                                        "DEPTH_WRITEMASK",
                                        "CULL_FACE",
                                        "CULL_FACE_MODE",
                                        "FRONT_FACE",
                                        "SCISSOR_TEST",
                                        "STENCIL_TEST",
                                        "RASTERIZER_DISCARD",
                                        "COLOR_WRITEMASK[0]",
                                        "BLEND[0]",
                                        "POLYGON_MODE",
                                        "VERTEX_ARRAY_BINDING",
                                        "ARRAY_BUFFER_BINDING",
                                        "ACTIVE_TEXTURE",
                                        "DEPTH_CLAMP",
                                        "PRIMITIVE_RESTART",
                                        "DITHER",
                                        "CLIP_DISTANCE0",
                                        "PACK_ALIGNMENT",
                                        "UNPACK_ALIGNMENT",
                                        "PROVOKING_VERTEX",
                                        "CLAMP_READ_COLOR"};
    int changed = 0;
    for (int e = 0; e < before.count; e++)
      for (size_t k = 0; k < sizeof saved / sizeof *saved; k++) {
        if (strcmp(before.entries[e].name, saved[k]) != 0) continue;
        if (memcmp(before.entries[e].value, after.entries[e].value, sizeof before.entries[e].value) == 0) continue;
        fprintf(stderr, "%s: %s is %g, was %g\n", host_spec(i), saved[k], after.entries[e].value[0],
                before.entries[e].value[0]);
        changed++;
      }
    odd_unset(&odd);
    assert_int_equal(changed, 0);
    pn_light_destroy(&light);
    host_uncast(&h);
  }
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  camera view = camera_sized(0, WIDTH, HEIGHT);
  if (host_context(&h) != PN_OK || host_view(&h, &view, &v) != PN_OK) return -1;
  odd_open(&odd);
  const char *text = pn_glsl(h.context, "caster", 330, 0);
  if (!text) return -1;
  programs[0] = renderer_program(NULL, renderer_caster_body(0));
  programs[1] = renderer_program(text, renderer_caster_body(1));
  odd_unset(&odd);
  gl.Viewport(0, 0, WIDTH, HEIGHT);
  gl.Scissor(0, 0, WIDTH, HEIGHT);
  return !programs[0] || !programs[1] || gl_errors();
}

static int teardown(void **state) {
  (void)state;
  gl.DeleteProgram(programs[0]);
  gl.DeleteProgram(programs[1]);
  odd_close(&odd);
  host_view_close(&v);
  host_close(&h);
  return 0;
}

static int clean(void **state) {
  (void)state;
  host_uncast(&h);
  odd_unset(&odd);
  return gl_errors();
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_when, clean),          cmocka_unit_test_teardown(test_groups, clean),
      cmocka_unit_test_teardown(test_average_keeps, clean), cmocka_unit_test_teardown(test_average_samples, clean),
      cmocka_unit_test_teardown(test_as_meshes, clean),     cmocka_unit_test_teardown(test_mess, clean),
      cmocka_unit_test_teardown(test_mess_restored, clean),
  };
  return cmocka_run_group_tests_name("callbacks", tests, setup, teardown);
}
