// Finds the micro-primitives that can hide light from a receiver, in one layer of one map, and hands them to the
// technique's cover. The technique defines before this file: pn_Cover, pn_cover_rectangle, pn_cover_quad,
// pn_cover_and_ask, pn_is_full, and the macros
//   PN_PRIMITIVE  what a texel stands for, see primitive.glsl
//   PN_GAPS       patches are widened to meet their left and lower neighbours
//   PN_OVERLAPS   1: what two primitives cover both counts once, so they may overlap
//   PN_EDGES      quads that lack a corner are covered by the parts that belong to the others
//   PN_DESCENT    1: adaptive descent of the range pyramid; 0: every texel of the window, or of a coarser level past
//                 the cap
//   PN_REFINE     what narrows the window first: 0 nothing, 1 the range pyramid, 2 the range stack, 3 a stack
//                 above a pyramid
//   PN_TEXELS_MAX how many texels or blocks a receiver without descent looks at
//   PN_AREA       1: what primitives hide is added up as areas too, beside what the cover makes of them; may be missing
#ifndef PN_AREA
#define PN_AREA 0
#endif
#include "search/window.glsl"

// What the search did, for looking at (docs/techniques/bitmask.md): class (0 not searched, 1 lit, 2 umbra, 3
// penumbra), blocks visited, primitives covered, texels in the window.
vec4 pn_search_done = vec4(0.0);
// The coarsest levels over all layers and maps: of its primitives (0: texels; with descent where it begins), and of
// what narrowed the window last.
vec2 pn_search_levels = vec2(0.0);
void pn_used_range_level(int level) { pn_search_levels.y = max(pn_search_levels.y, float(level)); }

#if PN_AREA
// What the primitives hide of the light, as sum of areas over all layers and maps (docs/techniques/bitmask.md, "The
// post-filter"). Overlaps count twice, and it has no end at 1: so it changes smoothly from pixel to pixel.
float pn_hidden_area = 0.0;
// A block whose bits are set already is looked at no closer when its area is known to this much.
#define PN_AREA_ERROR (1.0 / 512.0)

float pn_area_on_light(vec2 low, vec2 high) {
  vec2 size = max(clamp(high, 0.0, 1.0) - clamp(low, 0.0, 1.0), 0.0);
  return size.x * size.y;
}
#endif

// Turns of the descent, over all layers and maps of this receiver. Software GL ends a shader's loops after 65535
// turns in all, so past PN_TURNS blocks are looked at no closer: what is left costs a few turns for each level.
#define PN_TURNS 50000
int pn_search_turns = 0;

struct pn_Window {
  ivec2 low, high; // texels, both included
  vec4 w;           // the range there (pn_join_ranges)
};

// A layer of a map, beside the receiver: read once, since loops that read what an index picks anew in each turn are
// slow.
struct pn_Sheet {
  vec2 corner;      // (s, t) of a block's corner at texel (0, 0), relative to the receiver
  vec2 texel;       // size, in s and t
  vec2 density;     // texels per unit of s, of t
  vec2 dw_of_depth; // w at depth 0, relative to the receiver; w per depth
  ivec2 size;       // texels
  int image;        // in the array of images
};

// Where a block's primitives begin and end: at texel borders, or for quads at texel centres.
#if PN_PRIMITIVE == PN_PATCH
#define PN_BLOCK_CORNER 0.0
#else
#define PN_BLOCK_CORNER 0.5
#endif

pn_Sheet pn_sheet(int light, pn_ShadedPoint r, int map, int layer) {
  pn_Sheet s;
  s.texel = pn_map_texel_size(light, map);
  s.density = pn_lights[light].maps[map].density;
  s.corner = pn_map_st(light, map, vec2(PN_BLOCK_CORNER)) - r.m.xy;
  s.dw_of_depth = pn_lights[light].maps[map].w_of_depth - vec2(r.m.z, 0.0);
  s.size = pn_map_size(light, map);
  s.image = pn_array_layer(light, map, layer);
  return s;
}

vec2 pn_block_at(pn_Sheet s, ivec2 texel) { return s.corner + vec2(texel) * s.texel; }

// ---- plane rejection over a box of (s, t, w), relative to the receiver ---------------------------------------------

// Least and greatest pn_plane_front, with the receiver's own uncertainty taken off and added.
vec2 pn_front_range(pn_ShadedPoint r, vec2 low, vec2 high, float dw_least, float dw_most) {
  vec2 a = r.n.xy * low, b = r.n.xy * high;
  vec2 c = -r.k * vec2(dw_least, dw_most);
  float least = min(a.x, b.x) + min(a.y, b.y) + min(c.x, c.y);
  float most = max(a.x, b.x) + max(a.y, b.y) + max(c.x, c.y);
  vec2 lever = max(abs(low), abs(high));
  float slack = r.epsilon_plane + r.sigma * (lever.x + lever.y + r.reach * dw_most);
  return vec2(least, most) - slack;
}

#define PN_ALL_CORNERS 15 // of a quad, a bit for each

// ---- gaps in depth (docs/space.md) ---------------------------------------------------------------------------------

#if PN_PRIMITIVE != PN_PATCH
// Whether no light passes between what lies at dw_near and what is seen beside it, down to dw_far, in a box of (s, t)
// relative to the receiver: from there the nearer surface's edge falls on the farther one by no more than that one is
// known to go on behind it. far: dw_far in parts of dw_near; gaps: of the box, see maps/gaps.glsl.
bool pn_goes_on(vec2 density, vec2 low, vec2 high, float far, float gaps) {
  if (gaps >= PN_ENDLESS_REACH) return true;
  vec2 lever = max(abs(low), abs(high)) * density;
  return max(lever.x, lever.y) * (1.0 - far) <= pn_gap_reach(gaps);
}


