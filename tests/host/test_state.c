/* GL state: with everything set oddly the library's results are the same to the bit, and the host finds everything as
 * it left it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "counted.h"
#include "host.h"
#include "state.h"

enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT, LIGHTS = 6, VIEWS = 3, IMAGES = LIGHTS * VIEWS };

/* One light for each way the library may look back, and techniques that draw once and often. */
static const char *const techniques[LIGHTS] = {"pcss",      "pcf:filter=bicubic", "average:samples=4",
                                               "smoothies", "ssm:layers=2",       "backprojection:layers=3,focus=60"};
static const pn_fit fits[LIGHTS] = {PN_FIT_CASTERS, PN_FIT_VISIBLE, PN_FIT_FRUSTUM,
                                    PN_FIT_VISIBLE, PN_FIT_CASTERS, PN_FIT_CASTERS};
/* A texture, a multisampled texture, a multisampled renderbuffer. */
static const int cameras[VIEWS] = {1, 12, 15};

static host h;
static odd_objects odd;
static camera views[VIEWS];
static depth_target targets[VIEWS];
static pn_receiver *receivers[VIEWS];
static pn_light *lights[LIGHTS];
static GLuint into, four, companions[2];
static pn_state_mode mode;
static int counted;

/* ---- the host's frame, call by call ---------------------------------------------------------------------------------
 * */

static pn_result make_context(int i) {
  (void)i;
  pn_context_desc desc = host_context_desc(&h);
  desc.state = mode;
  if (counted) desc.get_proc_address = counted_address;
  return pn_context_create(&desc, &h.context);
}

static pn_result begin(int i) {
  (void)i;
  return pn_state_begin(h.context);
}

static pn_result end(int i) {
  (void)i;
  return pn_state_end(h.context);
}

static pn_result prepare(int i) { return pn_prepare(h.context, techniques[i], NULL); }

/* Views of every kind, before they exist. */
static pn_result prepare_like(int i) {
  pn_receiver_desc like = {.scale = 1 + i % 2, .width = WIDTH, .height = HEIGHT};
  like.normal_texture = i & 2 ? 1 : 0;
  like.mask_texture = i == 3 ? 1 : 0;
  return pn_prepare(h.context, "pcss", &like);
}

static pn_result make_casters(int i) {
  (void)i;
  return pn_casters_create(h.context, &h.casters);
}

static pn_result add_mesh(int i) {
  if (!h.world.meshes[i].casts) return PN_OK;
  pn_mesh_desc desc = host_mesh_desc(&h, i, i % 2 ? CAST_MEMORY : CAST_BUFFERS);
  pn_result result = pn_mesh_add(h.casters, &desc, &h.meshes[i]);
  if (result != PN_OK) return result;
  return pn_instance_add(h.casters, h.meshes[i], h.world.meshes[i].place, 0, &h.instances[i]);
}

static pn_result move_mesh(int i) {
  (void)i;
  const mesh *box = &h.world.meshes[SCENE_BOX];
  pn_span positions = {.data = box->posed, .count = (size_t)box->vertex_count};
  pn_result result = pn_mesh_moved(h.casters, h.meshes[SCENE_BOX], &positions, NULL);
  return result == PN_OK ? pn_mesh_moved(h.casters, h.meshes[SCENE_SLAB], NULL, NULL) : result;
}

static pn_result make_receiver(int i) {
  pn_receiver_desc desc = host_receiver_desc(&views[i], &targets[i]);
  pn_result result = pn_receiver_create(h.context, &receivers[i]);
  desc.scale = i + 1 == VIEWS ? 2 : 1;
  return result == PN_OK ? pn_receiver_set(receivers[i], &desc) : result;
}

static pn_result make_light(int i) {
  pn_light_desc desc = host_light_desc();
  desc.fit = fits[i];
  desc.map_width = 64;
  return host_light(&h, &desc, techniques[i], &lights[i]);
}

