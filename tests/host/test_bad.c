/* Every bad description is answered by a result and a message id, and leaves the object as it was: after each table the
 * same frame comes out to the bit. */
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

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT };

static camera view;
static camera_view seen;
static pn_light *light;
static float *expected;
static GLuint color, small_color, integers, red_only, flat_depth, forward_program;

/* One line of a table: what must come back, and what to call with which case number. */
typedef struct {
  const char *what;
  pn_result result;
  int message;
  pn_result (*call)(host *h, int k);
  int k;
} bad;

static void check_frame(host *h) {
  float *image = host_visibility(h, light, &seen);
  assert_non_null(image);
  assert_memory_equal(image, expected, PIXELS * sizeof *image);
  free(image);
}

static void check_table(host *h, const bad *table, size_t count) {
  int wrong = 0;
  for (size_t i = 0; i < count; i++) {
    const bad *b = &table[i];
    memset(&h->log, 0, sizeof h->log);
    pn_result result = b->call(h, b->k);
    int level = b->result == PN_OK ? 0 : 1, gl_wrong = gl_errors();
    if (result == b->result && h->log.counts[b->message] == 1 && h->log.errors == level && !gl_wrong &&
        h->log.last[0] && !strchr(h->log.last, '\n')) {
      continue;
    }
    wrong++;
    fprintf(stderr, "%s: %s,", b->what, pn_result_name(result));
    for (int m = 0; m < PN_MESSAGE_COUNT; m++) {
      if (h->log.counts[m]) fprintf(stderr, " %s %d times,", pn_message_name(m), h->log.counts[m]);
    }
    fprintf(stderr, " \"%s\", %d GL errors; expected %s with %s once\n", h->log.last, gl_wrong,
            pn_result_name(b->result), pn_message_name(b->message));
  }
  check_frame(h);
  assert_int_equal(wrong, 0);
}

#define CHECK(h, table) check_table(h, table, sizeof table / sizeof *table)
#define ARGUMENT PN_ERROR_ARGUMENT

/* ---- meshes
 * ------------------------------------------------------------------------------------------------------------- */

static pn_result bad_mesh(host *h, int k) {
  float bent[72];
  uint32_t far_index[3] = {0, 1, 24};
  pn_mesh_desc d = host_mesh_desc(h, k >= 60 ? SCENE_FLAG : SCENE_BOX, k >= 40 && k < 60 ? CAST_BUFFERS : CAST_MEMORY);
  pn_mesh out;
  memcpy(bent, d.positions.data ? d.positions.data : h->world.meshes[SCENE_BOX].posed, sizeof bent);
  switch (k) {
  case 0: d.positions.count = 0; break;
  case 1: d.positions.data = NULL; break;
  case 2: d.positions.buffer = h->draw.meshes[SCENE_BOX].posed; break;
  case 3: d.positions.stride = 4; break;
  case 4: d.positions.count = SIZE_MAX / 4; break;
  case 5: d.index_bytes = 0, d.indices = (pn_span){0}, d.positions.count = 23; break;
  case 10: d.index_bytes = 3; break;
  case 11: d.indices.count = 35; break;
  case 12: d.indices = (pn_span){.data = far_index, .count = 3}; break;
  case 13: d.indices.data = NULL; break;
  case 14: d.index_bytes = -4; break;
  case 20: d.bounds_min[0] = 1, d.bounds_max[0] = -1; break;
  case 21: d.bounds_min[1] = NAN, d.bounds_max[1] = 1; break;
  case 30: bent[0] = NAN, d.positions.data = bent; break;
  case 31: bent[4] = INFINITY, d.positions.data = bent; break;
  case 40: d.positions.buffer = 99999; break;
  case 41: d.positions.count = 25; break;
  case 42: d.positions.offset = 100000; break;
  case 43: d.indices.buffer = 99999; break;
  case 44: d.indices.offset = 8; break;
  case 45: memset(d.bounds_min, 0, sizeof d.bounds_min), memset(d.bounds_max, 0, sizeof d.bounds_max); break;
  case 46: d.bounds_max[2] = INFINITY; break;
  case 47: d.positions.offset = SIZE_MAX - 8; break;
  case 60: d.texcoords = (pn_span){0}; break;
  case 61: d.texcoords.count--; break;
  case 62: d.texcoords.stride = 3; break;
  case 63: d.alpha_channel = 4; break;
  case 64: d.alpha_channel = -1; break;
  case 65: d.alpha_cutoff = 1.5f; break;
  case 66: d.alpha_cutoff = -0.5f; break;
  case 67: d.alpha_cutoff = NAN; break;
  case 68: d.alpha_texture = 99999; break;
  default: break;
  }
  pn_result result = pn_mesh_add(h->casters, &d, &out);
  return result == PN_OK ? pn_mesh_remove(h->casters, out) : result;
}