// Which corners of a quad are taken next, of those left that hide (a bit for each): of a row, as many as lie on one
// surface. One rectangle around both rows would lie elsewhere than the corners do; other layers have other corners
// there, and together they would hide more than either.
int pn_next_part(float gaps, int left) {
  int corner = (left & 1) != 0 ? 0 : (left & 2) != 0 ? 1 : (left & 4) != 0 ? 2 : 3;
  return pn_gap_part(gaps, corner) & left & (corner < 2 ? 3 : 12);
}
#endif

#if PN_REFINE == 2
// The range stack keeps its levels as array layers: level i holds largest and smallest w of the 2^i x 2^i texels
// centred on each texel.
vec4 pn_stack_at(int light, highp sampler2DArray stack, int map, int layer, int level, ivec2 texel) {
  int images = pn_array_layer(light, pn_map_count(light) - 1, 0) + pn_map_layers(light, map);
  int levels = textureSize(stack, 0).z / images;
  ivec2 at = clamp(texel, ivec2(0), pn_map_size(light, map) - 1);
  return texelFetch(stack, ivec3(at, pn_array_layer(light, map, layer) * levels + level), 0);
}
#endif

#if PN_REFINE == 3
// Section 5, its end: a pyramid up to blocks of 4 x 4 texels, and a stack over these, which above it has level i over
// 2^i x 2^i texels around each block. The image has the first level, and in the next layer the others: 4 x 4 cells as
// large as the grid of blocks (range_place of maps/range.c).
#define PN_FINE 2 // the pyramid's last level, and the stack's first
vec4 pn_hybrid_at(int light, highp sampler2DArray hybrid, int map, int layer, int level, ivec2 at) {
  ivec2 grid = textureSize(hybrid, 0).xy >> 2;
  int cell = level - PN_FINE;
  ivec2 place = cell < 4 ? ivec2(2 + (cell & 1), cell >> 1) : ivec2(cell & 3, 1 + (cell >> 2));
  ivec2 size = level == 0 ? grid << 2 : level == 1 ? grid << 1 : grid;
  at = clamp(at, ivec2(0), size - 1) + (level < PN_FINE ? ivec2(0) : place * grid);
  return texelFetch(hybrid, ivec3(at, 2 * pn_array_layer(light, map, layer) + min(level, 1)), 0);
}
#endif

// ---- single primitives ---------------------------------------------------------------------------------------------

bool pn_texel_hides(int light, pn_ShadedPoint r, int map, ivec2 texel, float w) {
  // A patch reaches half a texel beyond its sample, over creases.
  return pn_blocks_apart(light, r, vec3(pn_map_st(light, map, vec2(texel) + 0.5), w));
}

// Counts one primitive that is covered, its rectangle on the light from low to high.
void pn_count_primitive(vec2 low, vec2 high) {
  pn_search_done.z += 1.0;
#if PN_AREA
  pn_hidden_area += pn_area_on_light(low, high);
#endif
}

void pn_add_rectangle(vec2 low, vec2 high, inout pn_Cover c) {
  pn_cover_rectangle(c, low, high);
  pn_count_primitive(low, high);
}

// A block of texels, from low to high (map coordinates), at w: a micropatch, or the coarser one that stands for many.
void pn_add_patch(int light, pn_ShadedPoint r, vec2 low, vec2 high, float w, inout pn_Cover c) {
  float dw = w - r.m.z;
  pn_add_rectangle(pn_on_light(light, low - r.m.xy, dw), pn_on_light(light, high - r.m.xy, dw), c);
}

void pn_texel_patch(int light, highp sampler2DArray maps, pn_ShadedPoint r, int map, int layer, ivec2 texel,
                    inout pn_Cover c) {
  float w = pn_map_fetch(light, maps, map, layer, texel);
  if (w <= r.m.z + r.epsilon_w || !pn_texel_hides(light, r, map, texel, w)) return;
  vec2 low = pn_map_st(light, map, vec2(texel)) - r.m.xy, high = pn_map_st(light, map, vec2(texel) + 1.0) - r.m.xy;
  vec2 a = pn_on_light(light, low, w - r.m.z), b = pn_on_light(light, high, w - r.m.z);
#if PN_GAPS
  // Guennebaud et al. 2006: where a neighbour ends, seen from the receiver, before this patch begins, the patch is
  // drawn out to it.
  float left = pn_map_fetch(light, maps, map, layer, texel - ivec2(1, 0));
  float below = pn_map_fetch(light, maps, map, layer, texel - ivec2(0, 1));
  if (left > r.m.z + r.epsilon_w && pn_texel_hides(light, r, map, texel - ivec2(1, 0), left)) {
    a.x = min(a.x, pn_on_light(light, low, left - r.m.z).x);
  }
  if (below > r.m.z + r.epsilon_w && pn_texel_hides(light, r, map, texel - ivec2(0, 1), below)) {
    a.y = min(a.y, pn_on_light(light, low, below - r.m.z).y);
  }
#endif
  pn_add_rectangle(a, b, c);
}