static pn_result update(int i) { return pn_maps_update(lights[i], h.casters, PN_GROUPS_ALL, receivers, VIEWS); }

static pn_result see(int i) { return pn_visibility(lights[i % LIGHTS], receivers[i / LIGHTS]); }

/* The host has the results bound when their receiver gets another size, and while lights and receivers are destroyed.
 * */
static pn_result resize(int i) {
  pn_receiver_desc desc = host_receiver_desc(&views[0], &targets[0]);
  pn_image image;
  pn_result result = pn_result_image(lights[i], receivers[0], &image);
  gl.ActiveTexture(GL_TEXTURE0 + (GLenum)i);
  gl.BindTexture(image.target, image.texture);
  desc.width = WIDTH / 2;
  if (result == PN_OK) result = pn_receiver_set(receivers[0], &desc);
  return result == PN_OK ? pn_visibility(lights[i], receivers[0]) : result;
}

static pn_result see_into(int i) {
  (void)i;
  return pn_visibility_into(lights[0], receivers[0], &(pn_target){into, 1, 0});
}

/* Channel by channel, from both scales. */
static pn_result see_channel(int i) {
  return pn_visibility_into(lights[i], receivers[i % 2 ? VIEWS - 1 : 0], &(pn_target){four, 0, 1 << i % 4});
}

static pn_result see_nowhere(int i) {
  pn_result result = pn_visibility_into(lights[i], receivers[0], &(pn_target){targets[0].depth, 0, 0});
  return result == PN_ERROR_ARGUMENT ? PN_OK : PN_ERROR_UNSUPPORTED;
}

/* A light whose casters are all left out: results are filled without a map. */
static pn_result see_nothing(int i) {
  pn_result result = pn_maps_update(lights[i], h.casters, 0, NULL, 0);
  if (result == PN_OK) result = pn_visibility(lights[i], receivers[0]);
  if (result == PN_OK) result = pn_visibility_into(lights[i], receivers[0], &(pn_target){into, 0, 0});
  return result;
}

static pn_result look(int i) {
  const char *name;
  pn_image image;
  pn_maps_info maps;
  pn_info info;
  for (int k = 0; pn_debug_image(lights[i], receivers[0], k, &name, &image); k++) continue;
  pn_result result = pn_result_image(lights[i], receivers[0], &image);
  if (result == PN_OK) result = pn_light_maps(lights[i], &maps);
  return result == PN_OK ? pn_context_info(h.context, &info) : result;
}

static pn_result soft_map(int i) {
  (void)i;
  pn_soft_shadow_map map;
  return pn_soft_shadow_map_image(lights[4], receivers[0], &map);
}

/* Normals and a mask beside the depth, and one that is refused. */
static pn_result set_companions(int i) {
  pn_receiver_desc desc = host_receiver_desc(&views[0], &targets[0]);
  desc.normal_texture = companions[0], desc.mask_texture = companions[1];
  desc.normal_encoding = PN_NORMAL_UNSIGNED;
  pn_result result = pn_receiver_set(receivers[0], &desc);
  if (result == PN_OK) result = pn_visibility(lights[i], receivers[0]);
  desc.normal_texture = targets[0].depth;
  if (pn_receiver_set(receivers[0], &desc) == PN_OK) return PN_ERROR_UNSUPPORTED;
  desc.normal_texture = desc.mask_texture = 0;
  if (result == PN_OK) result = pn_receiver_set(receivers[0], &desc);
  return result == PN_OK ? see(i) : result;
}

/* There and back: another technique, other parameters, debug images. */
static pn_result change(int i) {
  pn_result result = pn_debug(h.context, PN_DEBUG_SEARCH | PN_DEBUG_BOUND);
  if (result == PN_OK) result = pn_light_technique(lights[i], techniques[(i + 1) % LIGHTS], NULL, 0);
  if (result == PN_OK) result = update(i);
  if (result == PN_OK) result = see(i);
  if (result == PN_OK) result = pn_debug(h.context, 0);
  if (result == PN_OK) result = pn_light_technique(lights[i], techniques[i], NULL, 0);
  if (result == PN_OK) result = update(i);
  for (int k = 0; k < VIEWS && result == PN_OK; k++) result = pn_visibility(lights[i], receivers[k]);
  return result;
}

