/* Largest and smallest w of neighbourhoods of every layer: the range pyramid and the range stack. */
#include "maps/maps.h"

#include <stdio.h>

/* ---- shapes ------------------------------------------------------------------------------------------------------ */

static int power_above(int size) {
  int power = 1;
  while (power < size) power *= 2;
  return power;
}

static int level_count(int size) {
  int count = 1;
  for (; size > 1; size /= 2) count++;
  return count;
}

static int larger(int a, int b) { return a > b ? a : b; }

/* The pyramid's first level has a texel for each of the map's, padded to powers of two; the stack has every level at
 * full size, as array layers. */
pn_result pni_range_shape(pni_gpu *gpu, pni_texture *texture, const pni_range_kind *kind, int layers, int width,
                          int height) {
  if (kind->structure == PNI_RANGE_PYRAMID) {
    int w = power_above(width), h = power_above(height);
    GLenum format = kind->least_there ? GL_RGBA32F : GL_RG32F;
    return pni_texture_shape(gpu, texture, format, w, h, layers, level_count(larger(w, h)));
  }
  if (kind->structure == PNI_RANGE_STACK)
    return pni_texture_shape(gpu, texture, GL_RG32F, width, height,
                             layers * level_count(power_above(larger(width, height))), 1);
  if (kind->structure != PNI_RANGE_OWN) pni_texture_free(gpu, texture, false);
  return PN_OK;
}

static pn_result range_program(pni_gpu *gpu, const pni_range_kind *kind, bool first, const pni_program **out) {
  char defines[64];
  snprintf(defines, sizeof defines, "PN_FIRST %d\nPN_STACK %d\nPN_QUADS %d\n", first,
           kind->structure == PNI_RANGE_STACK, kind->quads);
  pni_program_key key = {"shaders/screen.vert.glsl", "maps/range.frag.glsl", NULL, defines};
  return pni_program_get(gpu, &key, out);
}

pn_result pni_range_prepare(pni_gpu *gpu, const pni_range_kind *kind) {
  const pni_program *program;
  pn_result result = PN_OK;
  for (int first = 0; first < 2 && result == PN_OK && kind->structure; first++)
    result = range_program(gpu,
                           &(pni_range_kind){.structure = kind->structure,
                                             .quads = kind->quads && (first || kind->structure == PNI_RANGE_STACK)},
                           first, &program);
  return result;
}

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

typedef struct {
  pni_gpu *gpu;
  pni_maps *maps;
  int layer, level; /* of the depth maps' array; of pyramid or stack */
} range_step;

static pn_result begin(const range_step *s, pni_attachment target, int width, int height, const pni_program **program) {
  pn_result result = range_program(s->gpu, &s->maps->want.range, s->level == 0, program);
  if (result != PN_OK) return result;
  pni_pass pass = {.color = {target}, .width = width, .height = height};
  result = pni_screen_begin(s->gpu, &pass, *program);
  if (result != PN_OK) return result;
  GLint source[4] = {s->layer, s->level, s->layer / s->maps->layers, s->layer % s->maps->layers};
  pni_bind_texture(s->gpu, PNI_UNIT_MAPS, s->maps->depth.target, s->maps->depth.id, false);
  GL(s->gpu, Uniform4iv)(pni_uniform(*program, "pn_source"), 1, source);
  return PN_OK;
}

/* The part of a level that differs from 'nothing there', where the layer holds only a part of the map. Over quads the
 * texels before it see its first ones. maps NULL: all of it. */
static pni_part part_of_level(const pni_maps *maps, int layer, int level, int width, int height) {
  if (!maps || maps->want.focus <= 0 || layer % maps->layers == 0) return (pni_part){0, 0, width, height};
  const pni_part *held = &maps->later[layer / maps->layers];
  if (held->width == 0 || held->height == 0) return (pni_part){0};
  int before = maps->want.range.quads ? 1 : 0;
  int x = larger(held->x - before, 0) >> level, y = larger(held->y - before, 0) >> level;
  int last_x = (held->x + held->width - 1) >> level, last_y = (held->y + held->height - 1) >> level;
  return (pni_part){x, y, last_x - x + 1, last_y - y + 1};
}

/* Draws the part, and clears the rest. */
static void draw_part(pni_gpu *gpu, const pni_part *part, int width, int height) {
  static const GLfloat nothing[4] = {-1e30f, -1e30f, 1e30f, 1};
  if (part->width < width || part->height < height) {
    GL(gpu, ClearBufferfv)(GL_COLOR, 0, nothing);
    if (part->width == 0) return;
    pni_pass_limit(gpu, part);
  }
  pni_draw_screen(gpu);
}

