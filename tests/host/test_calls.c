/* How many GL calls a frame takes. The numbers are printed; what is asserted of them is what the library owes: a frame
 * like the one before it makes nothing, reads nothing where it promised to, draws what there is to draw and nothing
 * twice. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "counted.h"
#include "host.h"

enum { WIDTH = 96, HEIGHT = 72, LIGHTS_MOST = 16, MODES = 3 };

static const pn_state_mode modes[MODES] = {PN_STATE_RESTORE, PN_STATE_SCOPED, PN_STATE_RESET};
static const char *const mode_names[MODES] = {"restore", "scoped", "reset"};

static host h;
static camera view;
static depth_target target;

/* ---- a frame ----------------------------------------------------------------------------------------------------- */

typedef struct {
  const char *spec;
  pn_state_mode mode;
  int count;
  pn_light *lights[LIGHTS_MOST];
  pn_receiver *receiver;
} bench;

static void bench_open(bench *b, const char *spec, pn_state_mode mode, int count) {
  pn_context_desc desc = host_context_desc(&h);
  desc.get_proc_address = counted_address;
  desc.state = mode;
  *b = (bench){.spec = spec, .mode = mode, .count = count};
  assert_int_equal(pn_context_create(&desc, &h.context), PN_OK);
  assert_int_equal(host_cast(&h, CAST_MEMORY), PN_OK);
  assert_int_equal(pn_receiver_create(h.context, &b->receiver), PN_OK);
  for (int i = 0; i < count; i++) {
    pn_light_desc light = host_light_desc();
    light.map_width = 64;
    light.center[0] += 0.1f * (float)i;
    assert_int_equal(host_light(&h, &light, spec, &b->lights[i]), PN_OK);
  }
}

static void bench_close(void) {
  pn_context_destroy(&h.context);
  h.casters = NULL;
}