static pn_result move_instance(int i) {
  pn_instance another;
  const float *place = h.world.meshes[SCENE_BOX].place;
  pn_result result = pn_instance_add(h.casters, h.meshes[SCENE_BOX], place, i, &another);
  if (result == PN_OK) result = pn_instance_move(h.casters, another, place);
  return result == PN_OK ? pn_instance_remove(h.casters, another) : result;
}

static pn_result reload(int i) {
  pn_result result = pn_reload_shaders(h.context);
  return result == PN_OK ? see(i) : result;
}

static pn_result ask(int i) {
  const char *name, *help;
  int in_use;
  return pn_feature(h.context, i, &name, &in_use, &help) ? PN_OK : PN_ERROR_ARGUMENT;
}

static pn_result times(int i) {
  pn_time out[16];
  pn_result result = pn_timing(h.context, 1);
  if (result == PN_OK) result = update(i);
  if (result == PN_OK) result = see(i);
  pn_times(lights[i], out, 16, 1);
  return result == PN_OK ? pn_timing(h.context, 0) : result;
}

static pn_result text(int i) {
  (void)i;
  return pn_glsl(h.context, "caster", 330, 0) && pn_glsl(h.context, "pcss", 330, 0) ? PN_OK : PN_ERROR_SHADER;
}

static pn_result destroy_some(int i) {
  (void)i;
  pn_light_destroy(&lights[2]);
  pn_receiver_destroy(&receivers[2]);
  return pn_mesh_remove(h.casters, h.meshes[SCENE_TORUS]);
}

static pn_result destroy(int i) {
  (void)i;
  pn_context_destroy(&h.context);
  return PN_OK;
}

typedef struct {
  const char *name;
  pn_result (*call)(int i);
  int count;
} step;

static const step creation[] = {{"pn_context_create", make_context, 1}, {"pn_state_begin", begin, 1}};
static const step frame[] = {
    {"pn_prepare", prepare, LIGHTS},
    {"pn_prepare with a view", prepare_like, 4},
    {"pn_casters_create", make_casters, 1},
    {"pn_mesh_add", add_mesh, SCENE_MESHES},
    {"pn_mesh_moved", move_mesh, 1},
    {"pn_receiver_set", make_receiver, VIEWS},
    {"pn_light_set", make_light, LIGHTS},
    {"nothing casts", see_nothing, 1},
    {"pn_maps_update", update, LIGHTS},
    {"pn_visibility", see, IMAGES},
    {"pn_visibility_into", see_into, 1},
    {"pn_visibility_into, channels", see_channel, LIGHTS},
    {"pn_visibility_into, refused", see_nowhere, LIGHTS},
    {"pn_soft_shadow_map_image", soft_map, 1},
    {"normals and mask", set_companions, 2},
    {"pn_light_technique", change, 3},
    {"pn_instance_move", move_instance, 2},
    {"pn_feature", ask, 2},
    {"pn_debug_image", look, LIGHTS},
    {"pn_times", times, LIGHTS},
    {"pn_glsl", text, 1},
    {"pn_reload_shaders", reload, 1},
};
static const step closing[] = {{"pn_state_end", end, 1}};
static const step destruction[] = {{"pn_light_destroy", destroy_some, 1}, {"pn_context_destroy", destroy, 1}};
#define COUNT(table) (int)(sizeof table / sizeof *table)

static state_list before, after, defaults;

/* Runs the steps; with look_after each one is held against the state before. */
static void run(const step *steps, int count, int look_after, const state_list *allowed, const char *const *except) {
  int changed = 0;
  for (int k = 0; k < count && changed == 0; k++) {
    for (int i = 0; i < steps[k].count; i++) {
      pn_result result = steps[k].call(i);
      if (result != PN_OK) fail_msg("%s (%d): %s: %s", steps[k].name, i, pn_result_name(result), h.log.last);
      if (!look_after) continue;
      state_read(&after);
      changed += state_differences(steps[k].name, &before, &after, allowed, except);
    }
  }
  assert_int_equal(changed, 0);
}

