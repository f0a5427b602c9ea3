/* What a camera sees, as bounds in light map space: reduced on the GPU and read back. */
#include "receiver/receiver.h"

enum { BLOCK = 16 }; /* PN_BLOCK of bounds.frag.glsl */

/* Least and most, of one step. */
static pn_result shape(pni_gpu *gpu, pni_texture images[2], int width, int height) {
  pn_result result = pni_texture_shape(gpu, &images[0], GL_RGBA32F, width, height, 0, 1);
  return result == PN_OK ? pni_texture_shape(gpu, &images[1], GL_RGBA32F, width, height, 0, 1) : result;
}

static pn_result step(pn_receiver *receiver, const pni_frame *frame, const pni_texture *from, const pni_texture *to) {
  pni_gpu *gpu = &receiver->object.context->gpu;
  const char *defines = from                          ? "PN_FIRST 0\n"
                        : receiver->desc.mask_texture ? "PN_FIRST 1\nPN_MASK 1\n"
                                                      : "PN_FIRST 1\nPN_MASK 0\n";
  pni_program_key key = {"shaders/screen.vert.glsl", "receiver/bounds.frag.glsl", NULL, defines};
  const pni_program *program;
  pn_result result = pni_program_get(gpu, &key, &program);
  if (result != PN_OK) return result;
  pni_pass pass = {.color = {{to[0].id, GL_TEXTURE_2D, 0, 0}, {to[1].id, GL_TEXTURE_2D, 0, 0}},
                   .width = to->width,
                   .height = to->height};
  result = pni_screen_begin(gpu, &pass, program);
  if (result != PN_OK) return result;
  if (from) {
    pni_bind_texture(gpu, PNI_UNIT_WORK, GL_TEXTURE_2D, from[0].id, false);
    pni_bind_texture(gpu, PNI_UNIT_RANGE, GL_TEXTURE_2D, from[1].id, false);
  } else {
    pni_receiver_bind(receiver, program, frame, 1);
    GL(gpu, Uniform1i)(pni_uniform(program, "pn_sun"), frame->sun);
  }
  pni_draw_screen(gpu);
  return PN_OK;
}

static void read_back(pni_gpu *gpu, const pni_texture images[2], pni_region *region) {
  float values[2][4];
  GL(gpu, BindBuffer)(GL_PIXEL_PACK_BUFFER, 0);
  for (int i = 0; i < 2; i++) {
    pni_read_from(gpu, &images[i], 0, 0);
    GL(gpu, ReadPixels)(0, 0, 1, 1, GL_RGBA, GL_FLOAT, values[i]);
  }
  GL(gpu, FramebufferTexture2D)(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, 0, 0);
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
  read_back(gpu, from, region);
  return PN_OK;
}

void pni_receiver_frustum(const pn_receiver *receiver, const pni_frame *frame, pni_region *region) {
  const pn_receiver_desc *d = &receiver->desc;
  pni_region_add_frustum(region, frame, &receiver->scene_from_clip, d->depth_zero_to_one ? 0 : -1);
}
