#include "maps/maps.h"

#include <math.h>
#include <string.h>

#include "maps/range.h"

/* ---- textures ---------------------------------------------------------------------------------------------------- */

static void free_textures(pni_gpu *gpu, pni_maps *maps, bool abandon) {
  pni_texture *all[] = {&maps->depth, &maps->range, &maps->peel[0], &maps->peel[1], &maps->aside};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) pni_texture_free(gpu, all[i], abandon);
}

/* What another technique wanted is not kept. */
pn_result pni_maps_shape(pni_gpu *gpu, pni_maps *maps, const pni_maps_want *want, int count, int width, int height) {
  int layers = pni_want_layers(want);
  if (want->range.structure != PNI_RANGE_STACK) pni_texture_spare(gpu, &maps->aside);
  if (layers == 0) {
    if (!gpu->plan.on) free_textures(gpu, maps, false);
    maps->want = *want;
    return PN_OK;
  }
  pn_result result =
      pni_texture_shape(gpu, &maps->depth, "light depth maps", PNI_DEPTH32F, width, height, layers * count, 1);
  for (int i = 0; i < 2 && result == PN_OK; i++) {
    if (want->near_layers > 1)
      result = pni_texture_shape(gpu, &maps->peel[i], "peeled layer", PNI_DEPTH32F, width, height, 0, 1);
    else pni_texture_spare(gpu, &maps->peel[i]);
  }
  if (result == PN_OK) result = pni_range_shape(gpu, &maps->range, &want->range, layers * count, width, height);
  if (result == PN_OK) maps->want = *want;
  return result;
}

void pni_maps_free(pni_gpu *gpu, pni_maps *maps, bool abandon) {
  free_textures(gpu, maps, abandon);
  memset(maps, 0, sizeof *maps);
}

/* ---- the uniform block ------------------------------------------------------------------------------------------- */

static void axis_row(const pni_matrix *light_from_scene, int row, float out[4]) {
  for (int c = 0; c < 4; c++) out[c] = (float)light_from_scene->m[4 * c + row];
}

/* Vertices are snapped to the raster's sub-pixels, half a step at most on each axis; twice that for the arithmetic
 * around it. */
static float raster_error(const pni_gpu *gpu) { return (float)ldexp(1.0, -gpu->can.subpixel_bits); }

void pni_maps_describe(pni_gpu *gpu, pni_maps *maps, const pni_frame *frame, const pni_emission *emission) {
  if (gpu->plan.on) return;
  pni_light_block *b = &maps->block;
  memset(b, 0, sizeof *b);
  pni_matrix light_from_scene = pni_light_from_scene(frame);
  axis_row(&light_from_scene, 0, b->scene_u);
  axis_row(&light_from_scene, 1, b->scene_v);
  axis_row(&light_from_scene, 2, b->scene_z);
  for (int i = 0; i < 3; i++) b->scene_error[i] = (float)(maps->rounding.map[i] + maps->rounding.host);
  b->scene_error[3] = (float)maps->rounding.map_per_z;
  for (int i = 0; i < 2; i++) b->extent[i] = (float)emission->extent[i];
  b->parallel = frame->projection == PNI_PARALLEL ? 1.0f : 0.0f;
  b->w_reach = (float)maps->fit.w_reach;
  b->w_near = -INFINITY;
  b->w_far = INFINITY;
  b->raster_error = raster_error(gpu);
}

static void place_map(pni_gpu *gpu, pni_light_block *b, const pni_map_draw *draw, pni_map_block *map) {
  for (int i = 0; i < 2; i++) {
    double low = draw->bounds[i], high = draw->bounds[i + 2];
    map->origin[i] = (float)low;
    map->density[i] = (float)((int)map->size[i] / (high - low));
    map->light_point[i] = (float)draw->shear[i];
    /* bounds and positions in float, far from the origin of the map */
    double steps = map->size[i] * fmax(fabs(low), fabs(high)) / (high - low);
    b->raster_error = fmaxf(b->raster_error, raster_error(gpu) + (float)(steps * 0x1p-22));
    b->texel[i] = fmaxf(b->texel[i], 1.0f / map->density[i]);
  }
}

/* A stored depth near 1 has steps of 2^-24; interpolation adds a few. Turning it into w rounds at the size of w. */
static void add_depth(pni_light_block *b, const pni_map_draw *draw, pni_map_block *map) {
  double scale[2], near = draw->w_near, far = draw->w_far;
  pni_depth_scale(near, far, scale);
  map->w_of_depth[0] = (float)scale[0];
  map->w_of_depth[1] = (float)scale[1];
  b->w_near = fmaxf(b->w_near, (float)near);
  b->w_far = fminf(b->w_far, (float)far);
  b->w_error = fmaxf(b->w_error, (float)((near - far) * 0x1p-21 + fmax(fabs(near), fabs(far)) * 0x1p-22));
}

static void add_block(pni_gpu *gpu, pni_maps *maps, const pni_map_draw *draw) {
  pni_light_block *b = &maps->block;
  int layers = pni_want_layers(&maps->want), index = (int)b->map_count;
  pni_map_block *map = &b->maps[index];
  map->size[0] = (float)maps->depth.width;
  map->size[1] = (float)maps->depth.height;
  map->first_layer = (float)(index * layers);
  map->layers = b->layers = (float)layers;
  place_map(gpu, b, draw, map);
  add_depth(b, draw, map);
  b->map_count += 1;
}

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