/* The pairs' results, and what was written into the host's texture. */
static float *read_images(void) {
  float *all = malloc((IMAGES + 1) * PIXELS * sizeof *all), *two = malloc(2 * PIXELS * sizeof *two);
  assert_non_null(all);
  assert_non_null(two);
  for (int i = 0; i < IMAGES; i++) {
    float *one = host_result(lights[i % LIGHTS], receivers[i / LIGHTS]);
    assert_non_null(one);
    memcpy(all + i * PIXELS, one, PIXELS * sizeof *one);
    free(one);
  }
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, into);
  gl.GetTexImage(GL_TEXTURE_2D_ARRAY, 0, GL_RED, GL_FLOAT, two);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, 0);
  memcpy(all + IMAGES * PIXELS, two + PIXELS, PIXELS * sizeof *two);
  free(two);
  return all;
}

/* Everything under default state: what the odd runs must come to as well. */
static float *plain_images(void) {
  mode = PN_STATE_RESTORE;
  run(creation, COUNT(creation), 0, NULL, NULL);
  run(frame, COUNT(frame), 0, NULL, NULL);
  float *images = read_images();
  run(destruction, COUNT(destruction), 0, NULL, NULL);
  return images;
}

static void check_images(const float *expected) {
  float *images = read_images();
  int lit = 0, dark = 0, differ = 0;
  for (int i = 0; i < (IMAGES + 1) * PIXELS; i++) {
    lit += images[i] == 1, dark += images[i] < 0.5f;
    if (memcmp(&images[i], &expected[i], sizeof *images) != 0 && differ++ < 5) {
      fprintf(stderr, "image %d, pixel %d: %g instead of %g\n", i / PIXELS, i % PIXELS, images[i], expected[i]);
    }
  }
  free(images);
  assert_true(lit > PIXELS && dark > PIXELS / 20);
  assert_int_equal(differ, 0);
}

static void set_odd(void) {
  odd_set(&odd);
  if (gl_version() >= 41) odd_set_viewports();
}

static void unset_odd(void) {
  if (gl_version() >= 41) odd_unset_viewports();
  odd_unset(&odd);
  gl.Viewport(0, 0, WIDTH, HEIGHT);
  gl.Scissor(0, 0, WIDTH, HEIGHT);
}

/* The size of the default viewport is the window's, which the library does not know. */
static const char *const resettable[] = {"VIEWPORT",       "SCISSOR_BOX",    "VIEWPORT[1]",
                                         "VIEWPORT[2]",    "VIEWPORT[3]",    "SCISSOR_BOX[1]",
                                         "SCISSOR_BOX[2]", "SCISSOR_BOX[3]", NULL};

/* ---- the tests ------------------------------------------------------------------------------------------------------
 * */

static void test_restore(void **state) {
  (void)state;
  float *expected = plain_images();
  mode = PN_STATE_RESTORE;
  odd_set(&odd);
  state_read(&before);
  run(creation, COUNT(creation), 1, NULL, NULL);
  run(frame, COUNT(frame), 1, NULL, NULL);
  unset_odd();
  check_images(expected);
  odd_set(&odd);
  run(destruction, COUNT(destruction), 1, NULL, NULL);
  unset_odd();
  free(expected);
}

/* glViewport and its like set all of the indexed viewports; a host that uses them finds its own again. */
static void test_restore_viewports(void **state) {
  (void)state;
  if (gl_version() < 41) skip();
  mode = PN_STATE_RESTORE;
  set_odd();
  state_read(&before);
  run(creation, COUNT(creation), 1, NULL, NULL);
  run(frame, COUNT(frame), 1, NULL, NULL);
  run(destruction, COUNT(destruction), 1, NULL, NULL);
  unset_odd();
}

