#include "maps/maps.h"

#include <math.h>
#include <string.h>

int pni_want_layers(const pni_maps_want *want) { return want->near_layers + (want->farthest ? 1 : 0); }

/* ---- textures ---------------------------------------------------------------------------------------------------- */

pn_result pni_maps_shape(pni_gpu *gpu, pni_maps *maps, const pni_maps_want *want, int count, int width, int height) {
  int layers = pni_want_layers(want);
  pn_result result = pni_texture_shape(gpu, &maps->depth, GL_DEPTH_COMPONENT32F, width, height, layers * count, 1);
  for (int i = 0; i < 2 && result == PN_OK; i++) {
    if (want->near_layers > 1)
      result = pni_texture_shape(gpu, &maps->peel[i], GL_DEPTH_COMPONENT32F, width, height, 0, 1);
    else pni_texture_free(gpu, &maps->peel[i], false);
  }
  if (result == PN_OK) result = pni_range_shape(gpu, &maps->range, &want->range, layers * count, width, height);
  if (result != PN_OK) return result;
  maps->want = *want;
  maps->layers = layers;
  return PN_OK;
}

void pni_maps_free(pni_gpu *gpu, pni_maps *maps, bool abandon) {
  pni_texture_free(gpu, &maps->depth, abandon);
  pni_texture_free(gpu, &maps->range, abandon);
  pni_texture_free(gpu, &maps->peel[0], abandon);
  pni_texture_free(gpu, &maps->peel[1], abandon);
  pni_texture_free(gpu, &maps->aside, abandon);
  memset(maps, 0, sizeof *maps);
}

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

typedef struct {
  pni_gpu *gpu;
  pni_maps *maps;
  const pni_map_draw *draw;
  pni_matrix clip_from_scene, cull_from_scene; /* the second: of what later layers hold */
} drawing;

static pni_attachment layer_of(const drawing *d, int layer) {
  const pni_texture *depth = &d->maps->depth;
  return (pni_attachment){depth->id, depth->target, 0, d->draw->map * d->maps->layers + layer};
}

/* Layers past the first are drawn with the same matrix as the first, so that the same fragment has the same place and
 * depth in each; a smaller frustum is a part of the image. */
static pn_result draw_layer(const drawing *d, pni_attachment target, int layer, bool farthest, pn_gl peel) {
  const pni_maps_want *want = &d->maps->want;
  const pni_part *later = layer > 0 && want->focus > 0 ? &d->draw->later : NULL;
  int width = d->maps->depth.width, height = d->maps->depth.height;
  pn_faces faces = farthest ? want->far_faces : want->near_faces;
  pni_pass pass = {.depth = target,
                   .width = width,
                   .height = height,
                   .faces = faces,
                   .depth_clamp = true,
                   .depth_use = farthest ? PNI_DEPTH_FARTHEST : PNI_DEPTH_NEAREST,
                   .depth_range = {PNI_DEPTH_MARGIN, 1 - PNI_DEPTH_MARGIN}};
  pn_result result = pni_pass_begin(d->gpu, &pass);
  if (result != PN_OK) return result;
  if (later && (later->width == 0 || later->height == 0)) return PN_OK;
  if (later) pni_pass_limit(d->gpu, later);
  pni_caster_draw draw = {.clip_from_scene = d->clip_from_scene,
                          .cull_from_scene = later ? d->cull_from_scene : d->clip_from_scene,
                          .groups = d->draw->groups,
                          .faces = faces ? faces : PN_FACES_ANY,
                          .peel = peel,
                          .layer = layer,
                          .width = width,
                          .height = height};
  return pni_casters_draw_pass(d->draw->casters, &draw);
}

/* Peeling draws into textures of its own and copies: reading one layer of an array while drawing another is undefined
 * in GL 3.3. */