static void test_meshes(void **state) {
  static const bad table[] = {
      {"no vertices", ARGUMENT, PN_MESSAGE_MESH_POSITIONS, bad_mesh, 0},
      {"no positions", ARGUMENT, PN_MESSAGE_MESH_POSITIONS, bad_mesh, 1},
      {"buffer and data", ARGUMENT, PN_MESSAGE_MESH_POSITIONS, bad_mesh, 2},
      {"stride below an element", ARGUMENT, PN_MESSAGE_MESH_POSITIONS, bad_mesh, 3},
      {"count overflows", ARGUMENT, PN_MESSAGE_MESH_POSITIONS, bad_mesh, 4},
      {"unindexed, not three by three", ARGUMENT, PN_MESSAGE_MESH_INDICES, bad_mesh, 5},
      {"index_bytes 3", ARGUMENT, PN_MESSAGE_MESH_INDICES, bad_mesh, 10},
      {"35 indices", ARGUMENT, PN_MESSAGE_MESH_INDICES, bad_mesh, 11},
      {"index out of range", ARGUMENT, PN_MESSAGE_MESH_INDICES, bad_mesh, 12},
      {"no index data", ARGUMENT, PN_MESSAGE_MESH_INDICES, bad_mesh, 13},
      {"index_bytes -4", ARGUMENT, PN_MESSAGE_MESH_INDICES, bad_mesh, 14},
      {"inverted bounds", ARGUMENT, PN_MESSAGE_MESH_BOUNDS, bad_mesh, 20},
      {"NaN bounds", ARGUMENT, PN_MESSAGE_MESH_BOUNDS, bad_mesh, 21},
      {"NaN vertex", PN_OK, PN_MESSAGE_MESH_DROPPED, bad_mesh, 30},
      {"infinite vertex", PN_OK, PN_MESSAGE_MESH_DROPPED, bad_mesh, 31},
      {"no such buffer", ARGUMENT, PN_MESSAGE_MESH_POSITIONS, bad_mesh, 40},
      {"beyond the buffer", ARGUMENT, PN_MESSAGE_MESH_POSITIONS, bad_mesh, 41},
      {"offset beyond the buffer", ARGUMENT, PN_MESSAGE_MESH_POSITIONS, bad_mesh, 42},
      {"no such index buffer", ARGUMENT, PN_MESSAGE_MESH_INDICES, bad_mesh, 43},
      {"indices beyond the buffer", ARGUMENT, PN_MESSAGE_MESH_INDICES, bad_mesh, 44},
      {"a buffer without bounds", ARGUMENT, PN_MESSAGE_MESH_BOUNDS, bad_mesh, 45},
      {"infinite bounds", ARGUMENT, PN_MESSAGE_MESH_BOUNDS, bad_mesh, 46},
      {"offset overflows", ARGUMENT, PN_MESSAGE_MESH_POSITIONS, bad_mesh, 47},
      {"alpha without coordinates", ARGUMENT, PN_MESSAGE_MESH_TEXCOORDS, bad_mesh, 60},
      {"too few coordinates", ARGUMENT, PN_MESSAGE_MESH_TEXCOORDS, bad_mesh, 61},
      {"stride of coordinates", ARGUMENT, PN_MESSAGE_MESH_TEXCOORDS, bad_mesh, 62},
      {"channel 4", ARGUMENT, PN_MESSAGE_MESH_ALPHA, bad_mesh, 63},
      {"channel -1", ARGUMENT, PN_MESSAGE_MESH_ALPHA, bad_mesh, 64},
      {"cutoff 1.5", ARGUMENT, PN_MESSAGE_MESH_ALPHA, bad_mesh, 65},
      {"cutoff -0.5", ARGUMENT, PN_MESSAGE_MESH_ALPHA, bad_mesh, 66},
      {"cutoff NaN", ARGUMENT, PN_MESSAGE_MESH_ALPHA, bad_mesh, 67},
      {"no such alpha texture", ARGUMENT, PN_MESSAGE_MESH_ALPHA, bad_mesh, 68},
  };
  CHECK(*state, table);
}

/* ---- instances and callbacks
 * ----------------------------------------------------------------------------------------------- */

static void draw_nothing(void *user, const pn_caster_pass *pass) { (void)user, (void)pass; }

static pn_result bad_instance(host *h, int k) {
  pn_instance out, existing = h->instances[SCENE_BOX];
  pn_mesh box = h->meshes[SCENE_BOX], gone = {4711}, none = {0};
  pn_span span = {.data = h->world.meshes[SCENE_BOX].posed, .count = 24}, few = {.data = span.data, .count = 23};
  float m[16], bounds[6] = {-1, -1, -1, 1, 1, 1};
  memcpy(m, h->world.meshes[SCENE_BOX].place, sizeof m);
  switch (k) {
  case 0: return pn_instance_add(h->casters, none, m, 0, &out);
  case 1: return pn_instance_add(h->casters, gone, m, 0, &out);
  case 2: return pn_mesh_remove(h->casters, gone);
  case 3: return pn_mesh_moved(h->casters, none, &span, NULL);
  case 4: return pn_mesh_moved(h->casters, box, &few, NULL);
  case 5: bounds[0] = 2; return pn_mesh_moved(h->casters, box, &span, bounds);
  case 10: return pn_instance_move(h->casters, (pn_instance){0}, m);
  case 11: return pn_instance_remove(h->casters, (pn_instance){4711});
  case 20: m[5] = NAN; return pn_instance_add(h->casters, box, m, 0, &out);
  case 21: m[3] = 0.5f; return pn_instance_add(h->casters, box, m, 0, &out);
  case 22: m[12] = INFINITY; return pn_instance_move(h->casters, existing, m);
  case 23: m[15] = 0; return pn_instance_move(h->casters, existing, m);
  case 30: return pn_instance_add(h->casters, box, m, -1, &out);
  case 31: return pn_instance_add(h->casters, box, m, PN_GROUP_COUNT, &out);
  case 32: return pn_casters_draw(h->casters, 32, draw_nothing, h, bounds);
  case 33: return pn_casters_draw(h->casters, -1, draw_nothing, h, bounds);
  case 40: bounds[0] = 2; return pn_casters_draw(h->casters, 3, draw_nothing, h, bounds);
  case 41: bounds[5] = NAN; return pn_casters_draw(h->casters, 3, draw_nothing, h, bounds);
  case 42: bounds[3] = INFINITY; return pn_casters_draw(h->casters, 3, draw_nothing, h, bounds);
  case 50: return pn_mesh_add(h->casters, NULL, &box);
  case 51: return pn_instance_add(h->casters, box, NULL, 0, &out);
  case 52: return pn_instance_move(h->casters, existing, NULL);
  case 53: return pn_casters_create(h->context, NULL);
  default: return pn_casters_draw(h->casters, 3, draw_nothing, h, NULL);
  }
}