static void test_scoped(void **state) {
  (void)state;
  float *expected = plain_images();
  mode = PN_STATE_SCOPED;
  odd_set(&odd);
  state_read(&before);
  run(creation, COUNT(creation), 0, NULL, NULL);
  run(frame, COUNT(frame), 0, NULL, NULL);
  run(closing, COUNT(closing), 1, NULL, NULL);
  unset_odd();
  check_images(expected);
  odd_set(&odd);
  begin(0);
  run(destruction, 1, 0, NULL, NULL);
  run(closing, COUNT(closing), 1, NULL, NULL);
  run(destruction + 1, 1, 1, NULL, NULL);
  unset_odd();
  free(expected);
}

/* From the default state, everything is the default again; from an odd one, everything is as it was or the default. */
static void test_reset(void **state) {
  (void)state;
  float *expected = plain_images();
  mode = PN_STATE_RESET;
  for (int oddly = 0; oddly < 2; oddly++) {
    if (oddly) odd_set(&odd);
    state_read(&before);
    run(creation, COUNT(creation), 1, &defaults, resettable);
    run(frame, COUNT(frame), 1, &defaults, resettable);
    unset_odd();
    check_images(expected);
    run(destruction, COUNT(destruction), 0, NULL, NULL);
  }
  free(expected);
}

/* Whether the library opens debug groups here. */
static int has_groups(void) {
  const char *name;
  int in_use;
  for (int i = 0; pn_feature(h.context, i, &name, &in_use, NULL); i++)
    if (strcmp(name, "labels") == 0) return in_use;
  return 0;
}

/* In a bracket, and in reset mode, no state is read back. */
static void test_reads_nothing(void **state) {
  static const char *const getters[] = {"glGetIntegerv", "glGetBooleanv",   "glGetFloatv",     "glGetDoublev",
                                        "glIsEnabled",   "glGetIntegeri_v", "glGetBooleani_v", "glGetVertexAttrib"};
  (void)state;
  if (!counted_available()) skip();
  counted = 1;
  for (int k = 0; k < 3; k++) {
    static const pn_state_mode modes[3] = {PN_STATE_RESTORE, PN_STATE_SCOPED, PN_STATE_RESET};
    mode = modes[k];
    run(creation, COUNT(creation), 0, NULL, NULL);
    run(frame, COUNT(frame), 0, NULL, NULL);
    counted_reset();
    for (int i = 0; i < LIGHTS; i++) assert_int_equal(update(i), PN_OK);
    for (int i = 0; i < IMAGES; i++) assert_int_equal(see(i), PN_OK);
    long calls = counted_calls("gl"), reads = 0;
    for (int g = 0; g < COUNT(getters); g++) reads += counted_calls(getters[g]);
    printf("mode %d: %ld GL calls, %ld of them read state\n", k, calls, reads);
    assert_true(calls > 100);
    if (mode == PN_STATE_RESTORE) {
      assert_true(reads > 0);
    } else {
      assert_int_equal(reads, has_groups() ? LIGHTS + IMAGES : 0); /* one look a call, whether their stack is full */
    }
    if (mode == PN_STATE_SCOPED) assert_int_equal(end(0), PN_OK);
    run(destruction, COUNT(destruction), 0, NULL, NULL);
  }
  counted = 0;
}

/* The draw callback draws under the state it is promised, whatever the host's was. */
static void test_callback(void **state) {
  float *images[2];
  (void)state;
  mode = PN_STATE_RESTORE;
  run(creation, COUNT(creation), 0, NULL, NULL);
  assert_int_equal(make_receiver(0), PN_OK);
  assert_int_equal(make_light(0), PN_OK);
  assert_int_equal(host_cast(&h, CAST_CALLBACK), PN_OK);
  for (int oddly = 0; oddly < 2; oddly++) {
    if (oddly) odd_set(&odd);
    assert_int_equal(pn_maps_update(lights[0], h.casters, PN_GROUPS_ALL, NULL, 0), PN_OK);
    assert_int_equal(see(0), PN_OK);
    if (oddly) unset_odd();
    images[oddly] = host_result(lights[0], receivers[0]);
    assert_non_null(images[oddly]);
  }
  int dark = 0;
  for (int i = 0; i < PIXELS; i++) dark += images[0][i] < 0.5f;
  assert_true(dark > PIXELS / 100);
  assert_memory_equal(images[0], images[1], PIXELS * sizeof(float));
  free(images[0]), free(images[1]);
  destroy(0);
}

