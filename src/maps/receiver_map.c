#include "maps/receiver_map.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static pn_result layer_program(pni_gpu *gpu, const char *receiver_defines, bool peel, const pni_program **out) {
  char defines[PNI_RECEIVER_DEFINES + 16];
  snprintf(defines, sizeof defines, "%sPN_PEEL %d\n", receiver_defines, peel);
  pni_program_key key = {"maps/receiver_map.vert.glsl", "maps/receiver_map.frag.glsl", NULL, defines};
  return pni_program_get(gpu, &key, out);
}

static pn_result range_program(pni_gpu *gpu, const pni_program **out) {
  pni_program_key key = {"shaders/screen.vert.glsl", "maps/receiver_range.frag.glsl", NULL, ""};
  return pni_program_get(gpu, &key, out);
}

static pn_result shape(pni_gpu *gpu, pni_receiver_map *map) {
  const pni_receiver_map_want *w = &map->want;
  static const pni_range_kind pyramid = {.structure = PNI_RANGE_PYRAMID};
  pn_result result = pni_texture_shape(gpu, &map->layers, GL_RGBA32F, w->width, w->height, w->layers, 1);
  if (result == PN_OK) result = pni_texture_shape(gpu, &map->aside, GL_RGBA32F, w->width, w->height, 0, 1);
  if (result == PN_OK) result = pni_texture_shape(gpu, &map->depth, GL_DEPTH_COMPONENT32F, w->width, w->height, 0, 1);
  return result == PN_OK ? pni_range_shape(gpu, &map->range, &pyramid, w->layers, w->width, w->height) : result;
}

static void set_bounds(pni_gpu *gpu, const pni_receiver_map_want *w, const pni_program *program) {
  const double *b = w->bounds;
  float bounds[4] = {(float)b[0], (float)b[1], (float)(w->width / (b[2] - b[0])), (float)(w->height / (b[3] - b[1]))};
  GL(gpu, Uniform4fv)(pni_uniform(program, "pn_seen_bounds"), 1, bounds);
}

/* The pixels that can show what lies in the map's bounds: x, y, width, height. All of the view where the bounds reach
 * behind the camera, or behind the light. */
static void find_pixels(const pn_receiver *receiver, const pni_frame *frame, const pni_receiver_map_want *w,
                        int out[4]) {
  const pn_receiver_desc *view = &receiver->desc;
  pni_matrix light_from_scene = pni_light_from_scene(frame), scene_from_light, pixel_from_scene;
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, size[2] = {view->width, view->height};
  bool sound = pni_matrix_invert(&light_from_scene, &scene_from_light) &&
               pni_matrix_invert(&receiver->scene_from_pixel, &pixel_from_scene) && (frame->sun || w->w_least > 0);
  int before = 0;
  for (int i = 0; i < 8 && sound; i++) {
    double m[3] = {w->bounds[i & 1 ? 2 : 0], w->bounds[i & 2 ? 3 : 1], i & 4 ? w->w_most : w->w_least}, q[3],
           p[4] = {0, 0, 0, 1}, h[4];
    pni_light_point(m, frame->sun, q);
    pni_matrix_point(&scene_from_light, q, p);
    pni_matrix_apply(&pixel_from_scene, p, h);
    before += h[3] > 0;
    for (int c = 0; c < 2; c++) {
      low[c] = fmin(low[c], h[c] / h[3]);
      high[c] = fmax(high[c], h[c] / h[3]);
    }
  }
  sound = sound && before % 8 == 0 && isfinite(low[0] + low[1] + high[0] + high[1]);
  for (int c = 0; c < 2; c++) {
    double from = sound ? fmin(fmax(floor(low[c]) - 1, 0), size[c]) : 0;
    double to = sound ? fmin(fmax(ceil(high[c]) + 1, 0), size[c]) : size[c];
    out[c] = (int)from;
    out[c + 2] = (int)fmax(to - from, 0);
  }
}

