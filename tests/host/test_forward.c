/* Forward shading: the library's text in the client's own shader gives what the visibility buffer gives. */
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

enum { PIXELS = CAMERA_WIDTH * CAMERA_HEIGHT };

static const char *const body = "out vec4 color;\n"
                                "void main() {\n"
                                "  vec3 n = cross(dFdx(scene), dFdy(scene));\n"
                                "  alpha_test();\n"
                                "  color = vec4(pn_visibility(0, scene, n), pn_visibility(1, scene, n), 0.0, 1.0);\n"
                                "}\n";

/* Draws with the program: two lights' visibility in red and green, 1 where nothing is. */
static float *draw_forward(host *h, const camera *view, GLuint program, pn_light *const lights[2]) {
  static const pn_slots slots = {7, 3};
  static const GLfloat lit[4] = {1, 1, 1, 1};
  GLuint color = make_texture(GL_RGBA32F, view->width, view->height);
  GLuint depth = make_texture(GL_DEPTH_COMPONENT32F, view->width, view->height);
  GLuint framebuffer = make_framebuffer(color, depth);
  float *out = malloc(PIXELS * 4 * sizeof *out), m[16];
  mat4 clip = camera_clip(view);
  to_float(&clip, m);
  assert_non_null(out);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  gl.ClearBufferfv(GL_COLOR, 0, lit);
  gl.Enable(GL_DEPTH_TEST);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.Viewport(0, 0, view->width, view->height);
  assert_int_equal(pn_bind(lights, 2, program, &slots), PN_OK);
  renderer_draw(&h->draw, &h->world, program, m, DRAW_ALL);
  gl.Disable(GL_DEPTH_TEST);
  gl.ReadPixels(0, 0, view->width, view->height, GL_RGBA, GL_FLOAT, out);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl.DeleteFramebuffers(1, &framebuffer);
  gl.DeleteTextures(1, &color);
  gl.DeleteTextures(1, &depth);
  return out;
}

static void check_technique(host *h, const char *spec) {
  pn_light_desc descs[2] = {host_light_desc(), host_light_desc_other()};
  camera view = camera_at(0);
  camera_view v;
  surfaces seen;
  pn_light *lights[2];
  float *deferred[2];
  assert_int_equal(host_view(h, &view, &v), PN_OK);
  assert_true(surfaces_draw(&seen, &h->draw, &h->world, &view));
  for (int i = 0; i < 2; i++) {
    assert_int_equal(host_light(h, &descs[i], spec, &lights[i]), PN_OK);
    deferred[i] = host_visibility(h, lights[i], &v);
    assert_non_null(deferred[i]);
  }
  const char *text = pn_glsl(h->context, spec, 330, 0);
  assert_non_null(text);
  assert_null(strstr(text, "#version"));
  GLuint program = renderer_program(text, body);
  assert_true(program != 0);
  float *both = draw_forward(h, &view, program, lights), *image = malloc(PIXELS * sizeof *image);
  unsigned char *skip_pixel = calloc(PIXELS, 1);
  assert_non_null(image);
  assert_non_null(skip_pixel);
  for (int i = 0; i < PIXELS; i++) {
    skip_pixel[i] = seen.position[4 * i + 3] >= 0 && !truth_plane_known(&seen, i % CAMERA_WIDTH, i / CAMERA_WIDTH);
  }
  /* The shader's interpolated position and the one from depth, each within rounding of the true one. */
  double delta = 2 * view_error(&view, &seen), sample = 1.0 / 64;
  for (int k = 0; k < 2; k++) {
    for (int i = 0; i < PIXELS; i++) image[i] = both[4 * i + k];
    char name[80];
    snprintf(name, sizeof name, "forward-%s-%d", spec, k);
    save_picture(name, image, CAMERA_WIDTH, CAMERA_HEIGHT);
    agreement a = agree(deferred[k], CAMERA_WIDTH, CAMERA_HEIGHT, 0, 0, image, CAMERA_WIDTH, CAMERA_HEIGHT, skip_pixel);
    printf("%s, light %d: %d differ, mean %.2g, worst %.2g\n", spec, k, a.differing, a.sum / a.pixels, a.worst);
    assert_true(a.range > 100);
    assert_true(a.sum / sample <= allowed_changes(a.range * delta / sample));
  }
  free(both), free(image), free(skip_pixel);
  for (int i = 0; i < 2; i++) free(deferred[i]), pn_light_destroy(&lights[i]);
  gl.DeleteProgram(program);
  surfaces_free(&seen);
  host_view_close(&v);
}

