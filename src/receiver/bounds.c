/* What a camera sees, as bounds in light map space: reduced on the GPU and read back. */
#include <stdio.h>

#include "receiver/receiver.h"

enum { BLOCK = 16 }; /* PN_BLOCK of bounds.frag.glsl */

/* Least and most, of one step. */
static pn_result shape(pni_gpu *gpu, pni_texture images[2], int width, int height) {
  pn_result result = pni_texture_shape(gpu, &images[0], "receiver bounds, least", PNI_RGBA32F, width, height, 0, 1);
  if (result != PN_OK) return result;
  return pni_texture_shape(gpu, &images[1], "receiver bounds, most", PNI_RGBA32F, width, height, 0, 1);
}

static pn_result step(pn_receiver *receiver, const pni_frame *frame, const pni_texture *from, const pni_texture *to) {
  pni_gpu *gpu = &receiver->object.context->gpu;
  char defines[64];
  snprintf(defines, sizeof defines, "PN_FIRST %d\nPN_MASK %d\n", !from, !from && receiver->desc.mask_texture != 0);
  pni_pass pass = {.name = "receiver bounds",
                   .program = {.fragment = "receiver/bounds.frag.glsl", .defines = defines},
                   .color = {pni_image_of(&to[0], 0, 0), pni_image_of(&to[1], 0, 0)},
                   .width = to->width,
                   .height = to->height};
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  if (from) {
    pni_set_texture(gpu, "pn_least_below", &from[0]);
    pni_set_texture(gpu, "pn_most_below", &from[1]);
  } else {
    pni_receiver_uniforms(receiver, frame, &(pni_rounding){0}, 1); /* positions alone are read */
    pni_set_int(gpu, "pn_parallel", frame->projection == PNI_PARALLEL);
  }
  pni_draw_screen(gpu);
  return PN_OK;
}

static void read_back(pni_gpu *gpu, const pni_texture images[2], pni_region *region) {
  float values[2][4];
  for (int i = 0; i < 2; i++) pni_texture_read(gpu, &images[i], 0, 0, 1, 1, 4, values[i]);
  if (values[0][3] < 0.5f) return; /* nothing is seen */
  for (int i = 0; i < 3; i++) {
    if (values[0][i] < region->least[i]) region->least[i] = values[0][i];
    if (values[1][i] > region->most[i]) region->most[i] = values[1][i];
  }
}

static int blocks(int size) { return (size + BLOCK - 1) / BLOCK; }

pn_result pni_receiver_bounds(pn_receiver *receiver, const pni_frame *frame, pni_region *region) {
  pni_gpu *gpu = &receiver->object.context->gpu;
  pni_texture *from = NULL, *to = receiver->bounds, *other = receiver->bounds + 2;
  int width = receiver->desc.width, height = receiver->desc.height;
  do {
    width = blocks(width);
    height = blocks(height);
    pn_result result = shape(gpu, to, width, height);
    if (result == PN_OK) result = step(receiver, frame, from, to);
    if (result != PN_OK) return result;
    from = to;
    to = other;
    other = from;
  } while (width > 1 || height > 1);
  if (!gpu->plan.on) read_back(gpu, from, region);
  return PN_OK;
}

void pni_receiver_frustum(const pn_receiver *receiver, const pni_frame *frame, pni_region *region) {
  const pn_receiver_desc *d = &receiver->desc;
  pni_region_add_frustum(region, frame, &receiver->scene_from_clip, d->depth_zero_to_one ? 0 : -1);
}