#if PN_PRIMITIVE != PN_PATCH
// Where the rectangle ends at one side, on the light along one axis: the middle of the edge there, whose ends are
// clamped to the light first (Fig. 6). Where neither end hides, in the middle of the cell, as far away as the ends
// beyond. side_s: the side and the cell's middle.
float pn_edge(float scale, vec2 side_s, vec2 hide, vec2 inverse, vec2 hide_beyond, vec2 inverse_beyond) {
  bool beyond = hide.x + hide.y == 0.0;
  vec2 weight = beyond ? hide_beyond : hide;
  vec2 ends = clamp(0.5 + scale * (beyond ? side_s.y : side_s.x) * (beyond ? inverse_beyond : inverse), 0.0, 1.0);
  return dot(weight, ends) / max(weight.x + weight.y, 1.0);
}

// Four samples as a quad's corners, in the order of pn_Quad, relative to the receiver.
struct pn_Corners {
  vec2 low, high; // (s, t) of the first and of the last
  vec4 dw;
  vec4 present; // 1 where there is a sample
  vec4 front;   // pn_plane_front, with the receiver's own uncertainty taken off
};

#if PN_DESCENT
// The corner samples of a block of quads.
pn_Corners pn_corners(highp sampler2DArray maps, pn_ShadedPoint r, pn_Sheet sheet, ivec2 first, ivec2 last) {
  ivec2 end = min(last, sheet.size - 1);
  vec4 depth = vec4(texelFetch(maps, ivec3(first, sheet.image), 0).r,
                    texelFetch(maps, ivec3(end.x, first.y, sheet.image), 0).r,
                    texelFetch(maps, ivec3(first.x, end.y, sheet.image), 0).r,
                    texelFetch(maps, ivec3(end, sheet.image), 0).r);
  pn_Corners k;
  k.dw = sheet.dw_of_depth.x + sheet.dw_of_depth.y * depth;
  k.low = pn_block_at(sheet, first);
  k.high = pn_block_at(sheet, last);
  vec4 s = vec4(k.low.x, k.high.x, k.low.x, k.high.x), t = vec4(k.low.y, k.low.y, k.high.y, k.high.y);
  k.front =
      r.n.x * s + r.n.y * t - r.k * k.dw - r.epsilon_plane - r.sigma * (abs(s) + abs(t) + r.reach * abs(k.dw));
  bvec2 past = greaterThanEqual(last, sheet.size);
  bvec4 outside = bvec4(false, past.x, past.y, past.x || past.y);
  k.present = vec4(lessThan(depth, vec4(1.0))) * vec4(greaterThan(depth, vec4(0.0))) * (1.0 - vec4(outside));
  return k;
}
#endif

// The primitive of four corners, or the next part of it. gaps: PN_NO_GAP too where no light passes through them; left:
// corners not taken yet, those that hide nothing among them.
pn_Quad pn_quad(int light, pn_ShadedPoint r, pn_Corners k, float gaps, inout int left) {
  vec4 dw = k.dw, front = k.front, s = vec4(k.low.x, k.high.x, k.low.x, k.high.x),
       t = vec4(k.low.y, k.low.y, k.high.y, k.high.y);
  vec2 low = k.low, high = k.high;
  vec4 hide = k.present * vec4(greaterThan(dw, vec4(r.epsilon_w))) * vec4(greaterThan(front, vec4(0.0)));
  pn_Quad q;
  q.whole = gaps >= PN_ENDLESS_REACH && hide == vec4(1.0);
  // A single corner stands for its quarter of the cell, as a patch would, and like one must rise above what a crease
  // may be.
  vec2 cell = high - low;
  vec4 rise = min(max(abs(s), abs(t)), vec4(max(cell.x, cell.y)));
  if (!q.whole) hide *= vec4(greaterThan(front, rise));
  ivec4 bits = ivec4(hide) * ivec4(1, 2, 4, 8);
  left = q.whole || PN_EDGES == 0 ? 0 : left & (bits.x | bits.y | bits.z | bits.w);
  q.some = q.whole || left != 0;
  if (!q.whole) {
    int part = pn_next_part(gaps, left);
    hide = vec4(ivec4(part) >> ivec4(0, 1, 2, 3) & 1);
    left &= ~part;
  }
  vec4 inverse = 1.0 / max(dw, vec4(PN_TINY));
  vec2 scale = 0.5 / pn_extent(light);
  q.x = 0.5 + scale.x * s * inverse;
  q.y = 0.5 + scale.y * t * inverse;
  vec2 middle = 0.5 * (low + high);
  vec4 at = vec4(pn_edge(scale.x, vec2(low.x, middle.x), hide.xz, inverse.xz, hide.yw, inverse.yw),
                 pn_edge(scale.x, vec2(high.x, middle.x), hide.yw, inverse.yw, hide.xz, inverse.xz),
                 pn_edge(scale.y, vec2(low.y, middle.y), hide.xy, inverse.xy, hide.zw, inverse.zw),
                 pn_edge(scale.y, vec2(high.y, middle.y), hide.zw, inverse.zw, hide.xy, inverse.xy));
  q.low = min(at.xz, at.yw);
  q.high = max(at.xz, at.yw);
  return q;
}

#endif

vec2 pn_block_st(int light, int map, ivec2 texel) { return pn_map_st(light, map, vec2(texel) + PN_BLOCK_CORNER); }

// Samples that a window's last quads have beyond its texels. For the descent ranges bring them along.
#if PN_PRIMITIVE == PN_PATCH || PN_DESCENT
#define PN_BEYOND 0
#else
#define PN_BEYOND 1
#endif

// ---- the window ----------------------------------------------------------------------------------------------------

