/* A call that fails leaves everything as it was, to the bit: whatever of memory, GL objects and programs is refused in
 * the middle of it, maps, results and the host's own texture are those of the last call that succeeded. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "faults.h"
#include "host.h"

enum { WIDTH = 40, HEIGHT = 30, PIXELS = WIDTH * HEIGHT, MAP = 24 };

static host h;
static camera view, copied_view;
static depth_target target, copied_target;
static pn_receiver *receiver;
static pn_light *light;
static pn_casters *fewer; /* the same scene without its flag, and the box elsewhere */
static GLuint into;

/* ---- what there is ----------------------------------------------------------------------------------------------- */

static uint64_t digest_bytes(uint64_t hash, const void *data, size_t bytes) {
  const unsigned char *c = data;
  for (size_t i = 0; i < bytes; i++) hash = (hash ^ c[i]) * 0x100000001b3u;
  return hash;
}

static uint64_t digest_image(uint64_t hash, const pn_image *image) {
  size_t layers = image->layers ? (size_t)image->layers : 1;
  size_t count = (size_t)image->width * (size_t)image->height * layers * 4;
  float *texels = calloc(count, sizeof *texels);
  assert_non_null(texels);
  int depth = image->format == GL_DEPTH_COMPONENT32F;
  gl.BindTexture(image->target, image->texture);
  gl.GetTexImage(image->target, 0, depth ? GL_DEPTH_COMPONENT : GL_RGBA, GL_FLOAT, texels);
  gl.BindTexture(image->target, 0);
  hash = digest_bytes(hash, image, sizeof *image);
  hash = digest_bytes(hash, texels, count * sizeof *texels);
  free(texels);
  return hash;
}

/* Maps, intermediate images, the result, the soft shadow map, the host's texture. */
static uint64_t digest(void) {
  uint64_t hash = 0xcbf29ce484222325u;
  pn_image image;
  pn_maps_info maps;
  pn_soft_shadow_map soft;
  memset(&image, 0, sizeof image);
  memset(&maps, 0, sizeof maps);
  memset(&soft, 0, sizeof soft);
  if (pn_light_maps(light, &maps) == PN_OK) hash = digest_bytes(hash, &maps, sizeof maps);
  for (int i = 0; pn_debug_image(light, receiver, i, NULL, &image); i++) hash = digest_image(hash, &image);
  assert_int_equal(pn_result_image(light, receiver, &image), PN_OK);
  hash = digest_image(hash, &image);
  if (pn_soft_shadow_map_image(light, receiver, &soft) == PN_OK) hash = digest_bytes(hash, &soft, sizeof soft);
  float host_image[PIXELS];
  gl.BindTexture(GL_TEXTURE_2D, into);
  gl.GetTexImage(GL_TEXTURE_2D, 0, GL_RED, GL_FLOAT, host_image);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  return digest_bytes(hash, host_image, sizeof host_image);
}

/* ---- the calls --------------------------------------------------------------------------------------------------- */

static pn_result set_view(int width, int copied) {
  pn_receiver_desc d = host_receiver_desc(copied ? &copied_view : &view, copied ? &copied_target : &target);
  d.width = width;
  return pn_receiver_set(receiver, &d);
}

static pn_result update(pn_casters *casters) { return pn_maps_update(light, casters, PN_GROUPS_ALL, &receiver, 1); }

static pn_result update_other(void) { return update(fewer); }
static pn_result see(void) { return pn_visibility(light, receiver); }
static pn_result see_into(void) { return pn_visibility_into(light, receiver, &(pn_target){.texture = into}); }
static pn_result copy_view(void) { return set_view(WIDTH / 2, 1); }

/* What makes the call need something new, and takes it back: an order that succeeds. */
static void other_debug(void) { assert_int_equal(pn_debug(h.context, PN_DEBUG_SEARCH | PN_DEBUG_BOUND), PN_OK); }
static void same_debug(void) { assert_int_equal(pn_debug(h.context, 0), PN_OK); }
static void smaller_view(void) { assert_int_equal(set_view(WIDTH / 2 + 3, 0), PN_OK); }
static void same_view(void) { assert_int_equal(set_view(WIDTH, 0), PN_OK); }
static void nothing(void) {}

