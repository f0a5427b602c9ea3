#include "maps/range.h"

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

/* Over quads, a third channel for what is there and a fourth for gaps in depth. */
static pni_format range_format(const pni_range_kind *kind) {
  return kind->quads || kind->least_there ? PNI_RGBA32F : PNI_RG32F;
}

static int whole_blocks(int size) { return (size + PNI_HYBRID_BLOCK - 1) / PNI_HYBRID_BLOCK * PNI_HYBRID_BLOCK; }

/* The hybrid's first level has a texel for each of the map's, padded to whole blocks, in a layer of its own; the next
 * layer has all levels above it, as range_place says. The pyramid's first level has a texel for each of the map's,
 * padded to powers of two; the stack has every level at full size, as array layers. */
pn_result pni_range_shape(pni_gpu *gpu, pni_texture *texture, const pni_range_kind *kind, int layers, int width,
                          int height) {
  if (kind->structure == PNI_RANGE_PYRAMID) {
    int w = power_above(width), h = power_above(height);
    return pni_texture_shape(gpu, texture, "range pyramid", range_format(kind), w, h, layers,
                             level_count(larger(w, h)));
  }
  if (kind->structure == PNI_RANGE_STACK)
    return pni_texture_shape(gpu, texture, "range stack", range_format(kind), width, height,
                             layers * level_count(power_above(larger(width, height))), 1);
  if (kind->structure == PNI_RANGE_HYBRID)
    return pni_texture_shape(gpu, texture, "range hybrid", range_format(kind), whole_blocks(width),
                             whole_blocks(height), 2 * layers, 1);
  pni_texture_spare(gpu, texture);
  return PN_OK;
}

/* ---- passes ------------------------------------------------------------------------------------------------------ */

enum { NO_GAP = 16777215 }; /* PN_NO_GAP of gaps.glsl */
static const float nothing[4] = {PNI_NOTHING, PNI_NOTHING, PNI_EVERYTHING, NO_GAP};

enum { DEFINES = 64 };

static pni_program_key range_program(const pni_range_kind *kind, bool first, char defines[DEFINES]) {
  snprintf(defines, DEFINES, "PN_FIRST %d\nPN_STACK %d\nPN_QUADS %d\nPN_CORNERS %d\n", first,
           kind->structure != PNI_RANGE_PYRAMID, kind->quads, kind->quads && kind->least_there);
  return (pni_program_key){.fragment = "maps/range.frag.glsl", .defines = defines};
}

/* The part of a level that differs from 'nothing there', where the layer holds only a part of the map. Over quads the
 * texels before it see its first ones. maps NULL: all of it. */
static pni_part part_of_level(const pni_maps *maps, int layer, int level, int width, int height) {
  int layers = maps ? pni_want_layers(&maps->want) : 1;
  if (!maps || maps->want.focus <= 0 || layer % layers == 0) return (pni_part){0, 0, width, height};
  const pni_part *held = &maps->later[layer / layers];
  if (held->width == 0 || held->height == 0) return (pni_part){0};
  int before = maps->want.range.quads ? 1 : 0;
  int x = larger(held->x - before, 0) >> level, y = larger(held->y - before, 0) >> level;
  int last_x = (held->x + held->width - 1) >> level, last_y = (held->y + held->height - 1) >> level;
  return (pni_part){x, y, last_x - x + 1, last_y - y + 1};
}

/* A pass that draws the part, and clears the rest. */
static pn_result begin_part(pni_gpu *gpu, pni_pass *pass, const pni_part *part) {
  bool whole = part->width >= pass->width && part->height >= pass->height;
  pass->clear = whole ? NULL : nothing;
  pass->part = whole ? NULL : part;
  return pni_pass_begin(gpu, pass);
}

/* A pyramid's level from the one below: only that one may be read, so reading and drawing never meet. The shader then
 * calls it level 0. */