// Texels within reach of casters up to w. Tiles leave their border to their neighbours.
void pn_window_texels(int light, pn_ShadedPoint r, int map, float w, out ivec2 low, out ivec2 high) {
  vec2 window = pn_search_window(pn_extent(light), w, r.m.z);
  int border = pn_map_count(light) > 1 ? 1 : 0;
  const float shift = PN_BLOCK_CORNER; // a quad lies between the centres of its texel and the next
  low = max(ivec2(floor(pn_map_texel(light, map, r.m.xy - window) - shift)), ivec2(border));
  high = min(ivec2(floor(pn_map_texel(light, map, r.m.xy + window) - shift)), pn_map_size(light, map) - 1 - border);
}

#if PN_REFINE >= 2
// Level whose neighbourhood is at least that many texels wide.
int pn_stack_level(int extent) {
  int level = 0;
  while ((1 << level) < extent) level++;
  return level;
}
#endif

#if PN_REFINE == 2
vec4 pn_window_range(int light, highp sampler2DArray stack, int map, int layer, ivec2 low, ivec2 high, bool four) {
  high = min(high, pn_map_size(light, map) - 1);
  int extent = max(high.x - low.x, high.y - low.y) + 1;
  // Of an even number of texels the centre is the upper of the middle two, in windows as in neighbourhoods: so a window
  // as wide as the neighbourhood is all of it.
  if (!four) return pn_stack_at(light, stack, map, layer, pn_stack_level(extent), (low + high + 1) / 2);
  // Section 5: four neighbourhoods of half the size, pushed into the window's corners.
  int level = pn_stack_level((extent + 1) / 2);
  pn_used_range_level(level);
  // texels of a neighbourhood before and after its centre
  int before = (1 << level) / 2, after = (1 << level) - before - 1;
  ivec2 a = low + before, b = max(high - after, low + before);
  vec4 lower = pn_join_ranges(pn_stack_at(light, stack, map, layer, level, a),
                              pn_stack_at(light, stack, map, layer, level, ivec2(b.x, a.y)));
  vec4 upper = pn_join_ranges(pn_stack_at(light, stack, map, layer, level, ivec2(a.x, b.y)),
                              pn_stack_at(light, stack, map, layer, level, b));
  return pn_join_ranges(lower, upper);
}
#elif PN_REFINE == 3
// Finest level of the pyramid's of which that many blocks an axis hold the window; past PN_FINE: none does.
int pn_fine_level(ivec2 low, ivec2 high, int blocks) {
  int level = 0;
  while (level <= PN_FINE && any(greaterThanEqual((high >> level) - (low >> level), ivec2(blocks)))) level++;
  return level;
}

// As with the stack, a single sample and then four of the smallest that cover the window, rounded out to blocks.
vec4 pn_window_range(int light, highp sampler2DArray hybrid, int map, int layer, ivec2 low, ivec2 high, bool four) {
  high = min(high, pn_map_size(light, map) - 1);
  int level = pn_fine_level(low, high, four ? 2 : 1);
  bool fine = level <= PN_FINE;
  ivec2 a = low >> min(level, PN_FINE), b = high >> min(level, PN_FINE);
  int extent = max(b.x - a.x, b.y - a.y) + 1;
  if (!fine) level = PN_FINE + pn_stack_level(four ? (extent + 1) / 2 : extent);
  if (!four) return pn_hybrid_at(light, hybrid, map, layer, level, fine ? a : (a + b + 1) / 2);
  pn_used_range_level(level);
  if (!fine) {
    int size = 1 << (level - PN_FINE), before = size / 2;
    a += before;
    b = max(b - (size - before - 1), a);
  }
  vec4 lower = pn_join_ranges(pn_hybrid_at(light, hybrid, map, layer, level, a),
                              pn_hybrid_at(light, hybrid, map, layer, level, ivec2(b.x, a.y)));
  vec4 upper = pn_join_ranges(pn_hybrid_at(light, hybrid, map, layer, level, ivec2(a.x, b.y)),
                              pn_hybrid_at(light, hybrid, map, layer, level, b));
  return pn_join_ranges(lower, upper);
}
#elif PN_REFINE == 1
vec4 pn_window_range(int light, highp sampler2DArray range, int map, int layer, ivec2 low, ivec2 high, bool four) {
  int extent = max(max(high.x - low.x, high.y - low.y), 1);
  if (four) pn_used_range_level((floatBitsToInt(float(extent)) >> 23) - 127); // as in pn_range_over
  return pn_range_over(light, range, map, layer, low, high);
}
#endif

// The window, narrowed twice: what casts nearest there decides how wide it must be.
pn_Window pn_find_window(int light, highp sampler2DArray range, pn_ShadedPoint r, int map, int layer) {
  pn_Window window;
  window.w = vec4(pn_w_near(light), PN_NOTHING, PN_EVERYTHING, PN_NO_GAP);
  pn_window_texels(light, r, map, window.w.x, window.low, window.high);
#if PN_REFINE > 0
  for (int step = 0; step < 2; step++) {
    if (any(lessThan(window.high, window.low))) break;
    window.w = pn_window_range(light, range, map, layer, window.low, window.high + PN_BEYOND, step > 0);
    if (window.w.x <= r.m.z + r.epsilon_w) break;
    pn_window_texels(light, r, map, window.w.x, window.low, window.high);
  }
#endif
  return window;
}