static const struct {
  const char *name;
  pn_result (*call)(void);
  void (*before)(void), (*after)(void);
} calls[] = {
    {"pn_maps_update", update_other, nothing, nothing},
    {"pn_visibility", see, smaller_view, same_view},
    {"pn_visibility, debugging", see, other_debug, same_debug},
    {"pn_visibility_into", see_into, smaller_view, same_view},
    {"pn_receiver_set", copy_view, nothing, nothing},
};
enum { CALLS = sizeof calls / sizeof *calls };

/* ---- failing ----------------------------------------------------------------------------------------------------- */

static void begin(const char *spec) {
  pn_light_desc d = host_light_desc();
  d.map_width = MAP;
  d.fit = PN_FIT_VISIBLE;
  assert_int_equal(host_light(&h, &d, spec, &light), PN_OK);
  assert_int_equal(pn_receiver_create(h.context, &receiver), PN_OK);
  same_view();
  assert_int_equal(update(h.casters), PN_OK);
  assert_int_equal(see(), PN_OK);
}

static void end(void) {
  pn_light_destroy(&light);
  pn_receiver_destroy(&receiver);
}

/* The k-th fault of a kind in a call: 0 where there are not so many. */
static int try_fault(const char *spec, int i, fault_kind kind, long k, int fresh) {
  begin(spec);
  float *picture = host_result(light, receiver);
  calls[i].before();
  uint64_t before = digest();
  if (fresh) assert_int_equal(pn_reload_shaders(h.context), PN_OK);
  faults_arm(kind, k);
  pn_result result = calls[i].call();
  int enough, hit = faults_disarm(&enough);
  if (hit && result == PN_OK) fail_msg("%s, %s: fault %d, number %ld went unnoticed", spec, calls[i].name, kind, k);
  if (hit && digest() != before) fail_msg("%s, %s: fault %d, number %ld left its traces", spec, calls[i].name, kind, k);
  if (!hit) assert_int_equal(result, PN_OK);
  if (hit) {
    calls[i].after();
    assert_int_equal(see(), PN_OK);
    float *again = host_result(light, receiver);
    if (memcmp(again, picture, PIXELS * sizeof *again) != 0)
      fail_msg("%s, %s: fault %d, number %ld: another picture", spec, calls[i].name, kind, k);
    free(again);
  } else {
    calls[i].after();
  }
  free(picture);
  end();
  return enough;
}

static void test_faults(void **state) {
  (void)state;
  long faults[FAULT_KINDS] = {0};
  for (int s = 0; host_spec(s); s++)
    for (int i = 0; i < CALLS; i++)
      for (int kind = 0; kind < FAULT_KINDS; kind++)
        for (int fresh = kind != FAULT_MEMORY; fresh < 2; fresh++) {
          /* Programs take memory many times over, each alike; and there are many. */
          long step = fresh && kind == FAULT_MEMORY ? 37 : kind == FAULT_COMPILE || kind == FAULT_LINK ? 3 : 1;
          for (long k = 1; try_fault(host_spec(s), i, (fault_kind)kind, k, fresh); k += step) faults[kind]++;
        }
  for (int kind = 0; kind < FAULT_KINDS; kind++) {
    printf("fault of kind %d: %ld times\n", kind, faults[kind]);
    assert_true(faults[kind] > 20);
  }
}

/* The box in another pose, one triangle of it without area, so that there are fewer indices too; stride 16: what is
 * packed takes memory. */