static void frame(bench *b) {
  pn_receiver_desc desc = host_receiver_desc(&view, &target);
  assert_int_equal(pn_state_begin(h.context), PN_OK);
  assert_int_equal(pn_receiver_set(b->receiver, &desc), PN_OK);
  for (int i = 0; i < b->count; i++) {
    assert_int_equal(pn_maps_update(b->lights[i], h.casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
    assert_int_equal(pn_visibility(b->lights[i], b->receiver), PN_OK);
  }
  assert_int_equal(pn_state_end(h.context), PN_OK);
}

typedef struct {
  long all, reads, draws, made, uploads;
} calls;

static calls count_frame(bench *b) {
  counted_reset();
  frame(b);
  return (calls){.all = counted_calls("gl"),
                 .reads = counted_calls("glGetInteger") + counted_calls("glGetBoolean") + counted_calls("glGetFloat") +
                          counted_calls("glGetDouble") + counted_calls("glIsEnabled"),
                 .draws = counted_calls("glDraw") - counted_calls("glDrawBuffers"),
                 .made = counted_calls("glGen") + counted_calls("glDelete") + counted_calls("glCreate") +
                         counted_calls("glTexImage") + counted_calls("glCompile") +
                         counted_calls("glGetUniformLocation"),
                 .uploads = counted_calls("glBufferData") + counted_calls("glBufferSubData")};
}

/* The third frame: what is made once is made. */
static calls steady_frame(bench *b) {
  for (int i = 0; i < 2; i++) frame(b);
  calls third = count_frame(b), fourth = count_frame(b);
  assert_memory_equal(&third, &fourth, sizeof third);
  return third;
}

static calls measure(const char *spec, int mode, int lights) {
  bench b;
  bench_open(&b, spec, modes[mode], lights);
  calls c = steady_frame(&b);
  printf("%-10s %2d lights, %-7s: %5ld calls, %4ld of them read state, %3ld draw\n", spec, lights, mode_names[mode],
         c.all, c.reads, c.draws);
  bench_close();
  return c;
}

/* ---- what it owes ------------------------------------------------------------------------------------------------ */

/* Meshes of the scene that cast. */
static long caster_count(void) {
  long count = 0;
  for (int i = 0; i < h.world.count; i++) count += h.world.meshes[i].casts;
  return count;
}

static void test_hard(void **state) {
  (void)state;
  if (!counted_available()) skip();
  for (int m = 0; m < MODES; m++) {
    calls one = measure("hard", m, 1), many = measure("hard", m, LIGHTS_MOST);
    /* Each caster and the screen once a light, the view's planes once. */
    assert_int_equal(one.draws, caster_count() + 1 + 1);
    assert_int_equal(many.draws, LIGHTS_MOST * (caster_count() + 1) + 1);
    /* A light more costs no more than the first one did, which came with the view. */
    assert_true(many.all < LIGHTS_MOST * one.all);
    assert_int_equal(one.made + many.made, 0);
    assert_int_equal(one.uploads + many.uploads, 0);
  }
}

static void test_others(void **state) {
  static const char *const specs[] = {"pcss", "bitmask", "ssm", "smoothies", "average:samples=20"};
  (void)state;
  if (!counted_available()) skip();
  for (int i = 0; i < 5; i++)
    for (int m = 0; m < MODES; m++) {
      calls c = measure(specs[i], m, 1);
      assert_int_equal(c.made, 0);
      /* Only average has a block for each of its batches. */
      assert_int_equal(c.uploads, strncmp(specs[i], "average", 7) == 0 ? 2 : 0);
    }
}

/* State is read once a call, once a bracket, or never. */
static void test_modes(void **state) {
  (void)state;
  if (!counted_available()) skip();
  for (int lights = 1; lights <= LIGHTS_MOST; lights += LIGHTS_MOST - 1) {
    calls restore = measure("hard", 0, lights), scoped = measure("hard", 1, lights), reset = measure("hard", 2, lights);
    /* What is read in every mode is not state: how many samples the view's depth has. */
    enum { SAMPLES = 1 };
    const long made = 1 + 2 * lights; /* calls */
    /* Without a host's state to save, each call looks whether the stack of debug groups is full. */
    assert_int_equal(reset.reads, SAMPLES + made);
    /* A bracket reads what one call of the other mode reads. */
    assert_true(scoped.reads > SAMPLES + made);
    assert_int_equal(restore.reads - SAMPLES, made * (scoped.reads - SAMPLES - made));
    /* Knowing the host's state, a call sets less than one that has to set all of it. */
    assert_true(restore.all - restore.reads < scoped.all - scoped.reads);
    assert_true(restore.all - restore.reads < reset.all - reset.reads);
  }
}

/* A caster that moves costs one upload of what each light is, and nothing is made for it. */
static void test_moving(void **state) {
  (void)state;
  if (!counted_available()) skip();
  bench b;
  bench_open(&b, "pcss", PN_STATE_SCOPED, 4);
  steady_frame(&b);
  for (int step = 1; step < 4; step++) {
    float place[16];
    memcpy(place, h.world.meshes[SCENE_SLAB].place, sizeof place);
    place[13] += 0.4f * (float)step;
    assert_int_equal(pn_instance_move(h.casters, h.instances[SCENE_SLAB], place), PN_OK);
    calls c = count_frame(&b);
    assert_in_range(c.uploads, 0, 4);
    assert_int_equal(c.made, 0);
  }
  bench_close();
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  view = camera_sized(0, WIDTH, HEIGHT);
  if (!target_open(&target, &view)) return -1;
  renderer_depth(&h.draw, &h.world, &view, &target);
  return gl_errors();
}

static int teardown(void **state) {
  (void)state;
  target_close(&target);
  host_close(&h);
  return 0;
}

static int clean(void **state) {
  (void)state;
  bench_close();
  return gl_errors();
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_hard, clean),
      cmocka_unit_test_teardown(test_others, clean),
      cmocka_unit_test_teardown(test_modes, clean),
      cmocka_unit_test_teardown(test_moving, clean),
  };
  return cmocka_run_group_tests_name("calls", tests, setup, teardown);
}