// Everything in the window hides: nearer than the receiver and in front of its plane, without a gap.
bool pn_is_umbra(int light, pn_ShadedPoint r, int map, pn_Window window) {
  if (window.w.y <= r.m.z + r.epsilon_w) return false;
  vec2 reach = pn_search_window(pn_extent(light), window.w.x, r.m.z);
  vec2 low = pn_block_st(light, map, window.low) - r.m.xy, high = pn_block_st(light, map, window.high + 1) - r.m.xy;
  // not cut off by the map's border
  bool inside = all(lessThanEqual(low, -reach)) && all(greaterThanEqual(high, reach));
#if PN_BEYOND
  inside = inside && all(lessThan(window.high + PN_BEYOND, pn_map_size(light, map))); // nothing is there
#endif
#if PN_PRIMITIVE != PN_PATCH
  float far = (window.w.y - r.m.z) / (window.w.x - r.m.z);
  inside = inside && pn_goes_on(pn_lights[light].maps[map].density, low, high, far, window.w.w);
#endif
  return inside && pn_front_range(r, low, high, window.w.y - r.m.z, window.w.x - r.m.z).x > 0.0;
}

// ---- every texel ---------------------------------------------------------------------------------------------------

#if !PN_DESCENT
// Texels of all windows together, or of the blocks in their place: software GL ends a shader's loops after 65535 turns
// in all, and a turn takes PN_STEP eight times. Past PN_TEXELS_MAX blocks are coarser, whatever the cap: the host is
// told (pni_search_tell).

// The first texel that may be in the range of a block of 2^level texels a side, on the pyramid's fixed grid (section 5:
// else neighbouring pixels would look at the same surface through different blocks).
ivec2 pn_block_from(pn_Sheet sheet, int level, ivec2 block) {
  ivec2 first = block << level;
#if PN_REFINE == 2
  // A block that the map's border cuts before its centre has a neighbourhood that lies closer, and has more in it.
  int before = (1 << level) >> 1;
  return max(min(first, sheet.size - 1 - before), ivec2(0));
#elif PN_REFINE == 3
  if (level <= PN_FINE) return first;
  ivec2 last = ((sheet.size - 1) >> PN_FINE) - ((1 << (level - PN_FINE)) >> 1);
  return max(min(first, last << PN_FINE), ivec2(0));
#else
  return first;
#endif
}

vec4 pn_block_range(int light, highp sampler2DArray range, pn_Sheet sheet, int map, int layer, int level, ivec2 block) {
  ivec2 first = block << level;
  if (any(lessThan(block, ivec2(0))) || any(greaterThanEqual(first, sheet.size)))
    return vec4(vec2(PN_NOTHING), PN_EVERYTHING, PN_NO_GAP);
#if PN_REFINE == 2
  return pn_stack_at(light, range, map, layer, level, first + ((1 << level) >> 1));
#elif PN_REFINE == 3
  int above = max(level - PN_FINE, 0);
  return pn_hybrid_at(light, range, map, layer, level, (block << above) + ((1 << above) >> 1));
#else
  return texelFetch(range, ivec3(block, sheet.image), level);
#endif
}

#if PN_PRIMITIVE == PN_PATCH
// A block past the cap: its rectangle at its nearest sample's w, as one patch.
void pn_coarse_patch(int light, highp sampler2DArray range, pn_ShadedPoint r, pn_Sheet sheet, int map, int layer,
                     ivec2 block, int level, inout pn_Cover c) {
  float w = pn_block_range(light, range, sheet, map, layer, level, block).x, dw = w - r.m.z;
  if (dw <= r.epsilon_w) return;
  ivec2 first = block << level, last = min((block + 1) << level, sheet.size);
  // Where in the block the sample lies is not known: anywhere there it must lie before the receiver's plane.
  vec2 least = pn_block_at(sheet, pn_block_from(sheet, level, block));
  if (pn_front_range(r, least, pn_block_at(sheet, last), dw, dw).x <= 0.0) return;
  pn_add_patch(light, r, pn_map_st(light, map, vec2(first)), pn_map_st(light, map, vec2(last)), w, c);
}
#else
// Section 4 at any level: a quad between the centres of four neighbouring blocks, each at its block's nearest sample.
// Level 0 has texels for blocks. Where in its block a sample lies is not known: its front is the least anywhere there.
pn_Corners pn_block_corners(int light, highp sampler2DArray range, pn_ShadedPoint r, pn_Sheet sheet, int map,
                            int layer, int level, ivec2 block, out float gaps) {
  vec4 a = pn_block_range(light, range, sheet, map, layer, level, block);
  vec4 b = pn_block_range(light, range, sheet, map, layer, level, block + ivec2(1, 0));
  vec4 c = pn_block_range(light, range, sheet, map, layer, level, block + ivec2(0, 1));
  vec4 d = pn_block_range(light, range, sheet, map, layer, level, block + 1);
  vec4 w = vec4(a.x, b.x, c.x, d.x);
  gaps = a.w;
  pn_Corners k;
  k.low = sheet.corner + ((vec2(block) + 0.5) * float(1 << level) - 0.5) * sheet.texel;
  k.high = k.low + float(1 << level) * sheet.texel;
  k.dw = w - r.m.z;
  k.present = vec4(greaterThan(w, vec4(PN_NOTHING)));
  // samples of both columns and rows of blocks, from and to
  vec4 from = vec4(pn_block_at(sheet, pn_block_from(sheet, level, block)),
                   pn_block_at(sheet, pn_block_from(sheet, level, block + 1)));
  vec4 to = vec4(pn_block_at(sheet, min((block + 1) << level, sheet.size) - 1),
                 pn_block_at(sheet, min((block + 2) << level, sheet.size) - 1));
  vec4 plane = min(r.n.xyxy * from, r.n.xyxy * to), lever = max(abs(from), abs(to));
  k.front = plane.xzxz + plane.yyww - r.k * k.dw - r.epsilon_plane -
            r.sigma * (lever.xzxz + lever.yyww + r.reach * abs(k.dw));
  return k;
}