static pn_result reduce(pni_gpu *gpu, const pni_texture *range, const pni_maps *maps, int level, int layer) {
  char defines[DEFINES];
  pni_pass pass = {.name = "range pyramid",
                   .program = range_program(&(pni_range_kind){.structure = PNI_RANGE_PYRAMID}, false, defines),
                   .color = {pni_image_of(range, level, layer)},
                   .width = larger(range->width >> level, 1),
                   .height = larger(range->height >> level, 1)};
  pni_part part = part_of_level(maps, layer, level, pass.width, pass.height);
  pn_result result = begin_part(gpu, &pass, &part);
  if (result != PN_OK || part.width == 0) return result;
  pni_set_texture(gpu, "pn_range", range);
  pni_set_ints(gpu, "pn_source", layer, level, 0, 0);
  pni_set_ints(gpu, "pn_place", 0, 0, 0, 0);
  pni_set_ints(gpu, "pn_region", 0, 0, larger(range->width >> (level - 1), 1), larger(range->height >> (level - 1), 1));
  pni_draw_screen(gpu);
  return PN_OK;
}

static pn_result reduce_all(pni_gpu *gpu, const pni_texture *range, const pni_maps *maps) {
  pn_result result = PN_OK;
  for (int level = 1; level < range->levels; level++) {
    pni_texture_limit(gpu, range, level - 1, level - 1);
    for (int layer = 0; layer < range->layers && result == PN_OK; layer++)
      result = reduce(gpu, range, maps, level, layer);
  }
  pni_texture_limit(gpu, range, 0, range->levels - 1);
  return result;
}

pn_result pni_range_reduce(pni_gpu *gpu, const pni_texture *range) { return reduce_all(gpu, range, NULL); }

/* ---- from depth maps --------------------------------------------------------------------------------------------- */

/* Which layer of a map has what this one hides (find_gaps.glsl). Behind the farthest surface nothing lies; what one
 * peeled layer hides, the next one has as surfaces of its own. */
static int layer_behind(const pni_maps_want *want, int layer) {
  enum { HIDES_NOTHING = -1, NOT_KNOWN = -2 };
  int last = pni_want_layers(want) - 1;
  if (layer < last) return want->farthest && layer == last - 1 ? last : HIDES_NOTHING;
  return want->farthest ? HIDES_NOTHING : NOT_KNOWN;
}

static void set_source(pni_gpu *gpu, const pni_maps *maps, int layer, int level) {
  int layers = pni_want_layers(&maps->want);
  pni_set_ints(gpu, "pn_source", layer, level, layer / layers, layer % layers);
  enum { LOOKS = 4 * 8 }; /* at four gaps of a quad, in steps of 1, 2, 4 ... 128 texels */
  if (maps->want.range.quads && level == 0)
    pni_set_ints(gpu, "pn_behind", layer_behind(&maps->want, layer % layers), LOOKS, 0, 0);
}

static pn_result draw_first(pni_gpu *gpu, pni_maps *maps, int layer) {
  const pni_texture *range = &maps->range;
  char defines[DEFINES];
  int image = maps->want.range.structure == PNI_RANGE_HYBRID ? 2 * layer : layer;
  pni_pass pass = {.name = "range",
                   .program = range_program(&maps->want.range, true, defines),
                   .color = {pni_image_of(range, 0, image)},
                   .width = range->width,
                   .height = range->height};
  pni_part part = part_of_level(maps, layer, 0, range->width, range->height);
  pn_result result = begin_part(gpu, &pass, &part);
  if (result != PN_OK || part.width == 0) return result;
  set_source(gpu, maps, layer, 0);
  pni_set_texture(gpu, "pn_maps", &maps->depth);
  pni_draw_screen(gpu);
  return PN_OK;
}

static pn_result build_pyramid(pni_gpu *gpu, pni_maps *maps) {
  pn_result result = PN_OK;
  for (int layer = 0; layer < maps->range.layers && result == PN_OK; layer++) result = draw_first(gpu, maps, layer);
  return result == PN_OK ? reduce_all(gpu, &maps->range, maps) : result;
}

/* A stack's levels are layers of one array, which GL 3.3 does not let a pass read and draw at once: each is drawn
 * aside and copied in. */