static void test_instances(void **state) {
  static const bad table[] = {
      {"instance of mesh 0", ARGUMENT, PN_MESSAGE_MESH_UNKNOWN, bad_instance, 0},
      {"instance of an unknown mesh", ARGUMENT, PN_MESSAGE_MESH_UNKNOWN, bad_instance, 1},
      {"removing an unknown mesh", ARGUMENT, PN_MESSAGE_MESH_UNKNOWN, bad_instance, 2},
      {"moving mesh 0", ARGUMENT, PN_MESSAGE_MESH_UNKNOWN, bad_instance, 3},
      {"moved with another count", ARGUMENT, PN_MESSAGE_MESH_POSITIONS, bad_instance, 4},
      {"moved with inverted bounds", ARGUMENT, PN_MESSAGE_MESH_BOUNDS, bad_instance, 5},
      {"moving instance 0", ARGUMENT, PN_MESSAGE_INSTANCE_UNKNOWN, bad_instance, 10},
      {"removing an unknown instance", ARGUMENT, PN_MESSAGE_INSTANCE_UNKNOWN, bad_instance, 11},
      {"NaN transform", ARGUMENT, PN_MESSAGE_INSTANCE_TRANSFORM, bad_instance, 20},
      {"projective transform", ARGUMENT, PN_MESSAGE_INSTANCE_TRANSFORM, bad_instance, 21},
      {"infinite transform", ARGUMENT, PN_MESSAGE_INSTANCE_TRANSFORM, bad_instance, 22},
      {"last number 0", ARGUMENT, PN_MESSAGE_INSTANCE_TRANSFORM, bad_instance, 23},
      {"group -1", ARGUMENT, PN_MESSAGE_CASTER_GROUP, bad_instance, 30},
      {"group 32", ARGUMENT, PN_MESSAGE_CASTER_GROUP, bad_instance, 31},
      {"callback in group 32", ARGUMENT, PN_MESSAGE_CASTER_GROUP, bad_instance, 32},
      {"callback in group -1", ARGUMENT, PN_MESSAGE_CASTER_GROUP, bad_instance, 33},
      {"callback's inverted bounds", ARGUMENT, PN_MESSAGE_CASTER_BOUNDS, bad_instance, 40},
      {"callback's NaN bounds", ARGUMENT, PN_MESSAGE_CASTER_BOUNDS, bad_instance, 41},
      {"callback's infinite bounds", ARGUMENT, PN_MESSAGE_CASTER_BOUNDS, bad_instance, 42},
      {"no mesh description", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_instance, 50},
      {"no transform", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_instance, 51},
      {"no transform to move to", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_instance, 52},
      {"no place for casters", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_instance, 53},
      {"callback without bounds", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_instance, 54},
  };
  CHECK(*state, table);
}

/* ---- receivers
 * ------------------------------------------------------------------------------------------------------------- */

static pn_result bad_receiver(host *h, int k) {
  (void)h;
  pn_receiver_desc d = host_receiver_desc(&view, &seen.target);
  switch (k) {
  case 0: d.depth_texture = 0; break;
  case 1: d.use_framebuffer = 1, d.depth_framebuffer = seen.target.framebuffer; break;
  case 2: d.depth_texture = 99999; break;
  case 3: d.depth_texture = 0, d.use_framebuffer = 1, d.depth_framebuffer = 99999; break;
  case 10: d.depth_texture = color; break;
  case 11: d.depth_texture = 0, d.use_framebuffer = 1, d.depth_framebuffer = flat_depth; break;
  case 20: d.x = -1; break;
  case 21: d.width = WIDTH + 1; break;
  case 22: d.height = -3; break;
  case 23: d.y = 1; break;
  case 24: d.height = 0; break;
  case 25: d.x = INT32_MAX, d.width = INT32_MAX; break;
  case 30: d.view[0] = NAN; break;
  case 31: memset(d.projection, 0, sizeof d.projection); break;
  case 32: d.projection[5] = 0; break;
  case 33: memset(d.view, 0, sizeof d.view); break;
  case 34: d.projection[0] = INFINITY; break;
  case 40: d.normal_texture = small_color; break;
  case 41: d.normal_texture = color, d.normal_encoding = (pn_normal_encoding)17; break;
  case 42: d.normal_texture = seen.target.depth; break;
  case 43: d.normal_texture = 99999; break;
  case 44: d.normal_texture = integers; break;
  case 45: d.normal_texture = red_only; break;
  case 50: d.mask_texture = small_color; break;
  case 51: d.mask_texture = 99999; break;
  case 52: d.mask_texture = integers; break;
  case 60: d.scale = 3; break;
  case 61: d.scale = -1; break;
  case 62: d.scale = 8; break;
  case 63: d.format = (pn_format)42; break;
  case 64: d.format = (pn_format)-1; break;
  case 70: return pn_receiver_set(seen.receiver, NULL);
  case 71: return pn_receiver_create(h->context, NULL);
  default: break;
  }
  return pn_receiver_set(seen.receiver, &d);
}