typedef struct {
  pni_gpu *gpu;
  const pni_maps *maps;
  const pni_map_draw *draw;
  int first_layer;                             /* of the map */
  pni_matrix clip_from_scene, cull_from_scene; /* the second: of what later layers hold */
  float floor[4];
} drawing;

static pni_image layer_of(const drawing *d, int layer) {
  return pni_image_of(&d->maps->depth, 0, d->first_layer + layer);
}

/* Layers past the first are drawn with the same matrix as the first, so that the same fragment has the same place and
 * depth in each; a smaller frustum is a part of the image. */
static pn_result draw_layer(const drawing *d, pni_image target, int layer, bool farthest, const pni_texture *peel) {
  const pni_maps_want *want = &d->maps->want;
  const pni_part *later = layer > 0 && want->focus > 0 ? &d->draw->later : NULL;
  pni_pass pass = {.name = farthest ? "depth map, farthest" : "depth map",
                   .depth = target,
                   .width = d->maps->depth.width,
                   .height = d->maps->depth.height,
                   .part = later,
                   .faces = farthest ? want->far_faces : want->near_faces,
                   .depth_clamp = true,
                   .depth_use = farthest ? PNI_DEPTH_FARTHEST : PNI_DEPTH_NEAREST,
                   .depth_range = {PNI_DEPTH_MARGIN, 1 - PNI_DEPTH_MARGIN}};
  pn_result result = pni_pass_begin(d->gpu, &pass);
  if (result != PN_OK) return result;
  if (later && (later->width == 0 || later->height == 0)) return PN_OK;
  pni_caster_draw draw = {.pass = &pass,
                          .clip_from_scene = d->clip_from_scene,
                          .cull_from_scene = later ? d->cull_from_scene : d->clip_from_scene,
                          .groups = d->draw->groups,
                          .range = d->draw->range,
                          .without_host = d->draw->without_host,
                          .floor = d->draw->floor ? d->floor : NULL,
                          .peel = peel,
                          .layer = layer};
  pni_matrix light_from_scene = pni_light_from_scene(d->draw->frame);
  for (int c = 0; c < 4; c++) draw.distance[c] = light_from_scene.m[4 * c + 2];
  return pni_casters_draw_pass(d->draw->casters, &draw);
}

/* Peeling draws into textures of its own and copies: reading one layer of an array while drawing another is undefined
 * in GL 3.3. */
static pn_result draw_peeled(const drawing *d) {
  const pni_texture *previous = NULL;
  for (int layer = 0; layer < d->maps->want.near_layers; layer++) {
    const pni_texture *target = &d->maps->peel[layer & 1];
    pn_result result = draw_layer(d, pni_image_of(target, 0, 0), layer, false, previous);
    if (result != PN_OK) return result;
    pni_copy_to_layer(d->gpu, target, &d->maps->depth, d->first_layer + layer);
    previous = target;
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

static pn_result draw_layers(const drawing *d) {
  int near_layers = d->maps->want.near_layers;
  pn_result result = PN_OK;
  if (near_layers == 1) result = draw_layer(d, layer_of(d, 0), 0, false, NULL);
  if (near_layers > 1) result = draw_peeled(d);
  if (result == PN_OK && d->maps->want.farthest)
    result = draw_layer(d, layer_of(d, near_layers), near_layers, true, NULL);
  return result;
}

/* What its layers need, in the layers of the first map: nothing is drawn. */
static pn_result plan_layers(pni_gpu *gpu, const pni_maps *maps, const pni_map_draw *draw) {
  return draw_layers(&(drawing){.gpu = gpu, .maps = maps, .draw = draw});
}

/* The floor as depth over window coordinates, (x, y, 1): raised by what a caster in it may be off. In a sheared map s =
 * s' + x_L w, so that w (1 - a x_L - b y_L) = a s' + b t' + c. */
static void place_floor(const pni_light_block *b, const pni_map_block *map, const pni_map_draw *draw, float out[4]) {
  const double *f = draw->floor;
  double upright = 1 - f[0] * draw->shear[0] - f[1] * draw->shear[1];
  double w = f[2] + b->w_error, per_depth = map->w_of_depth[1];
  for (int i = 0; i < 2; i++) {
    w += f[i] * draw->bounds[i] + fabs(f[i]) * b->raster_error / map->density[i];
    out[i] = (float)(f[i] / map->density[i] / upright / per_depth);
  }
  out[2] = (float)((w / upright - map->w_of_depth[0]) / per_depth);
}

pn_result pni_maps_add(pni_gpu *gpu, pni_maps *maps, const pni_map_draw *draw) {
  if (gpu->plan.on) return plan_layers(gpu, maps, draw);
  int index = (int)maps->block.map_count;
  drawing d = {gpu, maps, draw, index * pni_want_layers(&maps->want), {{0}}, {{0}}, {0}};
  pni_matrix clip = pni_clip_from_light(draw->frame->projection, draw->bounds, draw->w_near, draw->w_far, draw->shear);
  pni_matrix light = pni_light_from_scene(draw->frame);
  d.clip_from_scene = pni_matrix_multiply(&clip, &light);
  d.cull_from_scene = clip_part(&d.clip_from_scene, &draw->later, maps->depth.width, maps->depth.height);
  maps->later[index] = draw->later;
  add_block(gpu, maps, draw);
  if (draw->floor) place_floor(&maps->block, &maps->block.maps[index], draw, d.floor);
  return draw_layers(&d);
}