static void copy_layer(const drawing *d, const pni_texture *from, int layer) {
  pni_gpu *gpu = d->gpu;
  pni_attachment to = layer_of(d, layer);
  GL(gpu, BindFramebuffer)(GL_READ_FRAMEBUFFER, gpu->read_framebuffer);
  GL(gpu, FramebufferTexture2D)(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, 0, 0);
  GL(gpu, FramebufferTexture2D)(GL_READ_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, from->id, 0);
  GL(gpu, ReadBuffer)(GL_NONE);
  GL(gpu, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, gpu->framebuffer);
  GL(gpu, FramebufferTextureLayer)(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, to.texture, 0, to.layer);
  pni_set_switch(gpu, GL_SCISSOR_TEST, false);
  GL(gpu, BlitFramebuffer)
  (0, 0, from->width, from->height, 0, 0, from->width, from->height, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
}

static pn_result draw_peeled(const drawing *d) {
  pn_gl previous = 0;
  for (int layer = 0; layer < d->maps->want.near_layers; layer++) {
    const pni_texture *target = &d->maps->peel[layer & 1];
    pni_attachment attachment = {target->id, target->target, 0, 0};
    pn_result result = draw_layer(d, attachment, layer, false, previous);
    if (result != PN_OK) return result;
    copy_layer(d, target, layer);
    previous = target->id;
  }
  return PN_OK;
}

/* The frustum of a part of the map, a texel wider than it: what float arithmetic moves across its edge is drawn. */
static pni_matrix clip_part(const pni_matrix *clip, const pni_part *part, int width, int height) {
  const int first[2] = {part->x, part->y}, count[2] = {part->width, part->height}, size[2] = {width, height};
  pni_matrix narrow = pni_matrix_identity();
  for (int i = 0; i < 2; i++) {
    double scale = size[i] / (count[i] + 2.0), middle = (2.0 * first[i] + count[i]) / size[i] - 1;
    narrow.m[5 * i] = scale;
    narrow.m[12 + i] = -scale * middle;
  }
  return pni_matrix_multiply(&narrow, clip);
}

pn_result pni_maps_draw(pni_gpu *gpu, pni_maps *maps, const pni_map_draw *draw) {
  drawing d = {gpu, maps, draw, {{0}}, {{0}}};
  pni_matrix clip = pni_clip_from_light(draw->frame->sun, draw->bounds, draw->w_near, draw->w_far, draw->shear);
  pni_matrix light = pni_light_from_scene(draw->frame);
  d.clip_from_scene = pni_matrix_multiply(&clip, &light);
  d.cull_from_scene = clip_part(&d.clip_from_scene, &draw->later, maps->depth.width, maps->depth.height);
  maps->later[draw->map] = draw->later;
  pn_result result = PN_OK;
  if (maps->want.near_layers == 1) result = draw_layer(&d, layer_of(&d, 0), 0, false, 0);
  if (maps->want.near_layers > 1) result = draw_peeled(&d);
  if (result == PN_OK && maps->want.farthest)
    result = draw_layer(&d, layer_of(&d, maps->layers - 1), maps->layers - 1, true, 0);
  return result;
}

pn_result pni_maps_prepare(pni_gpu *gpu, const pni_maps_want *want) {
  pn_result result = pni_casters_prepare(gpu, false);
  if (result == PN_OK && want->near_layers > 1) result = pni_casters_prepare(gpu, true);
  return result == PN_OK ? pni_range_prepare(gpu, &want->range) : result;
}

/* ---- the uniform block ------------------------------------------------------------------------------------------- */

static void axis_row(const pni_matrix *light_from_scene, int row, float out[4]) {
  for (int c = 0; c < 4; c++) out[c] = (float)light_from_scene->m[4 * c + row];
}

/* Vertices are snapped to the raster's sub-pixels, half a step at most on each axis; twice that for the arithmetic
 * around it. */
static float raster_error(const pni_gpu *gpu) { return (float)ldexp(1.0, -gpu->can.subpixel_bits); }

void pni_block_frame(pni_light_block *block, const pni_frame *frame, const pni_gpu *gpu, int count, int layers,
                     int width, int height) {
  memset(block, 0, sizeof *block);
  pni_matrix light_from_scene = pni_light_from_scene(frame);
  axis_row(&light_from_scene, 0, block->scene_u);
  axis_row(&light_from_scene, 1, block->scene_v);
  axis_row(&light_from_scene, 2, block->scene_z);
  block->extent[0] = (float)frame->extent[0];
  block->extent[1] = (float)frame->extent[1];
  block->extent[2] = frame->sun ? 1.0f : 0.0f;
  block->maps[0] = (float)count;
  block->maps[1] = (float)layers;
  block->maps[2] = (float)width;
  block->maps[3] = (float)height;
  block->range[0] = -INFINITY;
  block->range[1] = INFINITY;
  block->range[3] = raster_error(gpu);
}

void pni_block_map(pni_light_block *block, const pni_gpu *gpu, const pni_map_draw *draw, int width, int height) {
  float base_error = raster_error(gpu);
  double scale[2];
  pni_depth_scale(draw->w_near, draw->w_far, scale);
  float *bounds = block->map_bounds[draw->map], *depth = block->map_depth[draw->map];
  bounds[0] = (float)draw->bounds[0];
  bounds[1] = (float)draw->bounds[1];
  bounds[2] = (float)(width / (draw->bounds[2] - draw->bounds[0]));
  bounds[3] = (float)(height / (draw->bounds[3] - draw->bounds[1]));
  depth[0] = (float)scale[0];
  depth[1] = (float)scale[1];
  depth[2] = (float)draw->shear[0];
  depth[3] = (float)draw->shear[1];
  for (int i = 0; i < 2; i++) { /* bounds and positions in float, far from the origin of the map */
    double low = draw->bounds[i], high = draw->bounds[i + 2];
    double steps = (i ? height : width) * fmax(fabs(low), fabs(high)) / (high - low);
    block->range[3] = fmaxf(block->range[3], base_error + (float)(steps * 0x1p-22));
  }
  block->range[0] = fmaxf(block->range[0], (float)draw->w_near);
  block->range[1] = fminf(block->range[1], (float)draw->w_far);
  /* A stored depth near 1 has steps of 2^-24; interpolation adds a few. Turning it into w rounds at the size of w. */
  float error = (float)((draw->w_near - draw->w_far) * 0x1p-21 + fmax(fabs(draw->w_near), fabs(draw->w_far)) * 0x1p-22);
  block->range[2] = fmaxf(block->range[2], error);
}

_Static_assert(sizeof(pni_light_block) == (6 + 3 + 2 * PNI_MAPS_MAX) * 16, "std140 layout of pn_LightData");