static void test_receivers(void **state) {
  static const bad table[] = {
      {"no source", ARGUMENT, PN_MESSAGE_RECEIVER_SOURCE, bad_receiver, 0},
      {"two sources", ARGUMENT, PN_MESSAGE_RECEIVER_SOURCE, bad_receiver, 1},
      {"no such texture", ARGUMENT, PN_MESSAGE_RECEIVER_SOURCE, bad_receiver, 2},
      {"no such framebuffer", ARGUMENT, PN_MESSAGE_RECEIVER_SOURCE, bad_receiver, 3},
      {"a colour texture", ARGUMENT, PN_MESSAGE_RECEIVER_DEPTH, bad_receiver, 10},
      {"a framebuffer without depth", ARGUMENT, PN_MESSAGE_RECEIVER_DEPTH, bad_receiver, 11},
      {"view begins outside", ARGUMENT, PN_MESSAGE_RECEIVER_VIEW, bad_receiver, 20},
      {"view ends outside", ARGUMENT, PN_MESSAGE_RECEIVER_VIEW, bad_receiver, 21},
      {"negative height", ARGUMENT, PN_MESSAGE_RECEIVER_VIEW, bad_receiver, 22},
      {"view ends above", ARGUMENT, PN_MESSAGE_RECEIVER_VIEW, bad_receiver, 23},
      {"no height", ARGUMENT, PN_MESSAGE_RECEIVER_VIEW, bad_receiver, 24},
      {"view overflows", ARGUMENT, PN_MESSAGE_RECEIVER_VIEW, bad_receiver, 25},
      {"NaN view", ARGUMENT, PN_MESSAGE_RECEIVER_MATRIX, bad_receiver, 30},
      {"projection of zeros", ARGUMENT, PN_MESSAGE_RECEIVER_MATRIX, bad_receiver, 31},
      {"projection that is flat", ARGUMENT, PN_MESSAGE_RECEIVER_MATRIX, bad_receiver, 32},
      {"view of zeros", ARGUMENT, PN_MESSAGE_RECEIVER_MATRIX, bad_receiver, 33},
      {"infinite projection", ARGUMENT, PN_MESSAGE_RECEIVER_MATRIX, bad_receiver, 34},
      {"normals of another size", ARGUMENT, PN_MESSAGE_RECEIVER_NORMAL, bad_receiver, 40},
      {"normals' encoding", ARGUMENT, PN_MESSAGE_RECEIVER_NORMAL, bad_receiver, 41},
      {"depth as normals", ARGUMENT, PN_MESSAGE_RECEIVER_NORMAL, bad_receiver, 42},
      {"no such normals", ARGUMENT, PN_MESSAGE_RECEIVER_NORMAL, bad_receiver, 43},
      {"integers as normals", ARGUMENT, PN_MESSAGE_RECEIVER_NORMAL, bad_receiver, 44},
      {"one channel of normals", ARGUMENT, PN_MESSAGE_RECEIVER_NORMAL, bad_receiver, 45},
      {"mask of another size", ARGUMENT, PN_MESSAGE_RECEIVER_MASK, bad_receiver, 50},
      {"no such mask", ARGUMENT, PN_MESSAGE_RECEIVER_MASK, bad_receiver, 51},
      {"integers as mask", ARGUMENT, PN_MESSAGE_RECEIVER_MASK, bad_receiver, 52},
      {"scale 3", ARGUMENT, PN_MESSAGE_RECEIVER_SCALE, bad_receiver, 60},
      {"scale -1", ARGUMENT, PN_MESSAGE_RECEIVER_SCALE, bad_receiver, 61},
      {"scale 8", ARGUMENT, PN_MESSAGE_RECEIVER_SCALE, bad_receiver, 62},
      {"format 42", ARGUMENT, PN_MESSAGE_RECEIVER_FORMAT, bad_receiver, 63},
      {"format -1", ARGUMENT, PN_MESSAGE_RECEIVER_FORMAT, bad_receiver, 64},
      {"no receiver description", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_receiver, 70},
      {"no place for a receiver", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_receiver, 71},
  };
  CHECK(*state, table);
}

/* ---- lights
 * ---------------------------------------------------------------------------------------------------------------- */

static void spoil_light(pn_light_desc *d, int k) {
  static const float upside_down[6] = {1, 1, 1, -1, -1, -1}, endless[6] = {-1, -1, -1, 1, INFINITY, 1};
  switch (k) {
  case 0: d->shape = (pn_light_shape)7; break;
  case 1: d->shape = (pn_light_shape)-1; break;
  case 10: memset(d->direction, 0, sizeof d->direction); break;
  case 11: d->direction[1] = NAN; break;
  case 12: memcpy(d->axis_u, d->direction, sizeof d->axis_u); break;
  case 13: d->axis_u[0] = INFINITY; break;
  case 14: d->center[2] = NAN; break;
  case 20: d->half_u = 0; break;
  case 21: d->half_v = -1; break;
  case 22: d->half_u = NAN; break;
  case 23: d->half_v = INFINITY; break;
  case 24: d->shape = PN_LIGHT_SUN, d->half_u = 1.5f * PN_SUN_TANGENT_MAX; break;
  case 30: d->near_distance = -1; break;
  case 31: d->range = -0.5f; break;
  case 32: d->near_distance = 5, d->range = 3; break;
  case 33: d->near_distance = NAN; break;
  case 34: d->range = INFINITY; break;
  case 40: d->texture = color; break;
  case 50: d->fit = (pn_fit)9; break;
  case 51: d->fit = PN_FIT_GIVEN, memcpy(d->fit_bounds, upside_down, sizeof upside_down); break;
  case 52: d->fit = PN_FIT_GIVEN, memcpy(d->fit_bounds, endless, sizeof endless); break;
  case 53: d->fit = (pn_fit)-1; break;
  case 60: d->map_width = -1; break;
  case 61: d->map_width = PN_MAP_SIZE_MAX + 1; break;
  case 62: d->map_height = -5; break;
  case 63: d->map_height = 1000000; break;
  default: break;
  }
}

static pn_result bad_light(host *h, int k) {
  pn_light_desc d = host_light_desc();
  d.map_width = 64;
  spoil_light(&d, k);
  if (k == 70) return pn_light_set(light, NULL);
  if (k == 71) return pn_light_create(h->context, NULL);
  return pn_light_set(light, &d);
}