/* A result that the host still has bound may be made anew or destroyed: the binding becomes 0, as GL has it, and
 * nothing fails. */
static void test_deleted_while_bound(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    mode = k ? PN_STATE_SCOPED : PN_STATE_RESTORE;
    run(creation, COUNT(creation), 0, NULL, NULL);
    run(frame, COUNT(frame), 0, NULL, NULL);
    for (int i = 0; i < LIGHTS; i++) assert_int_equal(resize(i), PN_OK);
    assert_int_equal(gl_errors(), 0);
    for (int i = 0; i < LIGHTS; i++) {
      pn_image image;
      assert_int_equal(pn_result_image(lights[i], receivers[0], &image), PN_OK);
      if (k) assert_int_equal(end(0), PN_OK);
      gl.ActiveTexture(GL_TEXTURE0 + (GLenum)i);
      gl.BindTexture(GL_TEXTURE_2D, image.texture);
      if (k) assert_int_equal(begin(0), PN_OK);
      pn_light_destroy(&lights[i]);
    }
    run(closing, COUNT(closing), 0, NULL, NULL);
    run(destruction + 1, 1, 0, NULL, NULL);
    assert_int_equal(gl_errors(), 0);
    gl.ActiveTexture(GL_TEXTURE0);
  }
}

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  odd_open(&odd);
  for (int i = 0; i < VIEWS; i++) {
    views[i] = camera_sized(cameras[i], WIDTH, HEIGHT);
    if (!target_open(&targets[i], &views[i])) return -1;
    renderer_depth(&h.draw, &h.world, &views[i], &targets[i]);
  }
  gl.GenTextures(1, &into);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, into);
  gl.TexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_R32F, WIDTH, HEIGHT, 2, 0, GL_RED, GL_FLOAT, NULL);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, 0);
  four = make_texture(GL_RGBA8, WIDTH, HEIGHT);
  for (int i = 0; i < 2; i++) companions[i] = make_texture(GL_RGBA8, WIDTH, HEIGHT);
  unset_odd();
  state_read(&defaults);
  return gl_errors();
}

static int teardown(void **state) {
  (void)state;
  for (int i = 0; i < VIEWS; i++) target_close(&targets[i]);
  gl.DeleteTextures(1, &into);
  gl.DeleteTextures(1, &four);
  gl.DeleteTextures(2, companions);
  odd_close(&odd);
  host_close(&h);
  return 0;
}

/* A test that failed half-way leaves an odd state and objects: the next one starts afresh. */
static int clean(void **state) {
  (void)state;
  counted = 0;
  pn_context_destroy(&h.context);
  h.casters = NULL;
  unset_odd();
  gl.DeleteProgram(h.caster_programs[0]);
  gl.DeleteProgram(h.caster_programs[1]);
  h.caster_programs[0] = h.caster_programs[1] = 0;
  return gl_errors();
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_restore, clean),
      cmocka_unit_test_teardown(test_restore_viewports, clean),
      cmocka_unit_test_teardown(test_scoped, clean),
      cmocka_unit_test_teardown(test_reset, clean),
      cmocka_unit_test_teardown(test_reads_nothing, clean),
      cmocka_unit_test_teardown(test_callback, clean),
      cmocka_unit_test_teardown(test_deleted_while_bound, clean),
  };
  return cmocka_run_group_tests_name("state", tests, setup, teardown);
}