// A quad of the scan, or the next part of it. Those of blocks are the paper's: all corners must hide, and gaps are
// bridged. Drawn out to the nearest samples of their blocks they cover more than what is there, without the parts of
// others too; and which samples lie on one surface is not known.
void pn_scan_quad(int light, highp sampler2DArray range, pn_ShadedPoint r, pn_Sheet sheet, int map, int layer,
                  ivec2 block, int level, inout int left, inout pn_Cover c) {
  float gaps;
  pn_Corners k = pn_block_corners(light, range, r, sheet, map, layer, level, block, gaps);
  vec4 near = mix(vec4(PN_NOTHING), k.dw, k.present), far = mix(vec4(PN_EVERYTHING), k.dw, k.present);
  float most = max(max(near.x, near.y), max(near.z, near.w)), least = min(min(far.x, far.y), min(far.z, far.w));
  if (most <= r.epsilon_w) {
    left = 0;
    return;
  }
  bool bridged = level > 0 || pn_goes_on(sheet.density, k.low, k.high, max(least, r.epsilon_w) / most, gaps);
  pn_Quad q = pn_quad(light, r, k, bridged ? PN_NO_GAP : gaps, left);
  if (level > 0) left = 0;
  if (!q.some || (level > 0 && !q.whole)) return;
  if (q.whole)
    pn_cover_quad(c, q);
  else
    pn_cover_rectangle(c, q.low, q.high);
  pn_count_primitive(q.low, q.high);
}
#endif

// The primitives of a level that touch the window, both included. A quad reaches from its block's centre to the next
// one's.
void pn_blocks_of(pn_Window window, int level, out ivec2 first, out ivec2 last) {
#if PN_PRIMITIVE == PN_PATCH
  first = window.low >> level;
  last = window.high >> level;
#else
  int centre = (1 << level) >> 1;
  first = (window.low - centre) >> level;
  last = (window.high + min(level, 1) - centre) >> level;
#endif
}

// The finest level that has no more than cap primitives an axis in the window. A quad needs two blocks.
int pn_level_for(int light, pn_Window window, int cap, out ivec2 first, out ivec2 last) {
#if PN_PRIMITIVE != PN_PATCH
  if (cap == 1) cap = 2;
#endif
  int most = PN_TEXELS_MAX / (pn_map_count(light) * pn_layers(light)), level = 0;
  pn_blocks_of(window, level, first, last);
  for (ivec2 size = last - first + 1; size.x * size.y > most || (cap > 0 && max(size.x, size.y) > cap);
       size = last - first + 1) {
    level++;
    pn_blocks_of(window, level, first, last);
  }
  return level;
}

// One primitive, or a part of one: of those left, none when it is done.
void pn_scan_one(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r, pn_Sheet sheet,
                 int map, int layer, ivec2 at, int level, inout int left, inout pn_Cover c) {
#if PN_PRIMITIVE == PN_PATCH
  left = 0;
  if (level > 0)
    pn_coarse_patch(light, range, r, sheet, map, layer, at, level, c);
  else
    pn_texel_patch(light, maps, r, map, layer, at, c);
#else
  pn_scan_quad(light, range, r, sheet, map, layer, at, level, left, c);
#endif
}

// A step of the scan: the primitive at a texel of the row, or the next part of it.
void pn_scan_step(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r, pn_Sheet sheet,
                  int map, int layer, int level, inout ivec2 at, int end, inout int left, inout pn_Cover c) {
  if (at.x > end) return;
  pn_scan_one(light, maps, range, r, sheet, map, layer, at, level, left, c);
  if (left != 0) return;
  at.x++;
  left = PN_ALL_CORNERS;
  pn_search_done.y += 1.0;
}
#define PN_STEP pn_scan_step(light, maps, range, r, sheet, map, layer, level, at, last.x, left, c);

void pn_scan(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r, int map, int layer,
             pn_Window window, int cap, inout pn_Cover c) {
  int left = PN_ALL_CORNERS;
  pn_Sheet sheet = pn_sheet(light, r, map, layer);
  ivec2 first, last;
  int level = pn_level_for(light, window, cap, first, last);
  pn_search_levels.x = max(pn_search_levels.x, float(level));
  for (ivec2 at = first; at.y <= last.y; at = ivec2(first.x, at.y + 1))
    while (at.x <= last.x) {
      PN_STEP PN_STEP PN_STEP PN_STEP PN_STEP PN_STEP PN_STEP PN_STEP
    }
}
#endif

// ---- adaptive descent ----------------------------------------------------------------------------------------------

#if PN_DESCENT
#define PN_SKIP 0
#define PN_DOWN 1
#define PN_STAY 2 // to be covered by the primitive of its corners

struct pn_Rectangle { vec2 low, high; }; // on the light, 0 to 1

// Where the walk over the pyramid's blocks is.
struct pn_Walk {
  ivec2 node, first, last; // block; first and last of the level it starts at
  int level, top;
  bool going;
  int left;         // corners of this block's primitive that are still to be covered; 0: it is to be visited
  float gaps;       // of that primitive
  bool exact;        // whole, it may be covered exactly
};

#if PN_AREA
// What becomes of a block whose bits are set already, for its area: skipped where nothing of it lies on the light; its
// corners, or its rectangle, stand for it where all that it may hide differs little from what it hides at least; else
// its parts do.
int pn_visit_covered(pn_Rectangle least, pn_Rectangle most, bool leaf) {
  float many = pn_area_on_light(most.low, most.high);
  if (many == 0.0) return PN_SKIP;
  return leaf || many - pn_area_on_light(least.low, least.high) <= PN_AREA_ERROR ? PN_STAY : PN_DOWN;
}
#endif