/* Every technique that says it has a forward form. */
static void test_forward(void **state) {
  host *h = *state;
  int count = 0;
  assert_int_equal(host_cast(h, CAST_MEMORY), PN_OK);
  for (int i = 0; i < pn_technique_count(); i++) {
    if (!pn_technique_at(i)->forward) continue;
    check_technique(h, pn_technique_at(i)->name);
    count++;
  }
  assert_true(count >= 3);
  host_uncast(h);
}

/* ---- which lights go together ------------------------------------------------------------------------------------ */

static pn_result bind_two(host *h, const char *const specs[2], uint32_t groups) {
  static const pn_slots slots = {7, 3};
  pn_light_desc desc = host_light_desc();
  pn_light *lights[2];
  desc.map_width = 32;
  for (int i = 0; i < 2; i++) {
    assert_int_equal(host_light(h, &desc, specs[i], &lights[i]), PN_OK);
    assert_int_equal(pn_maps_update(lights[i], h->casters, groups, NULL, 0), PN_OK);
  }
  const char *text = pn_glsl(h->context, specs[0], 330, 0);
  assert_non_null(text);
  GLuint program = renderer_program(text, body);
  assert_true(program != 0);
  pn_result result = pn_bind(lights, 2, program, &slots);
  gl.DeleteProgram(program);
  for (int i = 0; i < 2; i++) pn_light_destroy(&lights[i]);
  return result;
}

/* Lights share a program where its text is the same for both: what is compiled of their parameters must be alike, what
 * is read from the block may differ. */
static void test_lights_together(void **state) {
  static const struct {
    const char *specs[2];
    pn_result result;
  } pairs[] = {
      {{"bitmask", "bitmask:samples=8"}, PN_ERROR_ARGUMENT},
      {{"bitmask:samples=8", "bitmask:samples=8"}, PN_OK},
      {{"bitmask", "bitmask:merge=3"}, PN_OK},
      {{"bitmask", "bitmask:merge=0"}, PN_ERROR_ARGUMENT}, /* no merging is another search */
      {{"bitmask:cap=3", "bitmask:cap=8"}, PN_OK},
      {{"bitmask", "bitmask:primitive=patch"}, PN_ERROR_ARGUMENT},
      {{"pcf:taps=3", "pcf:taps=9"}, PN_OK},
      {{"pcf", "pcss"}, PN_ERROR_ARGUMENT},
      {{"smoothies:geometry=edges", "smoothies:width=0.2"}, PN_OK},
  };
  host *h = *state;
  assert_int_equal(host_cast(h, CAST_MEMORY), PN_OK);
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
    int told = h->log.counts[PN_MESSAGE_FORWARD];
    pn_result result = bind_two(h, pairs[i].specs, PN_GROUPS_ALL);
    if (result != pairs[i].result)
      fail_msg("%s with %s: %s", pairs[i].specs[0], pairs[i].specs[1], pn_result_name(result));
    assert_int_equal(h->log.counts[PN_MESSAGE_FORWARD], told + (result != PN_OK));
  }
  host_uncast(h);
}