static pn_result move_box(int moved) {
  const mesh *box = &h.world.meshes[SCENE_BOX];
  size_t count = (size_t)box->vertex_count;
  float *positions = malloc(count * 16);
  assert_non_null(positions);
  for (size_t i = 0; i < count; i++)
    for (int c = 0; c < 3; c++) positions[4 * i + c] = box->posed[3 * i + c] * (moved ? 0.5f : 1.0f);
  if (moved) memcpy(positions + 4 * box->indices[1], positions + 4 * box->indices[0], 12);
  pn_result result =
      pn_mesh_moved(h.casters, h.meshes[SCENE_BOX], &(pn_span){.data = positions, .stride = 16, .count = count}, NULL);
  free(positions);
  return result;
}

static void test_moved(void **state) {
  (void)state;
  begin("smoothies");
  float *picture = host_result(light, receiver);
  for (int kind = 0; kind <= FAULT_GL_MEMORY; kind++) {
    int enough = 1, faults = 0;
    for (long k = 1; enough; k++) {
      faults_arm((fault_kind)kind, k);
      pn_result result = move_box(1);
      int hit = faults_disarm(&enough);
      assert_int_equal(result, hit ? PN_ERROR_OUT_OF_MEMORY : PN_OK);
      if (!hit) continue;
      faults++;
      assert_int_equal(update(h.casters), PN_OK);
      assert_int_equal(see(), PN_OK);
      float *again = host_result(light, receiver);
      assert_memory_equal(again, picture, PIXELS * sizeof *again);
      free(again);
    }
    assert_true(faults > 0);
    assert_int_equal(update(h.casters), PN_OK);
    assert_int_equal(see(), PN_OK);
    float *moved = host_result(light, receiver);
    assert_true(memcmp(moved, picture, PIXELS * sizeof *moved) != 0);
    free(moved);
    assert_int_equal(move_box(0), PN_OK);
  }
  free(picture);
  end();
}

/* ---- the fixture ------------------------------------------------------------------------------------------------- */

static int open_targets(void) {
  view = camera_sized(0, WIDTH, HEIGHT);
  for (int i = 0; i < CAMERA_COUNT; i++) {
    camera c = camera_sized(i, WIDTH, HEIGHT);
    if (c.renderbuffer && !c.samples && !c.reversed && !c.zero_to_one) copied_view = c;
  }
  if (!copied_view.renderbuffer || !target_open(&target, &view) || !target_open(&copied_target, &copied_view)) return 0;
  renderer_depth(&h.draw, &h.world, &view, &target);
  renderer_depth(&h.draw, &h.world, &copied_view, &copied_target);
  return 1;
}

static int add_fewer(void) {
  pn_mesh added;
  pn_mesh_desc box = host_mesh_desc(&h, SCENE_BOX, CAST_MEMORY);
  float place[16];
  memcpy(place, h.world.meshes[SCENE_BOX].place, sizeof place);
  place[12] += 0.4f;
  return pn_casters_create(h.context, &fewer) == PN_OK && pn_mesh_add(fewer, &box, &added) == PN_OK &&
         pn_instance_add(fewer, added, place, 0, NULL) == PN_OK;
}

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  pn_context_desc desc = host_context_desc(&h);
  desc.allocate = faults_allocate;
  desc.get_proc_address = faults_address;
  if (pn_context_create(&desc, &h.context) != PN_OK || host_cast(&h, CAST_MEMORY) != PN_OK) return -1;
  if (!open_targets() || !add_fewer()) return -1;
  gl.GenTextures(1, &into);
  gl.BindTexture(GL_TEXTURE_2D, into);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R32F, WIDTH, HEIGHT, 0, GL_RED, GL_FLOAT, NULL);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  return gl_errors();
}

static int teardown(void **state) {
  (void)state;
  pn_context_destroy(&h.context);
  target_close(&target);
  target_close(&copied_target);
  gl.DeleteTextures(1, &into);
  host_close(&h);
  return 0;
}

int main(void) {
#define TEST(f) cmocka_unit_test_teardown(f, host_check)
  const struct CMUnitTest tests[] = {TEST(test_moved), TEST(test_faults)};
  return cmocka_run_group_tests_name("unchanged", tests, setup, teardown);
}