// One block of the pyramid, 2^level primitives a side: skipped, covered, or looked at closer. Wherever in its range the
// surface lies, it hides no more than the hull of the block's projections at both ends of the range, and, where it has
// neither hole nor gap, no less than what both have in common.
int pn_visit_block(int light, highp sampler2DArray range, pn_ShadedPoint r, pn_Sheet sheet, float merge,
                   inout pn_Walk walk, inout pn_Cover c) {
  vec4 block = texelFetch(range, ivec3(walk.node, sheet.image), walk.level);
  vec3 dw = block.rgb - r.m.z; // largest, smallest, that of what is there
  vec2 extent = pn_extent(light);
  vec2 low = pn_block_at(sheet, walk.node << walk.level), high = pn_block_at(sheet, (walk.node + 1) << walk.level);
  bool beside = any(greaterThan(low, extent * dw.x)) || any(lessThan(high, -extent * dw.x));
#if PN_PRIMITIVE == PN_PATCH
  // A single texel is asked at its centre, as the sample it is.
  vec2 margin = walk.level == 0 ? 0.5 * (high - low) : vec2(0.0);
  vec2 centre = abs(low + margin), texel = 2.0 * margin;
  float rise = min(max(centre.x, centre.y), max(texel.x, texel.y));
#else
  const vec2 margin = vec2(0.0);
  const float rise = 0.0;
#endif
  float dw_least = max(dw.z, r.epsilon_w);
  vec2 front = pn_front_range(r, low + margin, high - margin, dw_least, dw.x);
  // not nearer, not before the light, or behind the tangent plane
  if (dw.x <= r.epsilon_w || beside || front.y <= rise) return PN_SKIP;
  // Where the block's edges fall on the light, at its nearest and at its farthest.
  vec2 inverse = 1.0 / vec2(dw.x, dw_least), half_low = 0.5 * low / extent, half_high = 0.5 * high / extent;
  vec2 a0 = clamp(0.5 + half_low * inverse.x, 0.0, 1.0), a1 = clamp(0.5 + half_low * inverse.y, 0.0, 1.0);
  vec2 b0 = clamp(0.5 + half_high * inverse.x, 0.0, 1.0), b1 = clamp(0.5 + half_high * inverse.y, 0.0, 1.0);
  vec2 moved = max(abs(a0 - a1), abs(b0 - b1));
#if PN_PRIMITIVE == PN_PATCH
  const bool bridged = true;
#else
  // Inside the block edges may fall on the light where those of the block are beside it.
  vec2 shift = max(abs(half_low), abs(half_high)) * (inverse.y - inverse.x);
  bool bridged =
      max(shift.x, shift.y) <= merge || pn_goes_on(sheet.density, low, high, dw_least * inverse.x, block.w);
#endif
  bool solid = dw.y > r.epsilon_w && front.x > rise && bridged;
  bool one = solid && max(moved.x, moved.y) <= merge;
  pn_Rectangle most = pn_Rectangle(min(a0, a1), max(b0, b1));
  pn_Rectangle least = pn_Rectangle(max(a0, a1), solid ? min(b0, b1) : vec2(0.0));
#if PN_PRIMITIVE == PN_PATCH
  bool leaf = walk.level == 0 || pn_search_turns >= PN_TURNS;
  if (one) {
    most = least = pn_Rectangle(0.5 * (a0 + a1), 0.5 * (b0 + b1));
    pn_count_primitive(least.low, least.high);
  }
  bool done = pn_cover_and_ask(c, least.low, least.high, most.low, most.high, one);
#if PN_AREA
  if (done && !one) {
    int what = pn_visit_covered(least, most, leaf);
    vec2 a = 0.5 * (a0 + a1), b = 0.5 * (b0 + b1);
    if (what == PN_STAY && !(leaf && !solid)) pn_hidden_area += pn_area_on_light(a, b);
    done = what != PN_DOWN;
  }
#endif
  return done || leaf ? PN_SKIP : PN_DOWN;
#else
  // A block without gaps that is itself no larger on the light than what may be moved is looked at no closer: its
  // corners stand for it, as a texel's do.
  vec2 size = half_high - half_low;
  bool leaf = walk.level == 0 || pn_search_turns >= PN_TURNS ||
              bridged && max(size.x, size.y) <= merge * max(dw.y, r.epsilon_w);
  bool covered = pn_cover_and_ask(c, least.low, least.high, most.low, most.high, false);
#if PN_AREA
  int what = covered ? pn_visit_covered(least, most, leaf || one) : leaf || one ? PN_STAY : PN_DOWN;
#else
  int what = covered ? PN_SKIP : leaf || one ? PN_STAY : PN_DOWN;
#endif
  if (what != PN_STAY) return what;
  walk.left = PN_ALL_CORNERS;
  walk.gaps = bridged || walk.level > 0 ? PN_NO_GAP : block.w;
  walk.exact = !one;
  return PN_STAY;
#endif
}

// A step of the walk: down to the first child, or past all last children and then aside.
void pn_walk(inout pn_Walk walk, bool down) {
  if (down) {
    walk.level--;
    walk.node <<= 1;
    return;
  }
  int up = min(pn_levels_past(walk.node), walk.top - walk.level);
  walk.level += up;
  walk.node >>= up;
  if (walk.level < walk.top) {
    walk.node += (walk.node.x & 1) == 0 ? ivec2(1, 0) : ivec2(-1, 1);
    return;
  }
  walk.node = walk.node.x < walk.last.x ? walk.node + ivec2(1, 0) : ivec2(walk.first.x, walk.node.y + 1);
  walk.going = walk.node.y <= walk.last.y;
}