/* A pyramid's level from the one below: only that one may be read, so reading and drawing never meet. The shader then
 * calls it level 0. */
static pn_result reduce(pni_gpu *gpu, const pni_texture *range, const pni_maps *maps, int level, int layer) {
  const pni_program *program;
  pn_result result = range_program(gpu, &(pni_range_kind){.structure = PNI_RANGE_PYRAMID}, false, &program);
  if (result != PN_OK) return result;
  pni_pass pass = {.color = {{range->id, range->target, level, layer}},
                   .width = larger(range->width >> level, 1),
                   .height = larger(range->height >> level, 1)};
  result = pni_screen_begin(gpu, &pass, program);
  if (result != PN_OK) return result;
  GLint source[4] = {layer, level, 0, 0};
  pni_bind_texture(gpu, PNI_UNIT_RANGE, range->target, range->id, true);
  GL(gpu, TexParameteri)(range->target, GL_TEXTURE_BASE_LEVEL, level - 1);
  GL(gpu, TexParameteri)(range->target, GL_TEXTURE_MAX_LEVEL, level - 1);
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_source"), 1, source);
  pni_part part = part_of_level(maps, layer, level, pass.width, pass.height);
  draw_part(gpu, &part, pass.width, pass.height);
  return PN_OK;
}

/* maps: whose layers these are, where some may hold a part of the map only. */
static pn_result reduce_all(pni_gpu *gpu, const pni_texture *range, const pni_maps *maps) {
  pn_result result = PN_OK;
  for (int level = 1; level < range->levels; level++)
    for (int layer = 0; layer < range->layers && result == PN_OK; layer++)
      result = reduce(gpu, range, maps, level, layer);
  pni_bind_texture(gpu, PNI_UNIT_RANGE, range->target, range->id, true);
  GL(gpu, TexParameteri)(range->target, GL_TEXTURE_BASE_LEVEL, 0);
  GL(gpu, TexParameteri)(range->target, GL_TEXTURE_MAX_LEVEL, range->levels - 1);
  return result;
}

pn_result pni_range_reduce(pni_gpu *gpu, const pni_texture *range) { return reduce_all(gpu, range, NULL); }

/* A stack's levels are layers of one array, which GL 3.3 does not let a pass read and draw at once: each is drawn
 * aside and copied in. */
static pn_result draw_stack(const range_step *s, const pni_texture *aside, int levels) {
  pni_gpu *gpu = s->gpu;
  const pni_texture *range = &s->maps->range;
  const pni_program *program;
  pni_attachment target = {aside->id, GL_TEXTURE_2D, 0, 0};
  pn_result result = begin(s, target, range->width, range->height, &program);
  if (result != PN_OK) return result;
  GLint place[4] = {s->layer * levels + s->level - 1, s->level, 0, 0};
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_place"), 1, place);
  pni_bind_texture(gpu, PNI_UNIT_RANGE, range->target, range->id, false);
  pni_draw_screen(gpu);
  pni_copy_to_layer(gpu, aside, range, s->layer * levels + s->level);
  return PN_OK;
}

static pn_result build_stack(pni_gpu *gpu, pni_maps *maps) {
  int levels = level_count(power_above(larger(maps->range.width, maps->range.height)));
  pn_result result = pni_texture_shape(gpu, &maps->aside, GL_RG32F, maps->range.width, maps->range.height, 0, 1);
  for (int layer = 0; layer < maps->range.layers / levels; layer++)
    for (int level = 0; level < levels && result == PN_OK; level++)
      result = draw_stack(&(range_step){gpu, maps, layer, level}, &maps->aside, levels);
  return result;
}

static pn_result build_pyramid(pni_gpu *gpu, pni_maps *maps) {
  const pni_texture *range = &maps->range;
  pn_result result = PN_OK;
  for (int layer = 0; layer < range->layers && result == PN_OK; layer++) {
    const pni_program *program;
    pni_attachment target = {range->id, range->target, 0, layer};
    result = begin(&(range_step){gpu, maps, layer, 0}, target, range->width, range->height, &program);
    if (result != PN_OK) break;
    pni_part part = part_of_level(maps, layer, 0, range->width, range->height);
    draw_part(gpu, &part, range->width, range->height);
  }
  return result == PN_OK ? reduce_all(gpu, range, maps) : result;
}

pn_result pni_range_build(pni_gpu *gpu, pni_maps *maps) {
  return maps->want.range.structure == PNI_RANGE_STACK ? build_stack(gpu, maps) : build_pyramid(gpu, maps);
}
