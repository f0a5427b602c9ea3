/* pn_prepare: after it no frame compiles anything, nothing is left of it, and nothing is heard of it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "counted.h"
#include "host.h"

enum { WIDTH = 40, HEIGHT = 30 };

static host h;
static camera view;
static depth_target target;
static GLuint normals, mask;

/* ---- contexts that count ----------------------------------------------------------------------------------------- */

static pn_state_mode mode;

static void open_context(void) {
  pn_context_desc desc = host_context_desc(&h);
  desc.get_proc_address = counted_address;
  desc.state = mode;
  memset(&h.log, 0, sizeof h.log);
  assert_int_equal(pn_context_create(&desc, &h.context), PN_OK);
}

static void close_context(void) {
  pn_context_destroy(&h.context);
  h.casters = NULL;
}

static long compiled(void) { return counted_calls("glCompileShader") + counted_calls("glLinkProgram"); }

static int messages(void) {
  int count = 0;
  for (int i = 0; i < PN_MESSAGE_COUNT; i++) count += h.log.counts[i];
  return count;
}

/* ---- views ------------------------------------------------------------------------------------------------------- */

typedef struct {
  const char *name;
  int normals, mask, scale;
  pn_normal_encoding encoding;
} kind;

static const kind kinds[] = {
    {"from depth", 0, 0, 1, 0}, {"normals", 1, 0, 1, PN_NORMAL_UNSIGNED},        {"mask", 0, 1, 1, 0},
    {"half size", 0, 0, 2, 0},  {"all", 1, 1, 2, PN_NORMAL_OCTAHEDRON_UNSIGNED},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static pn_receiver_desc describe(const kind *k) {
  pn_receiver_desc desc = host_receiver_desc(&view, &target);
  desc.normal_texture = k->normals ? normals : 0;
  desc.normal_encoding = k->encoding;
  desc.mask_texture = k->mask ? mask : 0;
  desc.scale = k->scale;
  return desc;
}

/* As a host may fill it before any of its textures exist. */
static pn_receiver_desc describe_early(const kind *k) {
  pn_receiver_desc desc = {.normal_encoding = k->encoding, .scale = k->scale, .format = PN_FORMAT_R32F};
  desc.normal_texture = k->normals ? 4711 : 0;
  desc.mask_texture = k->mask ? 4712 : 0;
  return desc;
}

/* ---- a first frame ----------------------------------------------------------------------------------------------- */

/* Meshes, one of them with holes; a fit of each kind, and both shapes of light. */
static void first_frame(const char *spec, const pn_receiver_desc *seen, int variant) {
  pn_receiver *receiver = NULL;
  pn_light *light = NULL;
  pn_light_desc desc = variant % 2 ? host_sun_desc() : host_light_desc();
  desc.map_width = desc.map_height = 32;
  desc.fit = variant % 3 == 0 ? PN_FIT_CASTERS : variant % 3 == 1 ? PN_FIT_VISIBLE : PN_FIT_FRUSTUM;
  assert_int_equal(host_cast(&h, CAST_MEMORY), PN_OK);
  assert_int_equal(pn_receiver_create(h.context, &receiver), PN_OK);
  assert_int_equal(pn_receiver_set(receiver, seen), PN_OK);
  assert_int_equal(host_light(&h, &desc, spec, &light), PN_OK);
  assert_int_equal(pn_maps_update(light, h.casters, PN_GROUPS_ALL, &receiver, 1), PN_OK);
  assert_int_equal(pn_visibility(light, receiver), PN_OK);
}

static void check(const char *spec, const kind *k, int variant, const pn_receiver_desc *like) {
  pn_receiver_desc seen = describe(k);
  open_context();
  size_t before = host_gpu_memory(&h);
  counted_reset();
  pn_result result = pn_prepare(h.context, spec, like);
  if (result != PN_OK) fail_msg("%s: %s", spec, h.log.last);
  assert_true(compiled() > 0);
  assert_int_equal(host_gpu_memory(&h), before);
  assert_int_equal(messages(), 0);
  counted_reset();
  first_frame(spec, &seen, variant);
  assert_true(counted_calls("glDraw") > 0);
  if (compiled() > 0) fail_msg("%s, %s: %ld more are compiled in the first frame", spec, k->name, compiled());
  close_context();
}

/* Every technique with every preset, each with some of the views: between them every view comes with every technique.
 * */
static void test_first_frame(void **state) {
  (void)state;
  if (!counted_available()) skip();
  int variant = 0;
  for (int t = 0; t < pn_technique_count(); t++) {
    const pn_technique *technique = pn_technique_at(t);
    const pn_parameter *preset = NULL;
    for (int i = 0; i < technique->parameter_count; i++)
      if (strcmp(technique->parameters[i].name, "preset") == 0) preset = &technique->parameters[i];
    int presets = preset ? (int)preset->most + 1 : 1;
    for (int i = 0; i < KINDS; i++, variant++) {
      char spec[80];
      int choice = variant % presets;
      /* average's maps are many, and drawn alike. */
      const char *few = strcmp(technique->name, "average") == 0 ? ",samples=20" : "";
      snprintf(spec, sizeof spec, preset ? "%s:preset=%s%s" : "%s", technique->name,
               preset ? preset->choices[choice] : "", few);
      pn_receiver_desc like = describe_early(&kinds[i]);
      check(spec, &kinds[i], variant, &like);
    }
  }
}

/* What the first views leave out: each preset at least once with the plainest view. */
static void test_presets(void **state) {
  static const char *const specs[] = {"ssm:preset=fast",
                                      "ssm:preset=exact",
                                      "bitmask:preset=fast",
                                      "bitmask:preset=exact",
                                      "pcss:preset=exact",
                                      "smoothies:preset=fast",
                                      "backprojection:preset=exact",
                                      "ssm:extents=cpu",
                                      "ssm:accumulate=fp16-batched",
                                      "bitmask:maps=layers",
                                      "smoothies:geometry=edges"};
  (void)state;
  if (!counted_available()) skip();
  for (int i = 0; i < (int)(sizeof specs / sizeof *specs); i++) {
    pn_receiver_desc like = describe_early(&kinds[0]);
    check(specs[i], &kinds[0], i, &like);
  }
}

/* Without a view: what most hosts have. Without a spec: the default technique. */
static void test_usual(void **state) {
  (void)state;
  if (!counted_available()) skip();
  check("hard", &kinds[0], 1, NULL);
  open_context();
  assert_int_equal(pn_prepare(h.context, NULL, NULL), PN_OK);
  pn_receiver_desc seen = describe(&kinds[0]);
  counted_reset();
  first_frame(PN_TECHNIQUE_DEFAULT, &seen, 1);
  assert_int_equal(compiled(), 0);
  seen = describe(&(kind){"signed normals", 1, 0, 1, PN_NORMAL_SIGNED});
  host_uncast(&h);
  first_frame(PN_TECHNIQUE_DEFAULT, &seen, 1);
  assert_int_equal(compiled(), 0);
  close_context();
}

/* Twice is once. */
static void test_again(void **state) {
  (void)state;
  if (!counted_available()) skip();
  open_context();
  pn_receiver_desc like = describe_early(&kinds[4]);
  assert_int_equal(pn_prepare(h.context, "ssm", &like), PN_OK);
  counted_reset();
  assert_int_equal(pn_prepare(h.context, "ssm", &like), PN_OK);
  assert_int_equal(compiled(), 0);
  close_context();
}

/* ---- what the host wished for ------------------------------------------------------------------------------------ */

static int has_image(pn_light *light, pn_receiver *receiver, const char *wanted) {
  const char *name = NULL;
  pn_image image;
  for (int i = 0; pn_debug_image(light, receiver, i, &name, &image); i++)
    if (strcmp(name, wanted) == 0) return 1;
  return 0;
}

/* Timing and debug images are on or off as they were, after success and failure; while it is at work they are off. */
static void test_switches(void **state) {
  (void)state;
  for (int on = 0; on < 2; on++) {
    mode = PN_STATE_RESTORE;
    open_context();
    assert_int_equal(pn_timing(h.context, on), PN_OK);
    assert_int_equal(pn_debug(h.context, on ? PN_DEBUG_SEARCH : 0), PN_OK);
    counted_reset();
    assert_int_equal(pn_prepare(h.context, "bitmask:preset=fast", NULL), PN_OK);
    assert_int_equal(counted_calls("glQueryCounter") + counted_calls("glFinish"), 0);
    assert_int_equal(pn_prepare(h.context, "nothing", NULL), PN_ERROR_ARGUMENT);
    assert_int_equal(pn_prepare(h.context, "hard", &(pn_receiver_desc){.scale = 3}), PN_ERROR_ARGUMENT);
    assert_int_equal(h.log.counts[PN_MESSAGE_TECHNIQUE_UNKNOWN], 1);
    assert_int_equal(h.log.counts[PN_MESSAGE_RECEIVER_SCALE], 1);
    pn_light *light = NULL;
    pn_light_desc desc = host_light_desc();
    pn_receiver *receiver = NULL;
    pn_receiver_desc seen = describe(&kinds[0]);
    pn_time times[8];
    assert_int_equal(host_cast(&h, CAST_MEMORY), PN_OK);
    assert_int_equal(pn_receiver_create(h.context, &receiver), PN_OK);
    assert_int_equal(pn_receiver_set(receiver, &seen), PN_OK);
    assert_int_equal(host_light(&h, &desc, "bitmask:preset=fast", &light), PN_OK);
    assert_int_equal(pn_maps_update(light, h.casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
    assert_int_equal(pn_visibility(light, receiver), PN_OK);
    assert_int_equal(has_image(light, receiver, "search"), on);
    assert_int_equal(pn_times(light, times, 8, 1) > 0, on);
    close_context();
  }
}

/* Messages of what it draws are kept back, the host's own are not, before and after. */
static void test_silence(void **state) {
  (void)state;
  open_context();
  assert_int_equal(pn_prepare(h.context, "smoothies", NULL), PN_OK);
  assert_int_equal(pn_prepare(h.context, "ssm:accumulate=fp16", NULL), PN_OK);
  assert_int_equal(messages(), 0);
  pn_receiver_desc seen = describe(&kinds[0]);
  first_frame("smoothies", &seen, 0);
  assert_true(h.log.counts[PN_MESSAGE_CASTER_MESHES] == 1); /* the flag has holes */
  close_context();
}

/* In a bracket, and where the state is the defaults afterwards. */
static void test_modes(void **state) {
  static const pn_state_mode modes[2] = {PN_STATE_SCOPED, PN_STATE_RESET};
  (void)state;
  if (!counted_available()) skip();
  for (int i = 0; i < 2; i++) {
    mode = modes[i];
    open_context();
    assert_int_equal(pn_state_begin(h.context), PN_OK);
    pn_receiver_desc like = describe_early(&kinds[4]), seen = describe(&kinds[4]);
    assert_int_equal(pn_prepare(h.context, "pcss", &like), PN_OK);
    counted_reset();
    first_frame("pcss", &seen, 1);
    assert_int_equal(compiled(), 0);
    assert_int_equal(pn_state_end(h.context), PN_OK);
    close_context();
  }
  mode = PN_STATE_RESTORE;
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  view = camera_sized(0, WIDTH, HEIGHT);
  if (!target_open(&target, &view)) return -1;
  renderer_depth(&h.draw, &h.world, &view, &target);
  normals = make_texture(GL_RGBA8, WIDTH, HEIGHT);
  mask = make_texture(GL_RGBA8, WIDTH, HEIGHT);
  return gl_errors();
}

static int teardown(void **state) {
  (void)state;
  gl.DeleteTextures(1, &normals);
  gl.DeleteTextures(1, &mask);
  target_close(&target);
  host_close(&h);
  return 0;
}

/* After a test that failed half-way too. */
static int clean(void **state) {
  (void)state;
  mode = PN_STATE_RESTORE;
  close_context();
  return gl_errors();
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_first_frame, clean), cmocka_unit_test_teardown(test_presets, clean),
      cmocka_unit_test_teardown(test_usual, clean),       cmocka_unit_test_teardown(test_again, clean),
      cmocka_unit_test_teardown(test_switches, clean),    cmocka_unit_test_teardown(test_silence, clean),
      cmocka_unit_test_teardown(test_modes, clean),
  };
  return cmocka_run_group_tests_name("prepare", tests, setup, teardown);
}