/* A light under which nothing casts binds nothing that it has kept from another technique. */
static void test_nothing_casts(void **state) {
  static const pn_slots slots = {7, 3};
  static const char *const others[] = {"average:samples=40", "ssm", "bitmask", "hard"};
  host *h = *state;
  assert_int_equal(host_cast(h, CAST_MEMORY), PN_OK);
  const char *text = pn_glsl(h->context, "smoothies", 330, 0);
  GLuint program = renderer_program(text, body);
  assert_true(program != 0);
  for (int i = 0; i < 4; i++) {
    camera view = camera_sized(0, 32, 24);
    camera_view v;
    pn_light_desc desc = host_light_desc();
    pn_light *light = NULL;
    assert_int_equal(host_view(h, &view, &v), PN_OK);
    assert_int_equal(host_light(h, &desc, others[i], &light), PN_OK);
    free(host_visibility(h, light, &v));
    assert_int_equal(pn_light_technique(light, "smoothies", NULL, 0), PN_OK);
    assert_int_equal(pn_maps_update(light, h->casters, 0, NULL, 0), PN_OK);
    assert_int_equal(pn_bind(&light, 1, program, &slots), PN_OK);
    assert_int_equal(gl_errors(), 0);
    pn_light_destroy(&light);
    host_view_close(&v);
  }
  gl.DeleteProgram(program);
  host_uncast(h);
}

/* ---- texts ------------------------------------------------------------------------------------------------------- */

/* A program drawn after the host changed everything else still finds its maps: pn_bind's bindings stay. The same text
 * compiles with the caster's snippet beside it. */
static void test_texts_together(void **state) {
  host *h = *state;
  const char *parts[2] = {pn_glsl(h->context, "pcss", 330, 0), pn_glsl(h->context, "caster", 330, 0)};
  assert_non_null(parts[0]);
  assert_non_null(parts[1]);
  size_t bytes = strlen(parts[0]) + strlen(parts[1]) + 2;
  char *text = malloc(bytes);
  assert_non_null(text);
  snprintf(text, bytes, "%s\n%s", parts[0], parts[1]);
  GLuint program = renderer_program(text, "out vec4 color;\nvoid main() { pn_peel(); alpha_test();\n"
                                          "color = vec4(pn_visibility(0, scene, vec3(0.0, 1.0, 0.0))); }\n");
  free(text);
  assert_true(program != 0);
  gl.DeleteProgram(program);
}

/* The text for OpenGL ES 3 compiles and links there. */
static void test_es(void **state) {
  static const char *const vertex = "#version 300 es\nin vec3 position;\nout highp vec3 scene;\n"
                                    "void main() { scene = position; gl_Position = vec4(position, 1.0); }\n";
  static const char *const head = "#version 300 es\nprecision highp float;\nprecision highp int;\n"
                                  "precision highp sampler2D;\nprecision highp sampler2DArray;\n";
  static const char *const tails[2] = {
      "in vec3 scene;\nout vec4 color;\nvoid main() { color = vec4(pn_visibility(0, scene, vec3(0.0, 1.0, 0.0))); }\n",
      "out vec4 color;\nvoid main() { pn_peel(); color = vec4(1.0); }\n"};
  host *h = *state;
  headless es;
  enum { MOST = 32 };
  const char *texts[MOST];
  int tail[MOST], count = 0, wrong = 0;
  for (int i = 0; i < pn_technique_count() && count < MOST - 1; i++) {
    if (!pn_technique_at(i)->forward) continue;
    texts[count] = pn_glsl(h->context, pn_technique_at(i)->name, 300, 1);
    assert_non_null(texts[count]);
    tail[count++] = 0;
  }
  texts[count] = pn_glsl(h->context, "caster", 300, 1);
  assert_non_null(texts[count]);
  tail[count++] = 1;
  if (!headless_open_es(&h->window, &es)) skip();
  for (int i = 0; i < count; i++) {
    const char *fragment[3] = {head, texts[i], tails[tail[i]]};
    GLuint program = compile_program(&vertex, 1, fragment, 3);
    wrong += program == 0;
    gl.DeleteProgram(program);
  }
  headless_close_es(&es);
  headless_current(&h->window);
  assert_int_equal(wrong, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_forward, host_check),
      cmocka_unit_test_teardown(test_lights_together, host_check),
      cmocka_unit_test_teardown(test_nothing_casts, host_check),
      cmocka_unit_test_teardown(test_texts_together, host_check),
      cmocka_unit_test_teardown(test_es, host_check),
  };
  return cmocka_run_group_tests_name("forward", tests, host_setup, host_teardown);
}