static void test_lights(void **state) {
  static const bad table[] = {
      {"shape 7", ARGUMENT, PN_MESSAGE_LIGHT_SHAPE, bad_light, 0},
      {"shape -1", ARGUMENT, PN_MESSAGE_LIGHT_SHAPE, bad_light, 1},
      {"no direction", ARGUMENT, PN_MESSAGE_LIGHT_FRAME, bad_light, 10},
      {"NaN direction", ARGUMENT, PN_MESSAGE_LIGHT_FRAME, bad_light, 11},
      {"axis along the direction", ARGUMENT, PN_MESSAGE_LIGHT_FRAME, bad_light, 12},
      {"infinite axis", ARGUMENT, PN_MESSAGE_LIGHT_FRAME, bad_light, 13},
      {"NaN centre", ARGUMENT, PN_MESSAGE_LIGHT_FRAME, bad_light, 14},
      {"width 0", ARGUMENT, PN_MESSAGE_LIGHT_SIZE, bad_light, 20},
      {"negative height", ARGUMENT, PN_MESSAGE_LIGHT_SIZE, bad_light, 21},
      {"NaN width", ARGUMENT, PN_MESSAGE_LIGHT_SIZE, bad_light, 22},
      {"infinite height", ARGUMENT, PN_MESSAGE_LIGHT_SIZE, bad_light, 23},
      {"a sun wider than the sky", ARGUMENT, PN_MESSAGE_LIGHT_SIZE, bad_light, 24},
      {"negative near distance", ARGUMENT, PN_MESSAGE_LIGHT_RANGE, bad_light, 30},
      {"negative range", ARGUMENT, PN_MESSAGE_LIGHT_RANGE, bad_light, 31},
      {"near beyond range", ARGUMENT, PN_MESSAGE_LIGHT_RANGE, bad_light, 32},
      {"NaN near distance", ARGUMENT, PN_MESSAGE_LIGHT_RANGE, bad_light, 33},
      {"infinite range", ARGUMENT, PN_MESSAGE_LIGHT_RANGE, bad_light, 34},
      {"a textured light", PN_ERROR_UNSUPPORTED, PN_MESSAGE_LIGHT_TEXTURE, bad_light, 40},
      {"fit 9", ARGUMENT, PN_MESSAGE_LIGHT_FIT, bad_light, 50},
      {"inverted fit", ARGUMENT, PN_MESSAGE_LIGHT_FIT, bad_light, 51},
      {"infinite fit", ARGUMENT, PN_MESSAGE_LIGHT_FIT, bad_light, 52},
      {"fit -1", ARGUMENT, PN_MESSAGE_LIGHT_FIT, bad_light, 53},
      {"map width -1", ARGUMENT, PN_MESSAGE_LIGHT_MAP, bad_light, 60},
      {"map width 8193", ARGUMENT, PN_MESSAGE_LIGHT_MAP, bad_light, 61},
      {"map height -5", ARGUMENT, PN_MESSAGE_LIGHT_MAP, bad_light, 62},
      {"map height 1000000", ARGUMENT, PN_MESSAGE_LIGHT_MAP, bad_light, 63},
      {"no light description", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_light, 70},
      {"no place for a light", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_light, 71},
  };
  CHECK(*state, table);
}

static pn_result wide_light(host *h, int k) {
  pn_light *wide = NULL;
  pn_mesh m;
  pn_instance instance;
  pn_casters *plane = NULL;
  pn_light_desc d = {.center = {0, 0.01f, 0}, .direction = {0, -1, 0}, .half_u = 0.1f, .half_v = 0.1f, .map_width = 16};
  pn_mesh_desc floor = host_mesh_desc(h, SCENE_FLOOR, CAST_MEMORY);
  (void)k;
  pn_result result = pn_casters_create(h->context, &plane);
  if (result == PN_OK) result = pn_mesh_add(plane, &floor, &m);
  if (result == PN_OK) result = pn_instance_add(plane, m, h->world.meshes[SCENE_FLOOR].place, 0, &instance);
  if (result == PN_OK) result = host_light(h, &d, "hard", &wide);
  if (result == PN_OK) result = pn_maps_update(wide, plane, PN_GROUPS_ALL, NULL, 0);
  if (result == PN_OK) result = pn_visibility(wide, seen.receiver);
  pn_light_destroy(&wide);
  pn_casters_destroy(&plane);
  return result;
}

static void test_wide_light(void **state) {
  static const bad table[] = {{"a light on the ground", PN_OK, PN_MESSAGE_LIGHT_ANGLE, wide_light, 0}};
  CHECK(*state, table);
}

/* ---- techniques
 * ------------------------------------------------------------------------------------------------------------ */

static pn_result bad_technique(host *h, int k) {
  static const char *const specs[] = {"pcsss",
                                      "",
                                      ":",
                                      "pcss:bogus=1",
                                      "pcss:samples=banana",
                                      "pcss:samples=-5",
                                      "pcss:samples=",
                                      "pcss:samples",
                                      "pcss:samples=1e99",
                                      "pcf:filter=round",
                                      "pcss:=3",
                                      "pcss:samples=4,,",
                                      "pcss:samples=nan"};
  (void)h;
  char why[8] = "1234567";
  if (k < 20) {
    pn_result result = pn_light_technique(light, specs[k], why, sizeof why);
    /* Cut off, but terminated and not empty. */
    return memchr(why, 0, sizeof why) && why[0] && strcmp(why, "1234567") != 0 ? result : PN_OK;
  }
  if (k == 20) return pn_light_parameter(light, "bogus", 1);
  if (k == 21) return pn_light_parameter(light, "samples", NAN);
  if (k == 22) return pn_light_parameter(light, "samples", 1e9);
  if (k == 23) return pn_light_parameter(light, NULL, 1);
  if (k == 24) return pn_light_technique(light, NULL, why, sizeof why);
  return pn_prepare(h->context, "nothing", NULL);
}