static pn_result draw_layer(pn_receiver *receiver, const pni_frame *frame, pni_receiver_map *map, int layer) {
  pni_gpu *gpu = &receiver->object.context->gpu;
  const pni_receiver_map_want *w = &map->want;
  char defines[PNI_RECEIVER_DEFINES];
  const pni_program *program;
  pni_receiver_defines(receiver, defines);
  pn_result result = layer_program(gpu, defines, layer > 0, &program);
  if (result != PN_OK) return result;
  pni_pass pass = {.color = {{map->aside.id, map->aside.target, 0, 0}},
                   .depth = {map->depth.id, map->depth.target, 0, 0},
                   .depth_use = PNI_DEPTH_NEAREST,
                   .depth_clamp = true,
                   .width = w->width,
                   .height = w->height};
  result = pni_screen_begin(gpu, &pass, program);
  if (result != PN_OK) return result;
  static const GLfloat nothing[4] = {-1e30f, 0, 0, 0}; /* PN_NOTHING */
  GL(gpu, ClearBufferfv)(GL_COLOR, 0, nothing);
  GL(gpu, Enable)(GL_PROGRAM_POINT_SIZE);
  pni_receiver_bind(receiver, program, frame, 1);
  pni_receiver_map_bind(gpu, map, program);
  GLint before[4] = {layer - 1, 0, 0, 0};
  float depth[4] = {(float)w->w_least, (float)w->w_most, (float)w->width, (float)w->height};
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_layer"), 1, before);
  GL(gpu, Uniform4fv)(pni_uniform(program, "pn_seen_depth"), 1, depth);
  GLint pixels[4];
  find_pixels(receiver, frame, w, pixels);
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_pixels"), 1, pixels);
  GL(gpu, BindVertexArray)(gpu->vertex_array);
  if (pixels[2] > 0 && pixels[3] > 0) GL(gpu, DrawArrays)(GL_POINTS, 0, pixels[2] * pixels[3]);
  pni_copy_to_layer(gpu, &map->aside, &map->layers, layer);
  return PN_OK;
}

static pn_result draw_range(pni_gpu *gpu, pni_receiver_map *map) {
  const pni_program *program;
  const pni_texture *range = &map->range;
  pn_result result = range_program(gpu, &program);
  for (int layer = 0; layer < map->want.layers && result == PN_OK; layer++) {
    pni_pass pass = {.color = {{range->id, range->target, 0, layer}}, .width = range->width, .height = range->height};
    result = pni_screen_begin(gpu, &pass, program);
    if (result != PN_OK) break;
    GLint source[4] = {layer, 0, 0, 0};
    GL(gpu, Uniform4iv)(pni_uniform(program, "pn_layer"), 1, source);
    pni_bind_texture(gpu, PNI_UNIT_SEEN, map->layers.target, map->layers.id, false);
    pni_draw_screen(gpu);
  }
  return result == PN_OK ? pni_range_reduce(gpu, range) : result;
}

pn_result pni_receiver_map_draw(pn_receiver *receiver, const pni_frame *frame, const pni_receiver_map_want *want,
                                pni_receiver_map *map) {
  pni_gpu *gpu = &receiver->object.context->gpu;
  map->want = *want;
  pn_result result = shape(gpu, map);
  for (int layer = 0; layer < want->layers && result == PN_OK; layer++)
    result = draw_layer(receiver, frame, map, layer);
  return result == PN_OK ? draw_range(gpu, map) : result;
}

void pni_receiver_map_bind(pni_gpu *gpu, const pni_receiver_map *map, const pni_program *program) {
  pni_bind_texture(gpu, PNI_UNIT_SEEN, map->layers.target, map->layers.id, false);
  pni_bind_texture(gpu, PNI_UNIT_SEEN_RANGE, map->range.target, map->range.id, true);
  set_bounds(gpu, &map->want, program);
}

pn_result pni_receiver_map_prepare(pni_gpu *gpu, int layers) {
  static const char *const receivers[] = {"PN_NORMALS 0\nPN_MASK 0\n", "PN_NORMALS 1\nPN_MASK 0\n"};
  const pni_program *program;
  pn_result result = range_program(gpu, &program);
  for (int i = 0; i < 4 && result == PN_OK; i++)
    if (i < 2 || layers > 1) result = layer_program(gpu, receivers[i & 1], i > 1, &program);
  return result;
}

void pni_receiver_map_free(pni_gpu *gpu, pni_receiver_map *map, bool abandon) {
  pni_texture *all[] = {&map->layers, &map->range, &map->aside, &map->depth};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) pni_texture_free(gpu, all[i], abandon);
  memset(map, 0, sizeof *map);
}
