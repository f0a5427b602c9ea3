#include "techniques/ssm/seen.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "maps/range.h"

static pn_result shape(pni_gpu *gpu, pni_seen *seen) {
  const pni_seen_want *w = &seen->want;
  static const pni_range_kind pyramid = {.structure = PNI_RANGE_PYRAMID};
  pn_result result =
      pni_texture_shape(gpu, &seen->layers, "seen surfaces", PNI_RGBA32F, w->width, w->height, w->layers, 1);
  if (result == PN_OK)
    result = pni_texture_shape(gpu, &seen->aside, "seen surfaces, aside", PNI_RGBA32F, w->width, w->height, 0, 1);
  if (result == PN_OK)
    result = pni_texture_shape(gpu, &seen->depth, "seen surfaces, depth", PNI_DEPTH32F, w->width, w->height, 0, 1);
  return result == PN_OK ? pni_range_shape(gpu, &seen->range, &pyramid, w->layers, w->width, w->height) : result;
}

static void set_bounds(pni_gpu *gpu, const pni_seen_want *w) {
  const double *b = w->bounds;
  const float bounds[4] = {(float)b[0], (float)b[1], (float)(w->width / (b[2] - b[0])),
                           (float)(w->height / (b[3] - b[1]))};
  pni_set_floats(gpu, "pn_seen_bounds", bounds);
}

/* The pixels that can show what lies in the map's bounds: x, y, width, height. All of the view where the bounds reach
 * behind the camera, or behind the light. */
static void find_pixels(const pni_job *job, const pni_seen_want *w, int out[4]) {
  const pni_frame *frame = job->frame;
  const pn_receiver *receiver = job->receiver;
  const pn_receiver_desc *view = &receiver->desc;
  pni_matrix light_from_scene = pni_light_from_scene(frame), scene_from_light, pixel_from_scene;
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, size[2] = {view->width, view->height};
  bool sound = pni_matrix_invert(&light_from_scene, &scene_from_light) &&
               pni_matrix_invert(&receiver->scene_from_pixel, &pixel_from_scene) &&
               (frame->projection == PNI_PARALLEL || w->w_least > 0);
  int before = 0;
  for (int i = 0; i < 8 && sound; i++) {
    double m[3] = {w->bounds[i & 1 ? 2 : 0], w->bounds[i & 2 ? 3 : 1], i & 4 ? w->w_most : w->w_least}, q[3],
           p[4] = {0, 0, 0, 1}, h[4];
    pni_light_point(m, frame->projection, q);
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

/* A layer is drawn from those before it, so it is drawn aside. */
static pn_result draw_layer(const pni_job *job, pni_seen *seen, int layer) {
  static const float nothing[4] = {PNI_NOTHING, 0, 0, 0};
  pni_gpu *gpu = job->gpu;
  const pni_seen_want *w = &seen->want;
  char receiver[PNI_RECEIVER_DEFINES], defines[PNI_RECEIVER_DEFINES + 16];
  int pixels[4];
  pni_receiver_defines(job->receiver, receiver);
  snprintf(defines, sizeof defines, "%sPN_PEEL %d\n", receiver, layer > 0);
  pni_pass pass = {.name = "seen surfaces",
                   .program = {"techniques/ssm/seen.vert.glsl", "techniques/ssm/seen.frag.glsl", NULL, defines},
                   .color = {pni_image_of(&seen->aside, 0, 0)},
                   .clear = nothing,
                   .depth = pni_image_of(&seen->depth, 0, 0),
                   .depth_use = PNI_DEPTH_NEAREST,
                   .depth_clamp = true,
                   .points = true,
                   .width = w->width,
                   .height = w->height};
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  pni_receiver_uniforms(job->receiver, job->frame, job->emission, &job->maps->rounding, 1);
  pni_seen_set(gpu, seen);
  pni_set_ints(gpu, "pn_layer", layer - 1, 0, 0, 0);
  const float depth[4] = {(float)w->w_least, (float)w->w_most, (float)w->width, (float)w->height};
  pni_set_floats(gpu, "pn_seen_depth", depth);
  find_pixels(job, w, pixels);
  pni_set_ints(gpu, "pn_pixels", pixels[0], pixels[1], pixels[2], pixels[3]);
  if (pixels[2] > 0 && pixels[3] > 0) pni_draw_points(gpu, pixels[2] * pixels[3]);
  pni_copy_to_layer(gpu, &seen->aside, &seen->layers, layer);
  return PN_OK;
}

static pn_result draw_range(pni_gpu *gpu, pni_seen *seen) {
  const pni_texture *range = &seen->range;
  pn_result result = PN_OK;
  for (int layer = 0; layer < seen->want.layers && result == PN_OK; layer++) {
    pni_pass pass = {.name = "seen surfaces, range",
                     .program = {.fragment = "techniques/ssm/seen_range.frag.glsl"},
                     .color = {pni_image_of(range, 0, layer)},
                     .width = range->width,
                     .height = range->height};
    result = pni_pass_begin(gpu, &pass);
    if (result != PN_OK) break;
    pni_set_ints(gpu, "pn_layer", layer, 0, 0, 0);
    pni_set_texture(gpu, "pn_seen", &seen->layers);
    pni_draw_screen(gpu);
  }
  return result == PN_OK ? pni_range_reduce(gpu, range) : result;
}

pn_result pni_seen_draw(const pni_job *job, const pni_seen_want *want, pni_seen *seen) {
  seen->want = *want;
  pn_result result = shape(job->gpu, seen);
  for (int layer = 0; layer < want->layers && result == PN_OK; layer++) result = draw_layer(job, seen, layer);
  return result == PN_OK ? draw_range(job->gpu, seen) : result;
}

void pni_seen_set(pni_gpu *gpu, const pni_seen *seen) {
  pni_set_texture(gpu, "pn_seen", &seen->layers);
  pni_set_texture(gpu, "pn_seen_range", &seen->range);
  set_bounds(gpu, &seen->want);
}

void pni_seen_free(pni_gpu *gpu, pni_seen *seen, bool abandon) {
  pni_texture *all[] = {&seen->layers, &seen->range, &seen->aside, &seen->depth};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) pni_texture_free(gpu, all[i], abandon);
  memset(seen, 0, sizeof *seen);
}