static void test_techniques(void **state) {
  static const bad table[] = {
      {"pcsss", ARGUMENT, PN_MESSAGE_TECHNIQUE_UNKNOWN, bad_technique, 0},
      {"empty spec", ARGUMENT, PN_MESSAGE_TECHNIQUE_UNKNOWN, bad_technique, 1},
      {"only a colon", ARGUMENT, PN_MESSAGE_TECHNIQUE_UNKNOWN, bad_technique, 2},
      {"bogus parameter", ARGUMENT, PN_MESSAGE_PARAMETER_UNKNOWN, bad_technique, 3},
      {"a banana", ARGUMENT, PN_MESSAGE_PARAMETER_VALUE, bad_technique, 4},
      {"-5 samples", ARGUMENT, PN_MESSAGE_PARAMETER_VALUE, bad_technique, 5},
      {"no value", ARGUMENT, PN_MESSAGE_PARAMETER_VALUE, bad_technique, 6},
      {"no sign of equality", ARGUMENT, PN_MESSAGE_PARAMETER_UNKNOWN, bad_technique, 7},
      {"1e99 samples", ARGUMENT, PN_MESSAGE_PARAMETER_VALUE, bad_technique, 8},
      {"a round filter", ARGUMENT, PN_MESSAGE_PARAMETER_VALUE, bad_technique, 9},
      {"no name", ARGUMENT, PN_MESSAGE_PARAMETER_UNKNOWN, bad_technique, 10},
      {"empty parameter", ARGUMENT, PN_MESSAGE_PARAMETER_UNKNOWN, bad_technique, 11},
      {"nan samples", ARGUMENT, PN_MESSAGE_PARAMETER_VALUE, bad_technique, 12},
      {"set bogus", ARGUMENT, PN_MESSAGE_PARAMETER_UNKNOWN, bad_technique, 20},
      {"set NaN", ARGUMENT, PN_MESSAGE_PARAMETER_VALUE, bad_technique, 21},
      {"set 1e9", ARGUMENT, PN_MESSAGE_PARAMETER_VALUE, bad_technique, 22},
      {"set nothing", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_technique, 23},
      {"no spec", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_technique, 24},
      {"prepare nothing", ARGUMENT, PN_MESSAGE_TECHNIQUE_UNKNOWN, bad_technique, 25},
  };
  CHECK(*state, table);
}

/* ---- a frame in the wrong order, and wrong targets
 * --------------------------------------------------------------------------- */

static pn_result bad_order(host *h, int k) {
  pn_light *fresh = NULL;
  pn_receiver *unset = NULL;
  pn_image image;
  pn_maps_info maps;
  pn_light_desc desc = host_light_desc();
  desc.map_width = 16;
  pn_result result = pn_light_create(h->context, &fresh);
  if (result == PN_OK) result = pn_receiver_create(h->context, &unset);
  if (result == PN_OK && k >= 10) result = pn_light_set(fresh, &desc);
  if (result == PN_OK && k >= 20) result = pn_maps_update(fresh, h->casters, PN_GROUPS_ALL, NULL, 0);
  if (result != PN_OK) return result;
  desc.half_u *= 2;
  switch (k) {
  case 0: result = pn_maps_update(fresh, h->casters, PN_GROUPS_ALL, NULL, 0); break;
  case 1: result = pn_visibility(fresh, seen.receiver); break;
  case 10: result = pn_visibility(fresh, seen.receiver); break;
  case 11: result = pn_result_image(fresh, seen.receiver, &image); break;
  case 12: result = pn_light_maps(fresh, &maps); break;
  case 20: result = pn_visibility(fresh, unset); break;
  case 21: result = pn_light_set(fresh, &desc) == PN_OK ? pn_visibility(fresh, seen.receiver) : PN_OK; break;
  case 22:
    result =
        pn_light_technique(fresh, "average:samples=4", NULL, 0) == PN_OK ? pn_visibility(fresh, seen.receiver) : PN_OK;
    break;
  case 23: result = pn_maps_update(fresh, NULL, PN_GROUPS_ALL, NULL, 0); break;
  case 24: result = pn_visibility(fresh, NULL); break;
  case 25: result = pn_maps_update(fresh, h->casters, PN_GROUPS_ALL, NULL, 1); break;
  case 26: result = pn_light_maps(fresh, NULL); break;
  default: result = pn_result_image(fresh, seen.receiver, NULL); break;
  }
  pn_light_destroy(&fresh);
  pn_receiver_destroy(&unset);
  return result;
}

static void test_order(void **state) {
  static const bad table[] = {
      {"maps of an unset light", PN_ERROR_NOT_READY, PN_MESSAGE_LIGHT_UNSET, bad_order, 0},
      {"visibility of an unset light", PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, bad_order, 1},
      {"visibility without maps", PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, bad_order, 10},
      {"maps' numbers without maps", PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, bad_order, 12},
      {"an unset receiver", PN_ERROR_NOT_READY, PN_MESSAGE_RECEIVER_UNSET, bad_order, 20},
      {"the light changed", PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, bad_order, 21},
      {"the technique changed", PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, bad_order, 22},
      {"no casters", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_order, 23},
      {"no receiver", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_order, 24},
      {"one receiver, none given", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_order, 25},
      {"nowhere to put maps' numbers", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_order, 26},
      {"nowhere to put the image", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_order, 27},
  };
  CHECK(*state, table);
}

/* Which message says that a pair has no result yet is not laid down; that it is an error is. */
static void test_no_result_yet(void **state) {
  host *h = *state;
  assert_int_equal(bad_order(h, 11), PN_ERROR_NOT_READY);
  assert_int_equal(h->log.errors > 0, 1);
}

static pn_result bad_target(host *h, int k) {
  (void)h;
  switch (k) {
  case 0: return pn_visibility_into(light, seen.receiver, &(pn_target){0, 0, 0});
  case 1: return pn_visibility_into(light, seen.receiver, &(pn_target){99999, 0, 0});
  case 2: return pn_visibility_into(light, seen.receiver, &(pn_target){small_color, 0, 0});
  case 3: return pn_visibility_into(light, seen.receiver, &(pn_target){seen.target.depth, 0, 0});
  case 4: return pn_visibility_into(light, seen.receiver, &(pn_target){color, 1, 0});
  default: return pn_visibility_into(light, seen.receiver, &(pn_target){color, -1, 0});
  }
}