static pn_result draw_stack(pni_gpu *gpu, pni_maps *maps, int layer, int level, int levels) {
  const pni_texture *range = &maps->range;
  char defines[DEFINES];
  pni_pass pass = {.name = "range stack",
                   .program = range_program(&maps->want.range, level == 0, defines),
                   .color = {pni_image_of(&maps->aside, 0, 0)},
                   .width = range->width,
                   .height = range->height};
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  set_source(gpu, maps, layer, level);
  pni_set_ints(gpu, "pn_place", layer * levels + level - 1, level, 0, 0);
  pni_set_ints(gpu, "pn_region", 0, 0, range->width, range->height);
  pni_set_texture(gpu, "pn_maps", &maps->depth);
  pni_set_texture(gpu, "pn_range", range);
  pni_draw_screen(gpu);
  pni_copy_to_layer(gpu, &maps->aside, range, layer * levels + level);
  return PN_OK;
}

static pn_result build_stack(pni_gpu *gpu, pni_maps *maps) {
  const pni_texture *range = &maps->range;
  int levels = level_count(power_above(larger(range->width, range->height)));
  pn_result result =
      pni_texture_shape(gpu, &maps->aside, "range stack, aside", range->format, range->width, range->height, 0, 1);
  for (int layer = 0; layer < range->layers / levels; layer++)
    for (int level = 0; level < levels && result == PN_OK; level++)
      result = draw_stack(gpu, maps, layer, level, levels);
  return result;
}

/* Where a level of the hybrid above its first one lies in its layer: 4 x 4 cells, as large as the grid of blocks. The
 * second level takes four of them; the other twelve are as many as maps of 8192 texels need. */
static pni_part range_place(const pni_texture *range, int level) {
  int width = range->width / 4, height = range->height / 4, cell = level - 2;
  if (level == 1) return (pni_part){0, 0, 2 * width, 2 * height};
  int x = cell < 4 ? 2 + cell % 2 : cell % 4, y = cell < 4 ? cell / 2 : 1 + cell / 4;
  return (pni_part){x * width, y * height, width, height};
}

static int hybrid_levels(const pni_texture *range) {
  return 2 + level_count(power_above(larger(range->width, range->height) / PNI_HYBRID_BLOCK));
}

/* Drawn aside and copied in, like a stack's. */
static pn_result draw_hybrid(pni_gpu *gpu, pni_maps *maps, int layer, int level) {
  const pni_texture *range = &maps->range;
  bool reduces = level <= 2;
  pni_part from = level > 1 ? range_place(range, level - 1) : (pni_part){0, 0, range->width, range->height},
           to = range_place(range, level);
  char defines[DEFINES];
  pni_range_kind kind = {.structure = reduces ? PNI_RANGE_PYRAMID : PNI_RANGE_STACK};
  pni_pass pass = {.name = "range hybrid",
                   .program = range_program(&kind, false, defines),
                   .color = {pni_image_of(&maps->aside, 0, 0)},
                   .width = range->width,
                   .height = range->height,
                   .part = &to};
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  int source = 2 * layer + (level > 1);
  pni_set_ints(gpu, "pn_source", source, 0, 0, 0);
  pni_set_ints(gpu, "pn_place", source, level - 2, to.x, to.y);
  pni_set_ints(gpu, "pn_region", from.x, from.y, from.width, from.height);
  pni_set_texture(gpu, "pn_range", range);
  pni_draw_screen(gpu);
  pni_copy_part_to_layer(gpu, &maps->aside, range, 2 * layer + 1, to.x, to.y, to.width, to.height);
  return PN_OK;
}

static pn_result build_hybrid(pni_gpu *gpu, pni_maps *maps) {
  const pni_texture *range = &maps->range;
  pn_result result =
      pni_texture_shape(gpu, &maps->aside, "range hybrid, aside", range->format, range->width, range->height, 0, 1);
  for (int layer = 0; layer < range->layers / 2 && result == PN_OK; layer++) {
    result = draw_first(gpu, maps, layer);
    for (int level = 1; level < hybrid_levels(range) && result == PN_OK; level++)
      result = draw_hybrid(gpu, maps, layer, level);
  }
  return result;
}

pn_result pni_range_build(pni_gpu *gpu, pni_maps *maps) {
  if (maps->want.range.structure == PNI_RANGE_STACK) return build_stack(gpu, maps);
  return maps->want.range.structure == PNI_RANGE_HYBRID ? build_hybrid(gpu, maps) : build_pyramid(gpu, maps);
}
