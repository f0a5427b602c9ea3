/* What a camera sees, in light map space: bounds of all of it, or patches; reduced on the GPU and read back. */
#include <stdio.h>

#include "gl/host.h"
#include "receiver/patches.h"

enum { BLOCK = 16 }; /* PN_BLOCK of bounds.frag.glsl, slopes.frag.glsl, patches.frag.glsl */

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
    pni_receiver_uniforms(receiver, frame, NULL, &(pni_rounding){0}, 1);
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

/* ---- patches ----------------------------------------------------------------------------------------------------- */

/* Planes steeper than the light's window are never a bound; close to that they would be one far off only. */
static const float steepest = 0.9f;

enum { TRIED = 5 }; /* PN_TRIED of slopes.frag.glsl */

/* A pass that looks at the view's pixels, to draw into an image. */
static pn_result begin_pass(pn_receiver *receiver, const pni_frame *frame, const char *name,
                            const pni_program_key *program, const pni_texture *to) {
  pni_gpu *gpu = &receiver->object.context->gpu;
  pni_pass pass = {
      .name = name, .program = *program, .color = {pni_image_of(to, 0, 0)}, .width = to->width, .height = to->height};
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  pni_receiver_uniforms(receiver, frame, NULL, &(pni_rounding){0}, 1); /* what casters lose is the map's to add */
  pni_set_int(gpu, "pn_parallel", frame->projection == PNI_PARALLEL);
  return PN_OK;
}

/* Slopes to try for each block. */
static pn_result find_slopes(pn_receiver *receiver, const pni_frame *frame, const double extent[2]) {
  pni_gpu *gpu = &receiver->object.context->gpu;
  pni_texture *to = &receiver->slopes;
  pn_result result = pni_texture_shape(gpu, to, "receiver slopes", PNI_RG32F, TRIED * blocks(receiver->desc.width),
                                       blocks(receiver->desc.height), 0, 1);
  char defines[32];
  snprintf(defines, sizeof defines, "PN_MASK %d\n", receiver->desc.mask_texture != 0);
  pni_program_key program = {.fragment = "receiver/slopes.frag.glsl", .defines = defines};
  if (result == PN_OK) result = begin_pass(receiver, frame, "receiver slopes", &program, to);
  if (result != PN_OK) return result;
  pni_set_floats(gpu, "pn_window", (const float[4]){(float)extent[0], (float)extent[1], steepest});
  pni_draw_screen(gpu);
  return PN_OK;
}

/* given: slopes of all planes; NULL: those of find_slopes are tried. */
static pn_result find_planes(pn_receiver *receiver, const pni_frame *frame, const double *given) {
  pni_gpu *gpu = &receiver->object.context->gpu;
  const pni_texture *bounds = receiver->bounds;
  pni_texture *to = &receiver->below;
  pn_result result =
      pni_texture_shape(gpu, to, "receiver planes below", PNI_RGBA32F, bounds->width, bounds->height, 0, 1);
  char defines[64];
  snprintf(defines, sizeof defines, "PN_MASK %d\nPN_GIVEN %d\n", receiver->desc.mask_texture != 0, given != NULL);
  pni_program_key program = {.fragment = "receiver/patches.frag.glsl", .defines = defines};
  if (result == PN_OK) result = begin_pass(receiver, frame, "receiver planes below", &program, to);
  if (result != PN_OK) return result;
  if (given) pni_set_floats(gpu, "pn_given", (const float[4]){(float)given[0], (float)given[1]});
  else pni_set_texture(gpu, "pn_tried", &receiver->slopes);
  pni_set_texture(gpu, "pn_least", &bounds[0]);
  pni_set_texture(gpu, "pn_most", &bounds[1]);
  pni_draw_screen(gpu);
  return PN_OK;
}

static void add_patch(pni_patch_list *list, const float *least, const float *most, const float *plane) {
  if (least[3] < 0.5f) return; /* nothing is seen */
  pni_patch *p = &list->patches[list->count++];
  for (int i = 0; i < 3; i++) {
    p->least[i] = least[i];
    p->most[i] = most[i];
  }
  p->offset = plane[2];
  p->error = plane[3];
  for (int i = 0; i < 2; i++) {
    p->slope[i] = plane[i];
    p->offset -= p->slope[i] * (0.5f * (least[i] + most[i]));
  }
}

static bool make_room(pni_gpu *gpu, pni_patch_list *list, int more) {
  if (list->capacity - list->count >= more) return true;
  pni_patch *grown = pni_reallocate(gpu, list->patches, (size_t)(list->count + more) * sizeof *grown);
  if (!grown) return false;
  list->patches = grown;
  list->capacity = list->count + more;
  return true;
}

static pn_result read_patches(pn_receiver *receiver, pni_patch_list *list) {
  pni_gpu *gpu = &receiver->object.context->gpu;
  const pni_texture *images[] = {&receiver->bounds[0], &receiver->bounds[1], &receiver->below};
  int width = images[0]->width, height = images[0]->height;
  size_t texels = (size_t)width * (size_t)height;
  float *values = pni_reallocate(gpu, NULL, 3 * texels * 4 * sizeof *values);
  bool made = values && make_room(gpu, list, width * height);
  for (int i = 0; i < 3 && made; i++)
    pni_texture_read(gpu, images[i], 0, 0, width, height, 4, values + (size_t)i * texels * 4);
  for (size_t i = 0; i < texels && made; i++)
    add_patch(list, values + 4 * i, values + 4 * (texels + i), values + 4 * (2 * texels + i));
  pni_free(gpu, values);
  return made ? PN_OK : PN_ERROR_OUT_OF_MEMORY;
}

pn_result pni_receiver_patches(pn_receiver *receiver, const pni_frame *frame, const pni_emission *emission,
                               pni_patch_list *list) {
  pni_gpu *gpu = &receiver->object.context->gpu;
  pni_texture *images = receiver->bounds;
  pn_result result = shape(gpu, images, blocks(receiver->desc.width), blocks(receiver->desc.height));
  if (result == PN_OK) result = step(receiver, frame, NULL, images);
  if (result == PN_OK) result = find_slopes(receiver, frame, emission->extent);
  if (result == PN_OK) result = find_planes(receiver, frame, NULL);
  return result == PN_OK ? read_patches(receiver, list) : result;
}

pn_result pni_receiver_offset(pn_receiver *receiver, const pni_frame *frame, const double slope[2], double *offset) {
  pni_gpu *gpu = &receiver->object.context->gpu;
  pni_patch_list list = {0};
  double rounded[2] = {(float)slope[0], (float)slope[1]};
  pn_result result = find_planes(receiver, frame, rounded);
  if (result == PN_OK) result = read_patches(receiver, &list);
  for (int i = 0; i < list.count; i++)
    if (list.patches[i].offset < *offset) *offset = list.patches[i].offset;
  pni_patches_free(gpu, &list);
  return result;
}

void pni_patches_free(pni_gpu *gpu, pni_patch_list *list) {
  pni_free(gpu, list->patches);
  *list = (pni_patch_list){0};
}

/* ---- the frustum ------------------------------------------------------------------------------------------------- */

void pni_receiver_frustum(const pn_receiver *receiver, const pni_frame *frame, pni_region *region) {
  const pn_receiver_desc *d = &receiver->desc;
  pni_region_add_frustum(region, frame, &receiver->scene_from_clip, d->depth_zero_to_one ? 0 : -1);
}