static void test_targets(void **state) {
  static const bad table[] = {
      {"into nothing", ARGUMENT, PN_MESSAGE_RESULT_TARGET, bad_target, 0},
      {"into no such texture", ARGUMENT, PN_MESSAGE_RESULT_TARGET, bad_target, 1},
      {"into a small texture", ARGUMENT, PN_MESSAGE_RESULT_TARGET, bad_target, 2},
      {"into depth", ARGUMENT, PN_MESSAGE_RESULT_TARGET, bad_target, 3},
      {"into layer 1 of one", ARGUMENT, PN_MESSAGE_RESULT_TARGET, bad_target, 4},
      {"into layer -1", ARGUMENT, PN_MESSAGE_RESULT_TARGET, bad_target, 5},
  };
  CHECK(*state, table);
}

/* ---- forward
 * --------------------------------------------------------------------------------------------------------------- */

static pn_result text_result(const char *text) { return text ? PN_OK : PN_ERROR_ARGUMENT; }

static pn_result bad_forward(host *h, int k) {
  pn_light *pair[PN_FORWARD_LIGHTS_MAX + 1];
  pn_light *other = NULL;
  pn_slots slots = {0, 0};
  GLuint program = forward_program;
  pn_result result = PN_OK;
  for (int i = 0; i <= PN_FORWARD_LIGHTS_MAX; i++) pair[i] = light;
  switch (k) {
  case 0: return text_result(pn_glsl(h->context, "average", 330, 0));
  case 1: return text_result(pn_glsl(h->context, "nothing", 330, 0));
  case 2: return text_result(pn_glsl(h->context, NULL, 330, 0));
  case 10: return pn_bind(pair, 0, program, &slots);
  case 11: return pn_bind(pair, PN_FORWARD_LIGHTS_MAX + 1, program, &slots);
  case 12: slots.first_texture_unit = 100000; return pn_bind(pair, 1, program, &slots);
  case 13: slots.uniform_binding = -1; return pn_bind(pair, 1, program, &slots);
  case 14: return pn_bind(pair, 1, 99999, &slots);
  case 15: return pn_bind(pair, 1, program, NULL);
  case 16: return pn_bind(NULL, 1, program, &slots);
  case 18: slots.uniform_binding = 100000; return pn_bind(pair, 1, program, &slots);
  case 19: return pn_bind(pair, 1, h->draw.depth_program, &slots);
  default: break;
  }
  pn_light_desc desc = host_light_desc();
  result = host_light(h, &desc, "hard", &other);
  if (result == PN_OK) result = pn_maps_update(other, h->casters, PN_GROUPS_ALL, NULL, 0);
  pair[1] = other;
  if (result == PN_OK) result = pn_bind(pair, 2, program, &slots);
  pn_light_destroy(&other);
  return result;
}

static void test_forward(void **state) {
  static const bad table[] = {
      {"average has no forward form", ARGUMENT, PN_MESSAGE_FORWARD, bad_forward, 0},
      {"text of nothing", ARGUMENT, PN_MESSAGE_TECHNIQUE_UNKNOWN, bad_forward, 1},
      {"text of NULL", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_forward, 2},
      {"too many lights", ARGUMENT, PN_MESSAGE_FORWARD, bad_forward, 11},
      {"unit 100000", ARGUMENT, PN_MESSAGE_FORWARD, bad_forward, 12},
      {"binding -1", ARGUMENT, PN_MESSAGE_FORWARD, bad_forward, 13},
      {"binding 100000", ARGUMENT, PN_MESSAGE_FORWARD, bad_forward, 18},
      {"a program without the text", ARGUMENT, PN_MESSAGE_FORWARD, bad_forward, 19},
      {"no such program", ARGUMENT, PN_MESSAGE_FORWARD, bad_forward, 14},
      {"no slots", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_forward, 15},
      {"two techniques", ARGUMENT, PN_MESSAGE_FORWARD, bad_forward, 17},
  };
  CHECK(*state, table);
  /* Without a light there is no log to speak to. */
  assert_int_equal(bad_forward(*state, 10), ARGUMENT);
  assert_int_equal(bad_forward(*state, 16), ARGUMENT);
}

/* ---- context and state scope
 * ------------------------------------------------------------------------------------------------- */

static void *no_draw_arrays(void *user, const char *name) {
  return strcmp(name, "glDrawArrays") == 0 ? NULL : gl_address(user, name);
}

static pn_result bad_context(host *h, int k) {
  pn_context *made = NULL;
  pn_context_desc desc = host_context_desc(h);
  pn_result result;
  switch (k) {
  case 0: return pn_context_create(&desc, NULL);
  case 1: desc.get_proc_address = no_draw_arrays; break;
  case 2: desc.shader_directory = "/nowhere/at/all"; break;
  case 3: desc.state = (pn_state_mode)9; break;
  default: desc.state = PN_STATE_SCOPED; break;
  }
  result = pn_context_create(&desc, &made);
  if (result == PN_OK && k == 10) result = pn_state_end(made);
  if (result == PN_OK && k == 11) {
    result = pn_state_begin(made);
    if (result == PN_OK) result = pn_state_begin(made);
  }
  pn_context_destroy(&made);
  return result;
}

static void test_context(void **state) {
  static const bad table[] = {
      {"no place for a context", ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, bad_context, 0},
      {"a loader without glDrawArrays", PN_ERROR_UNSUPPORTED, PN_MESSAGE_GL_FUNCTION, bad_context, 1},
      {"no shader directory", ARGUMENT, PN_MESSAGE_SHADER_DIRECTORY, bad_context, 2},
      {"no such state mode", ARGUMENT, PN_MESSAGE_STATE_MODE, bad_context, 3},
      {"end without begin", ARGUMENT, PN_MESSAGE_STATE_SCOPE, bad_context, 10},
      {"begin twice", ARGUMENT, PN_MESSAGE_STATE_SCOPE, bad_context, 11},
  };
  CHECK(*state, table);
}