void pn_visit(int light, highp sampler2DArray range, pn_ShadedPoint r, pn_Sheet sheet, float merge,
              inout pn_Walk walk, inout pn_Cover c) {
  if (!walk.going || walk.left != 0) return;
  pn_search_done.y += 1.0;
  int what = pn_visit_block(light, range, r, sheet, merge, walk, c);
  if (what != PN_STAY) pn_walk(walk, what == PN_DOWN);
}
#define PN_VISIT pn_visit(light, range, r, sheet, merge, walk, c);

#if PN_PRIMITIVE != PN_PATCH
// A merged block's edges, each at the mean of two corners, do not meet the smaller primitives beside it, whose edges
// lie on both sides of that mean. Out to the corners they do.
void pn_spread(inout pn_Quad q) {
  q.low = vec2(min(min(q.x.x, q.x.y), min(q.x.z, q.x.w)), min(min(q.y.x, q.y.y), min(q.y.z, q.y.w)));
  q.high = vec2(max(max(q.x.x, q.x.y), max(q.x.z, q.x.w)), max(max(q.y.x, q.y.y), max(q.y.z, q.y.w)));
}

// Covers the primitive that a visit left, or the next part of it; true where that is to be done exactly, row by row.
bool pn_take_quad(int light, highp sampler2DArray maps, pn_ShadedPoint r, pn_Sheet sheet, inout pn_Walk walk,
                  inout pn_Cover c, out pn_Quad quad) {
  ivec2 first = walk.node << walk.level, last = (walk.node + 1) << walk.level;
  quad = pn_quad(light, r, pn_corners(maps, r, sheet, first, last), walk.gaps, walk.left);
  if (walk.left == 0) pn_walk(walk, false);
  if (!quad.some) return false;
#if PN_PRIMITIVE == PN_QUAD_EXACT
  if (quad.whole && walk.exact) return true;
#endif
  pn_count_primitive(quad.low, quad.high);
#if PN_OVERLAPS
  if (quad.whole && !walk.exact) pn_spread(quad);
#endif
  pn_cover_rectangle(c, quad.low, quad.high);
  return false;
}
#endif

// Depth first over the blocks that the window touches, without a stack. Visits are cheap and many, primitives dear and
// few, and a turn costs what its dearest lane does: so each turn has several visits, then the primitive that one of
// them left. A quad that is covered exactly takes a turn for each of its rows. Past PN_TURNS turns, over all layers and
// maps, blocks are looked at no closer.
void pn_descend(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r, int map, int layer,
                pn_Window window, float merge, inout pn_Cover c) {
  int extent = max(window.high.x - window.low.x, window.high.y - window.low.y);
  pn_Sheet sheet = pn_sheet(light, r, map, layer);
  pn_Walk walk;
  walk.top = 0;
  while ((extent >> walk.top) > 2) walk.top++;
  pn_search_levels.x = max(pn_search_levels.x, float(walk.top));
  walk.first = walk.node = window.low >> walk.top;
  walk.last = window.high >> walk.top;
  walk.level = walk.top;
  walk.going = true;
  walk.left = 0;
  ivec2 rows = ivec2(0);
  pn_Quad quad;
  while (walk.going || rows.x < rows.y) {
    pn_search_turns++;
#if PN_PRIMITIVE == PN_QUAD_EXACT
    if (rows.x < rows.y) {
      pn_cover_quad_row(c, quad, rows.x);
      rows.x++;
      continue;
    }
#endif
    PN_VISIT PN_VISIT PN_VISIT PN_VISIT
#if PN_PRIMITIVE != PN_PATCH
    if (walk.left != 0 && pn_take_quad(light, maps, r, sheet, walk, c, quad)) {
#if PN_PRIMITIVE == PN_QUAD_EXACT
      rows = pn_quad_rows(quad);
#endif
    }
#endif
#if !PN_AREA
    if (pn_is_full(c)) break;
#endif
  }
}
#endif

// ---- one layer of one map ------------------------------------------------------------------------------------------

void pn_search(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r, int map, int layer,
               inout pn_Cover c) {
  pn_Window window = pn_find_window(light, range, r, map, layer);
  pn_search_done.x = max(pn_search_done.x, 1.0);
  // lit, as far as this layer goes
  if (any(lessThan(window.high, window.low)) || window.w.x <= r.m.z + r.epsilon_w) return;
  pn_search_done.w += float((window.high.x - window.low.x + 1) * (window.high.y - window.low.y + 1));
  if (pn_is_umbra(light, r, map, window)) {
    pn_cover_rectangle(c, vec2(0.0), vec2(1.0));
#if PN_AREA
    pn_hidden_area += 1.0;
#endif
    pn_search_done.x = max(pn_search_done.x, 2.0);
    return;
  }
  pn_search_done.x = 3.0;
#if PN_DESCENT
  pn_descend(light, maps, range, r, map, layer, window, 0.01 * pn_parameter(light, PN_PARAMETER_MERGE), c);
#else
  pn_scan(light, maps, range, r, map, layer, window, int(pn_parameter(light, PN_PARAMETER_CAP)), c);
#endif
}

vec4 pn_search_report(out vec2 levels) {
  levels = pn_search_levels;
  return pn_search_done;
}
