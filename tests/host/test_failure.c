/* Memory that runs out at every possible moment, a limit on GL's memory, and a context that is given up: an error,
 * never a crash, no leak, and when memory is back the frame is the same to the bit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "agreement.h"
#include "counted.h"
#include "host.h"

enum { WIDTH = 48, HEIGHT = 36, PIXELS = WIDTH * HEIGHT };

static host h;
static camera view;
static depth_target target;
static pn_light *light;
static pn_receiver *receiver;
static pn_context_desc desc;

/* ---- an allocator that counts and fails
 * ----------------------------------------------------------------------------------- */

static long allocations, failing, live; /* failing: the number of the call that fails, 0: none */
static int failed;

static void *allocate(void *user, void *old, size_t bytes) {
  (void)user;
  if (bytes == 0) {
    live -= old != NULL;
    free(old);
    return NULL;
  }
  if (++allocations == failing) {
    failed = 1;
    return NULL;
  }
  void *out = realloc(old, bytes);
  live += out && !old;
  return out;
}

/* ---- a frame in steps
 * ----------------------------------------------------------------------------------------------------- */

static pn_result create(void) { return pn_context_create(&desc, &h.context); }

static pn_result prepare(void) { return pn_prepare(h.context, "pcss", NULL); }

static pn_result make_casters(void) { return pn_casters_create(h.context, &h.casters); }

static pn_result add_mesh(int i, cast_kind kind) {
  pn_mesh_desc mesh_desc = host_mesh_desc(&h, i, kind);
  return pn_mesh_add(h.casters, &mesh_desc, &h.meshes[i]);
}

static pn_result add_box(void) { return add_mesh(SCENE_BOX, CAST_MEMORY); }

static pn_result add_flag(void) { return add_mesh(SCENE_FLAG, CAST_BUFFERS); }

static pn_result place_box(void) {
  return pn_instance_add(h.casters, h.meshes[SCENE_BOX], h.world.meshes[SCENE_BOX].place, 0, &h.instances[SCENE_BOX]);
}

static pn_result place_flag(void) {
  return pn_instance_add(h.casters, h.meshes[SCENE_FLAG], h.world.meshes[SCENE_FLAG].place, 0,
                         &h.instances[SCENE_FLAG]);
}

static pn_result move_box(void) {
  const mesh *box = &h.world.meshes[SCENE_BOX];
  pn_span positions = {.data = box->posed, .count = (size_t)box->vertex_count};
  return pn_mesh_moved(h.casters, h.meshes[SCENE_BOX], &positions, NULL);
}

static pn_result make_receiver(void) { return pn_receiver_create(h.context, &receiver); }

static pn_result set_receiver(void) {
  pn_receiver_desc d = host_receiver_desc(&view, &target);
  return pn_receiver_set(receiver, &d);
}

static pn_result make_light(void) { return pn_light_create(h.context, &light); }

static pn_result set_light(void) {
  pn_light_desc d = host_light_desc();
  d.map_width = 32;
  d.fit = PN_FIT_VISIBLE;
  return pn_light_set(light, &d);
}

static pn_result choose(void) { return pn_light_technique(light, "pcss:samples=4", NULL, 0); }

static pn_result choose_edges(void) { return pn_light_technique(light, "smoothies", NULL, 0); }

static pn_result update(void) { return pn_maps_update(light, h.casters, PN_GROUPS_ALL, &receiver, 1); }

static pn_result see(void) { return pn_visibility(light, receiver); }

static pn_result text(void) { return pn_glsl(h.context, "pcss", 330, 0) ? PN_OK : PN_ERROR_OUT_OF_MEMORY; }

static const struct {
  const char *name;
  pn_result (*call)(void);
} steps[] = {
    {"pn_context_create", create},
    {"pn_prepare", prepare},
    {"pn_casters_create", make_casters},
    {"pn_mesh_add", add_box},
    {"pn_mesh_add, buffers", add_flag},
    {"pn_instance_add", place_box},
    {"pn_instance_add", place_flag},
    {"pn_mesh_moved", move_box},
    {"pn_receiver_create", make_receiver},
    {"pn_receiver_set", set_receiver},
    {"pn_light_create", make_light},
    {"pn_light_set", set_light},
    {"pn_light_technique", choose},
    {"pn_maps_update", update},
    {"pn_visibility", see},
    {"pn_glsl", text},
    {"pn_maps_update", update},
    {"pn_visibility", see},
    {"pn_light_technique", choose_edges},
    {"pn_maps_update", update},
    {"pn_visibility", see},
};
enum { STEPS = sizeof steps / sizeof *steps };

static void reset(void) {
  allocations = failing = live = 0;
  failed = 0;
  desc = host_context_desc(&h);
  desc.allocate = allocate;
}

/* Every step; one whose memory fails must say so, and the next attempt must succeed. */
static void run(void) {
  for (int i = 0; i < STEPS; i++) {
    failed = 0;
    pn_result result = steps[i].call();
    if (failed) {
      if (result != PN_ERROR_OUT_OF_MEMORY) {
        fail_msg("allocation %ld in %s: %s", failing, steps[i].name, pn_result_name(result));
      }
      /* The log goes through the context; its creation may fail before there is one. */
      if (i > 0) assert_true(h.log.counts[PN_MESSAGE_OUT_OF_MEMORY] > 0);
      failing = 0;
      result = steps[i].call();
    }
    if (result != PN_OK) fail_msg("%s: %s: %s", steps[i].name, pn_result_name(result), h.log.last);
  }
}

static void end(void) {
  pn_context_destroy(&h.context);
  h.casters = NULL, light = NULL, receiver = NULL;
  assert_int_equal(live, 0);
}