/* OpenGL ES is not OpenGL 3.3. */
static void test_version(void **state) {
  host *h = *state;
  headless es;
  pn_context *made = NULL;
  pn_context_desc desc = host_context_desc(h);
  if (!headless_open_es(&h->window, &es)) skip();
  memset(&h->log, 0, sizeof h->log);
  pn_result result = pn_context_create(&desc, &made);
  headless_close_es(&es);
  headless_current(&h->window);
  assert_int_equal(result, PN_ERROR_UNSUPPORTED);
  assert_null(made);
  assert_int_equal(h->log.counts[PN_MESSAGE_GL_VERSION], 1);
  check_frame(h);
}

/* NULL objects have no log to speak to; the calls answer all the same. */
static void test_null_objects(void **state) {
  pn_receiver_desc receiver_desc = PN_RECEIVER_DEFAULTS;
  pn_light_desc light_desc = host_light_desc();
  pn_image image;
  pn_info info;
  pn_mesh m;
  (void)state;
  assert_int_equal(pn_context_info(NULL, &info), ARGUMENT);
  assert_int_equal(pn_receiver_set(NULL, &receiver_desc), ARGUMENT);
  assert_int_equal(pn_light_set(NULL, &light_desc), ARGUMENT);
  assert_int_equal(pn_light_technique(NULL, "pcss", NULL, 0), ARGUMENT);
  assert_int_equal(pn_maps_update(NULL, NULL, 1, NULL, 0), ARGUMENT);
  assert_int_equal(pn_visibility(NULL, NULL), ARGUMENT);
  assert_int_equal(pn_result_image(NULL, NULL, &image), ARGUMENT);
  assert_int_equal(pn_mesh_add(NULL, NULL, &m), ARGUMENT);
  assert_int_equal(pn_prepare(NULL, "pcss", NULL), ARGUMENT);
  assert_int_equal(pn_state_begin(NULL), ARGUMENT);
  assert_int_equal(pn_times(NULL, NULL, 0, 0), 0);
  assert_int_equal(pn_debug_image(NULL, NULL, 0, NULL, NULL), 0);
  assert_int_equal(pn_feature(NULL, 0, NULL, NULL, NULL), 0);
  assert_null(pn_glsl(NULL, "pcss", 330, 0));
  pn_context_destroy(NULL);
  pn_casters_destroy(NULL);
  pn_receiver_destroy(NULL);
  pn_light_destroy(NULL);
  pn_context_abandon(NULL);
}

/* Every id and every result has a name of its own. */
static void test_names(void **state) {
  (void)state;
  for (int i = 0; i < PN_MESSAGE_COUNT; i++) {
    assert_non_null(pn_message_name(i));
    for (int k = 0; k < i; k++) assert_string_not_equal(pn_message_name(i), pn_message_name(k));
  }
  assert_null(pn_message_name(-1));
  assert_null(pn_message_name(PN_MESSAGE_COUNT));
  for (int i = PN_ERROR_NOT_READY; i <= PN_OK; i++) assert_true(strlen(pn_result_name((pn_result)i)) > 0);
  assert_non_null(pn_result_name((pn_result)-1000));
}

/* What a test broke does not break the next one. */
static int afresh(void **state) {
  host *h = *state;
  pn_light_desc desc = host_light_desc();
  pn_receiver_desc receiver_desc = host_receiver_desc(&view, &seen.target);
  desc.map_width = 64;
  return pn_light_set(light, &desc) || pn_light_technique(light, "pcss", NULL, 0) ||
         pn_receiver_set(seen.receiver, &receiver_desc) || pn_maps_update(light, h->casters, PN_GROUPS_ALL, NULL, 0);
}

static int setup(void **state) {
  if (host_setup(state) != 0) return -1;
  host *h = *state;
  view = camera_at(0);
  view.width = view.target_width = WIDTH;
  view.height = view.target_height = HEIGHT;
  pn_light_desc desc = host_light_desc();
  desc.map_width = 64;
  if (host_cast(h, CAST_MEMORY) != PN_OK || host_view(h, &view, &seen) != PN_OK) return -1;
  if (host_light(h, &desc, "pcss", &light) != PN_OK) return -1;
  expected = host_visibility(h, light, &seen);
  color = make_texture(GL_RGBA8, WIDTH, HEIGHT);
  small_color = make_texture(GL_RGBA8, WIDTH / 2, HEIGHT);
  integers = make_texture(GL_RGBA8UI, WIDTH, HEIGHT);
  red_only = make_texture(GL_R8, WIDTH, HEIGHT);
  flat_depth = make_framebuffer(color, 0);
  forward_program =
      renderer_program(pn_glsl(h->context, "pcss", 330, 0),
                       "out vec4 c;\nvoid main() { c = vec4(pn_visibility(0, scene, vec3(0.0, 1.0, 0.0))); }\n");
  if (!expected || dark_pixels(expected, WIDTH, HEIGHT) < 20 || !forward_program) return -1;
  return gl_errors();
}

static int teardown(void **state) {
  free(expected);
  gl.DeleteProgram(forward_program);
  host_view_close(&seen);
  gl.DeleteFramebuffers(1, &flat_depth);
  gl.DeleteTextures(1, &color);
  gl.DeleteTextures(1, &small_color);
  gl.DeleteTextures(1, &integers);
  gl.DeleteTextures(1, &red_only);
  return host_teardown(state);
}

int main(void) {
#define TEST(f) cmocka_unit_test_setup_teardown(f, afresh, host_check)
  const struct CMUnitTest tests[] = {
      TEST(test_meshes),     TEST(test_instances), TEST(test_receivers),     TEST(test_lights),  TEST(test_wide_light),
      TEST(test_techniques), TEST(test_order),     TEST(test_no_result_yet), TEST(test_targets), TEST(test_forward),
      TEST(test_context),    TEST(test_version),   TEST(test_null_objects),  TEST(test_names),
  };
  return cmocka_run_group_tests_name("bad", tests, setup, teardown);
}