static void test_every_allocation(void **state) {
  (void)state;
  reset();
  run();
  float *expected = host_result(light, receiver);
  assert_non_null(expected);
  assert_true(dark_pixels(expected, WIDTH, HEIGHT) > 10);
  long count = allocations;
  end();
  /* All of the first and the last ones; of very many in between every n-th, n odd, so that about eighty are tried. */
  long stride = count > 120 ? (count / 80) | 1 : 1;
  printf("%ld allocations in a frame, every %ld. fails once\n", count, stride);
  assert_true(count >= 5);
  for (long k = 1; k <= count; k += k < 20 || k > count - 20 ? 1 : stride) {
    reset();
    memset(&h.log, 0, sizeof h.log);
    failing = k;
    run();
    assert_int_equal(failing, 0);
    float *image = host_result(light, receiver);
    assert_non_null(image);
    assert_memory_equal(image, expected, PIXELS * sizeof *image);
    free(image);
    end();
    assert_int_equal(gl_errors(), 0);
  }
  free(expected);
}

/* Allocation never works: nothing is created, nothing is lost. */
static void *allocate_nothing(void *user, void *old, size_t bytes) {
  (void)user, (void)old, (void)bytes;
  return NULL;
}

static void test_no_memory(void **state) {
  (void)state;
  pn_context *made = NULL;
  reset();
  desc.allocate = allocate_nothing;
  assert_int_equal(pn_context_create(&desc, &made), PN_ERROR_OUT_OF_MEMORY);
  assert_null(made);
}

/* Objects are destroyed in every order a host may choose. */
static void test_orders(void **state) {
  (void)state;
  for (int order = 0; order < 6; order++) {
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    reset();
    run();
    for (int k = 0; k < 3; k++) {
      if (orders[order][k] == 0) pn_light_destroy(&light);
      if (orders[order][k] == 1) pn_receiver_destroy(&receiver);
      if (orders[order][k] == 2) pn_casters_destroy(&h.casters);
    }
    end();
  }
}

/* A 4096 x 4096 map of 32 bits is 64 MiB and does not fit into 8; a small one does, and info tells how much is held. */
static void test_gpu_limit(void **state) {
  (void)state;
  const size_t limit = 8u << 20;
  pn_info info;
  reset();
  desc.gpu_memory_limit = limit;
  run();
  assert_int_equal(pn_context_info(h.context, &info), PN_OK);
  assert_true(info.gpu_memory > PIXELS * 4 && info.gpu_memory <= limit);
  float *before = host_result(light, receiver);
  pn_light_desc large = host_light_desc();
  large.map_width = 4096;
  memset(&h.log, 0, sizeof h.log);
  pn_result result = pn_light_set(light, &large);
  if (result == PN_OK) result = update();
  if (result == PN_OK) result = see();
  assert_int_equal(result, PN_ERROR_OUT_OF_MEMORY);
  assert_true(h.log.counts[PN_MESSAGE_GPU_MEMORY] > 0);
  assert_int_equal(pn_context_info(h.context, &info), PN_OK);
  assert_true(info.gpu_memory <= limit);
  assert_int_equal(set_light(), PN_OK);
  assert_int_equal(update(), PN_OK);
  assert_int_equal(see(), PN_OK);
  float *after = host_result(light, receiver);
  assert_memory_equal(before, after, PIXELS * sizeof *before);
  free(before), free(after);
  end();
}

/* What is created is counted, and given back when its owner is destroyed. */
static void test_gpu_accounting(void **state) {
  (void)state;
  pn_info first, full, last;
  reset();
  assert_int_equal(create(), PN_OK);
  assert_int_equal(prepare(), PN_OK);
  assert_int_equal(pn_context_info(h.context, &first), PN_OK);
  for (int i = 2; i < STEPS; i++) assert_int_equal(steps[i].call(), PN_OK);
  assert_int_equal(pn_context_info(h.context, &full), PN_OK);
  pn_light_destroy(&light);
  pn_receiver_destroy(&receiver);
  pn_casters_destroy(&h.casters);
  assert_int_equal(pn_context_info(h.context, &last), PN_OK);
  printf("%zu bytes at first, %zu in the frame, %zu afterwards\n", first.gpu_memory, full.gpu_memory, last.gpu_memory);
  /* At least the box, the map (32 x 32, 4 bytes) and the result (4 bytes). */
  assert_true(full.gpu_memory >= first.gpu_memory + 24 * 12 + 36 * 2 + 32 * 32 * 4 + PIXELS * 4);
  assert_true(last.gpu_memory <= first.gpu_memory + 65536);
  end();
}

/* A lost context: its memory is freed without a single GL call. */
static void test_abandon(void **state) {
  (void)state;
  if (!counted_available()) skip();
  reset();
  desc.get_proc_address = counted_address;
  counted_reset();
  run();
  assert_true(counted_calls("gl") > 100);
  counted_reset();
  pn_context_abandon(&h.context);
  assert_null(h.context);
  assert_int_equal(counted_calls(""), 0);
  assert_int_equal(live, 0);
  h.casters = NULL, light = NULL, receiver = NULL;
}

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  view = camera_at(0);
  view.width = view.target_width = WIDTH;
  view.height = view.target_height = HEIGHT;
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

int main(void) {
#define TEST(f) cmocka_unit_test_teardown(f, host_check)
  const struct CMUnitTest tests[] = {
      TEST(test_every_allocation), TEST(test_no_memory),      TEST(test_orders),
      TEST(test_gpu_limit),        TEST(test_gpu_accounting), TEST(test_abandon),
  };
  return cmocka_run_group_tests_name("failure", tests, setup, teardown);
}
