// Finds the micro-primitives that can hide light from a receiver, in one layer of one map, and hands them to the
// technique's cover. The technique defines before this file: pn_Cover, pn_cover_rectangle, pn_cover_quad,
// pn_cover_and_ask, pn_is_full, and the macros
//   PN_PRIMITIVE  what a texel stands for, see primitive.glsl
//   PN_GAPS       patches are widened to meet their left and lower neighbours
//   PN_EDGES      quads that lack a corner are covered by the parts that belong to the others
//   PN_DESCENT    1: adaptive descent of the range pyramid; 0: every texel of the window, or of a coarser level past
//                 the cap
//   PN_REFINE     what narrows the window first: 0 nothing, 1 the range pyramid, 2 the range stack
#include "search/window.glsl"

// What the search did, for looking at (docs/techniques/bitmask.md): class (0 not searched, 1 lit, 2 umbra, 3
// penumbra), blocks visited, primitives covered, texels in the window.
vec4 pn_search_done = vec4(0.0);

// Turns of the descent, over all layers and maps of this receiver. Software GL ends a shader's loops after 65535
// turns in all, so past PN_TURNS blocks are looked at no closer: what is left costs a few turns for each level.
#define PN_TURNS 50000
int pn_search_turns = 0;

struct pn_Window {
  ivec2 low, high; // texels, both included
  vec2 w;          // largest and smallest there
};

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

// ---- single primitives ---------------------------------------------------------------------------------------------

bool pn_texel_hides(int light, pn_ShadedPoint r, int map, ivec2 texel, float w) {
  // A patch reaches half a texel beyond its sample, over creases.
  return pn_blocks_apart(light, r, vec3(pn_map_st(light, map, vec2(texel) + 0.5), w));
}

// A block of texels, from low to high (map coordinates), at w: a micropatch, or the coarser one that stands for many.
void pn_add_patch(int light, pn_ShadedPoint r, vec2 low, vec2 high, float w, inout pn_Cover c) {
  float dw = w - r.m.z;
  pn_cover_rectangle(c, pn_on_light(light, low - r.m.xy, dw), pn_on_light(light, high - r.m.xy, dw));
  pn_search_done.z += 1.0;
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
  pn_cover_rectangle(c, a, b);
  pn_search_done.z += 1.0;
}

#if PN_PRIMITIVE != PN_PATCH
// Where the rectangle ends along one axis: at near and far, at the distances of the corners there, as far as they
// hide: share 1 is the corner, 0 the middle.
vec2 pn_edge(float scale, float near, float far, vec2 share, vec2 inverse) {
  float middle = 0.5 * (near + far);
  vec2 at = 0.5 + scale * vec2(mix(middle, near, share.x) * (share.x > 0.0 ? inverse.x : inverse.y),
                               mix(middle, far, share.y) * (share.y > 0.0 ? inverse.y : inverse.x));
  return vec2(min(at.x, at.y), max(at.x, at.y));
}

pn_Quad pn_quad(int light, highp sampler2DArray maps, pn_ShadedPoint r, int map, int layer, ivec2 first, ivec2 last) {
  int array_layer = pn_array_layer(light, map, layer);
  ivec2 size = pn_map_size(light, map), end = min(last, size - 1);
  vec4 depth = vec4(texelFetch(maps, ivec3(first, array_layer), 0).r,
                    texelFetch(maps, ivec3(end.x, first.y, array_layer), 0).r,
                    texelFetch(maps, ivec3(first.x, end.y, array_layer), 0).r,
                    texelFetch(maps, ivec3(end, array_layer), 0).r);
  vec2 w_of_depth = pn_lights[light].maps[map].w_of_depth;
  vec4 dw = w_of_depth.x + w_of_depth.y * depth - r.m.z;
  vec2 low = pn_map_st(light, map, vec2(first) + 0.5) - r.m.xy, high = pn_map_st(light, map, vec2(last) + 0.5) - r.m.xy;
  vec4 s = vec4(low.x, high.x, low.x, high.x), t = vec4(low.y, low.y, high.y, high.y);
  vec4 front = r.n.x * s + r.n.y * t - r.k * dw - r.epsilon_plane - r.sigma * (abs(s) + abs(t) + r.reach * abs(dw));
  bvec4 outside = bvec4(false, last.x >= size.x, last.y >= size.y, last.x >= size.x || last.y >= size.y);
  vec4 there = vec4(greaterThan(dw, vec4(r.epsilon_w))) * vec4(lessThan(depth, vec4(1.0))) *
               vec4(greaterThan(depth, vec4(0.0))) * (1.0 - vec4(outside));
  vec4 hide = there * vec4(greaterThan(front, vec4(0.0)));
  pn_Quad q;
  q.whole = hide == vec4(1.0);
  // A single corner stands for its quarter of the cell, as a patch would, and like one must rise above what a crease
  // may be.
  vec2 cell = high - low;
  vec4 rise = min(max(abs(s), abs(t)), vec4(max(cell.x, cell.y)));
  if (!q.whole) hide *= vec4(greaterThan(front, rise));
  q.some = q.whole || (PN_EDGES != 0 && hide != vec4(0.0));
  vec4 inverse = 1.0 / max(dw, vec4(PN_TINY));
  vec2 scale = 0.5 / pn_extent(light);
  q.x = 0.5 + scale.x * s * inverse;
  q.y = 0.5 + scale.y * t * inverse;
  // Columns and rows that hide, and the mean w of their corners. The rectangle has as many quarters of the cell as
  // corners hide: where both columns do, a row with one corner has half of its share.
  vec4 hidden = hide * dw;
  vec2 columns = hide.xy + hide.zw, rows = hide.xz + hide.yw;
  vec2 column_share = min(columns, vec2(1.0));
  vec2 row_share = rows / max(column_share.x + column_share.y, 1.0);
  vec2 along_x = pn_edge(scale.x, low.x, high.x, column_share, columns / max(hidden.xy + hidden.zw, vec2(PN_TINY)));
  vec2 along_y = pn_edge(scale.y, low.y, high.y, row_share, rows / max(hidden.xz + hidden.yw, vec2(PN_TINY)));
  q.low = vec2(along_x.x, along_y.x);
  q.high = vec2(along_x.y, along_y.y);
  return q;
}

void pn_texel_quad(int light, highp sampler2DArray maps, pn_ShadedPoint r, int map, int layer, ivec2 first,
                   ivec2 last, inout pn_Cover c) {
  pn_Quad q = pn_quad(light, maps, r, map, layer, first, last);
  if (!q.some) return;
  if (q.whole)
    pn_cover_quad(c, q);
  else
    pn_cover_rectangle(c, q.low, q.high);
  pn_search_done.z += 1.0;
}
#endif

void pn_texel_primitive(int light, highp sampler2DArray maps, pn_ShadedPoint r, int map, int layer, ivec2 texel,
                        inout pn_Cover c) {
#if PN_PRIMITIVE == PN_PATCH
  pn_texel_patch(light, maps, r, map, layer, texel, c);
#else
  pn_texel_quad(light, maps, r, map, layer, texel, texel + 1, c);
#endif
}

// Where a block's primitives begin and end: at texel borders, or for quads at texel centres.
vec2 pn_block_st(int light, int map, ivec2 texel) {
#if PN_PRIMITIVE == PN_PATCH
  return pn_map_st(light, map, vec2(texel));
#else
  return pn_map_st(light, map, vec2(texel) + 0.5);
#endif
}

// ---- the window ----------------------------------------------------------------------------------------------------

// Texels within reach of casters up to w. Tiles leave their border to their neighbours.
void pn_window_texels(int light, pn_ShadedPoint r, int map, float w, out ivec2 low, out ivec2 high) {
  vec2 window = pn_search_window(pn_extent(light), w, r.m.z);
  int border = pn_map_count(light) > 1 ? 1 : 0;
#if PN_PRIMITIVE == PN_PATCH
  const float shift = 0.0;
#else
  const float shift = 0.5; // a quad lies between the centres of its texel and the next
#endif
  low = max(ivec2(floor(pn_map_texel(light, map, r.m.xy - window) - shift)), ivec2(border));
  high = min(ivec2(floor(pn_map_texel(light, map, r.m.xy + window) - shift)), pn_map_size(light, map) - 1 - border);
}

#if PN_REFINE == 2
// The range stack keeps its levels as array layers: level i holds largest and smallest w of the 2^i x 2^i texels
// centred on each texel.
vec2 pn_stack_at(int light, highp sampler2DArray stack, int map, int layer, int level, ivec2 texel) {
  int images = pn_array_layer(light, pn_map_count(light) - 1, 0) + pn_map_layers(light, map);
  int levels = textureSize(stack, 0).z / images;
  ivec2 at = clamp(texel, ivec2(0), pn_map_size(light, map) - 1);
  return texelFetch(stack, ivec3(at, pn_array_layer(light, map, layer) * levels + level), 0).rg;
}

// Level whose neighbourhood is at least that many texels wide.
int pn_stack_level(int extent) {
  int level = 0;
  while ((1 << level) < extent) level++;
  return level;
}

vec2 pn_window_range(int light, highp sampler2DArray stack, int map, int layer, ivec2 low, ivec2 high, bool four) {
  int extent = max(high.x - low.x, high.y - low.y) + 1;
  if (!four) {
    // The centre of a neighbourhood of even size is half a texel off; over the whole map that does not matter, and
    // there is no level above it.
    ivec2 size = pn_map_size(light, map);
    int level = pn_stack_level(min(extent + 1, max(size.x, size.y)));
    return pn_stack_at(light, stack, map, layer, level, (low + high + 1) / 2);
  }
  // Section 5: four neighbourhoods of half the size, pushed into the window's corners.
  int level = pn_stack_level((extent + 1) / 2);
  // texels of a neighbourhood before and after its centre
  int before = (1 << level) / 2, after = (1 << level) - before - 1;
  ivec2 a = low + before, b = max(high - after, low + before);
  vec2 w = pn_stack_at(light, stack, map, layer, level, a);
  vec2 w1 = pn_stack_at(light, stack, map, layer, level, ivec2(b.x, a.y));
  vec2 w2 = pn_stack_at(light, stack, map, layer, level, ivec2(a.x, b.y));
  vec2 w3 = pn_stack_at(light, stack, map, layer, level, b);
  return vec2(max(max(w.x, w1.x), max(w2.x, w3.x)), min(min(w.y, w1.y), min(w2.y, w3.y)));
}
#elif PN_REFINE == 1
vec2 pn_window_range(int light, highp sampler2DArray range, int map, int layer, ivec2 low, ivec2 high, bool four) {
  return pn_range_over(light, range, map, layer, low, high);
}
#endif

// The window, narrowed twice: what casts nearest there decides how wide it must be.
pn_Window pn_find_window(int light, highp sampler2DArray range, pn_ShadedPoint r, int map, int layer) {
  pn_Window window;
  window.w = vec2(pn_w_near(light), PN_NOTHING);
  pn_window_texels(light, r, map, window.w.x, window.low, window.high);
#if PN_REFINE > 0
  for (int step = 0; step < 2; step++) {
    if (any(lessThan(window.high, window.low))) break;
    window.w = pn_window_range(light, range, map, layer, window.low, window.high, step > 0);
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
  return inside && pn_front_range(r, low, high, window.w.y - r.m.z, window.w.x - r.m.z).x > 0.0;
}

// ---- every texel ---------------------------------------------------------------------------------------------------

#if !PN_DESCENT
// Texels of a row that one turn of the loop takes: software GL ends a shader's loops after 65535 turns in all.
#define PN_ROW 8
#define PN_TEXELS_MAX 360000

// A texel of a coarser level past the cap, on the pyramid's fixed grid: nearest surface of its block, as one patch
// (section 5).
void pn_coarse_patch(int light, highp sampler2DArray range, pn_ShadedPoint r, int map, int layer, ivec2 block,
                     int level, inout pn_Cover c) {
#if PN_REFINE == 2
  vec2 w = pn_stack_at(light, range, map, layer, level, (block << level) + ((1 << level) >> 1));
#else
  vec2 w = texelFetch(range, ivec3(block, pn_array_layer(light, map, layer)), level).rg;
#endif
  float dw = w.x - r.m.z;
  if (dw <= r.epsilon_w) return;
  ivec2 first = block << level, last = min((block + 1) << level, pn_map_size(light, map));
  vec2 low = pn_block_st(light, map, first), high = pn_block_st(light, map, last);
  // The plane's largest value over the block is held against the block's largest w.
  if (pn_front_range(r, low - r.m.xy, high - r.m.xy, dw, dw).x <= 0.0) return;
  pn_add_patch(light, r, low, high, w.x, c);
}

int pn_level_for(ivec2 size, int cap) {
  int level = 0;
  while ((((size.x >> level) + 1) * ((size.y >> level) + 1) > PN_TEXELS_MAX ||
          (cap > 0 && max(size.x >> level, size.y >> level) > cap)) && level < 12)
    level++;
  return level;
}

void pn_scan_one(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r, int map,
                 int layer, ivec2 at, int level,
                 inout pn_Cover c) {
  pn_search_done.y += 1.0;
  if (level == 0)
    pn_texel_primitive(light, maps, r, map, layer, at, c);
  else
    pn_coarse_patch(light, range, r, map, layer, at, level, c);
}
#define PN_TURN(i) if (x + i <= last.x) pn_scan_one(light, maps, range, r, map, layer, ivec2(x + i, y), level, c);

void pn_scan(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r, int map, int layer,
             pn_Window window, int cap, inout pn_Cover c) {
  int level = pn_level_for(window.high - window.low + 1, cap);
  ivec2 first = window.low >> level, last = window.high >> level;
  for (int y = first.y; y <= last.y; y++)
    for (int x = first.x; x <= last.x; x += PN_ROW) {
      PN_TURN(0) PN_TURN(1) PN_TURN(2) PN_TURN(3) PN_TURN(4) PN_TURN(5) PN_TURN(6) PN_TURN(7)
    }
}
#endif

// ---- adaptive descent ----------------------------------------------------------------------------------------------

#if PN_DESCENT
#define PN_SKIP 0
#define PN_DOWN 1
#define PN_LEAF_QUAD 2 // a quad that must be covered exactly

struct pn_Rectangle { vec2 low, high; }; // on the light, 0 to 1

// One block of the pyramid, 2^level primitives a side: skipped, covered, or looked at closer. Wherever in its range the
// surface lies, it hides no more than the hull of the block's projections at both ends of the range, and, where it has
// no hole, no less than what both have in common.
int pn_visit_block(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r, int map,
                   int layer, ivec2 node, int level, float merge, inout pn_Cover c, out pn_Quad quad) {
  // largest, smallest, that of what is there
  vec3 dw = texelFetch(range, ivec3(node, pn_array_layer(light, map, layer)), level).rgb - r.m.z;
  vec2 extent = pn_extent(light);
  vec2 low = pn_block_st(light, map, node << level) - r.m.xy;
  vec2 high = pn_block_st(light, map, (node + 1) << level) - r.m.xy;
  bool beside = any(greaterThan(low, extent * dw.x)) || any(lessThan(high, -extent * dw.x));
#if PN_PRIMITIVE == PN_PATCH
  // A single texel is asked at its centre, as the sample it is.
  vec2 margin = level == 0 ? 0.5 * (high - low) : vec2(0.0);
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
  vec2 scale = 0.5 / extent;
  vec2 a0 = clamp(0.5 + scale * low / dw.x, 0.0, 1.0), a1 = clamp(0.5 + scale * low / dw_least, 0.0, 1.0);
  vec2 b0 = clamp(0.5 + scale * high / dw.x, 0.0, 1.0), b1 = clamp(0.5 + scale * high / dw_least, 0.0, 1.0);
  vec2 moved = max(abs(a0 - a1), abs(b0 - b1));
  bool solid = dw.y > r.epsilon_w && front.x > rise;
  bool one = solid && max(moved.x, moved.y) <= merge;
  // A block that is itself no larger on the light than what may be moved is looked at no closer: its corners stand
  // for it, as a texel's do.
  vec2 size = scale * (high - low) / max(dw.y, r.epsilon_w);
  bool leaf = level == 0 || pn_search_turns >= PN_TURNS || PN_PRIMITIVE != PN_PATCH && max(size.x, size.y) <= merge;
  pn_Rectangle most = pn_Rectangle(min(a0, a1), max(b0, b1));
  pn_Rectangle least = pn_Rectangle(max(a0, a1), solid ? min(b0, b1) : vec2(0.0));
#if PN_PRIMITIVE == PN_PATCH
  pn_Rectangle as_one = pn_Rectangle(0.5 * (a0 + a1), 0.5 * (b0 + b1));
#else
  quad = pn_quad(light, maps, r, map, layer, node << level, (node + 1) << level);
  pn_Rectangle as_one = pn_Rectangle(quad.low, quad.high);
#if PN_PRIMITIVE == PN_QUAD
  one = one || leaf && quad.some;
#else
  one = one || leaf && quad.some && !quad.whole;
#endif
#endif
  if (one) most = least = as_one;
  bool done = pn_cover_and_ask(c, least.low, least.high, most.low, most.high, one);
  if (one) pn_search_done.z += 1.0;
#if PN_PRIMITIVE == PN_QUAD_EXACT
  if (!done && leaf && quad.whole) return PN_LEAF_QUAD;
#endif
  return done || leaf ? PN_SKIP : PN_DOWN;
}

// A step of the walk: down to the first child, or past all last children and then aside. False at the end. Blocks end
// with as many last children as their coordinates share ones at the low end; counted without a loop, whose turns
// would count too.
bool pn_walk(inout ivec2 node, inout int level, int top, ivec2 first, ivec2 last, bool down) {
  if (down) {
    level--;
    node <<= 1;
    return true;
  }
  int both = node.x & node.y, lowest_zero = ~both & (both + 1);
  int up = min((floatBitsToInt(float(lowest_zero)) >> 23) - 127, top - level);
  level += up;
  node >>= up;
  if (level < top) {
    node += (node.x & 1) == 0 ? ivec2(1, 0) : ivec2(-1, 1);
    return true;
  }
  node = node.x < last.x ? node + ivec2(1, 0) : ivec2(first.x, node.y + 1);
  return node.y <= last.y;
}

// Depth first over the blocks that the window touches, without a stack. A quad that is covered exactly takes a turn
// for each of its rows. Past PN_TURNS turns, over all layers and maps, blocks are looked at no closer.
void pn_descend(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r, int map, int layer,
                pn_Window window, float merge, inout pn_Cover c) {
  int extent = max(window.high.x - window.low.x, window.high.y - window.low.y), top = 0;
  while ((extent >> top) > 2) top++;
  ivec2 first = window.low >> top, last = window.high >> top;
  ivec2 node = first, rows = ivec2(0);
  int level = top;
  bool going = true;
  pn_Quad pending;
  while (going || rows.x < rows.y) {
    pn_search_turns++;
#if PN_PRIMITIVE == PN_QUAD_EXACT
    if (rows.x < rows.y) {
      pn_cover_quad_row(c, pending, rows.x);
      rows.x++;
      continue;
    }
#endif
    pn_search_done.y += 1.0;
    int what = pn_visit_block(light, maps, range, r, map, layer, node, level, merge, c, pending);
    bool down = what == PN_DOWN;
#if PN_PRIMITIVE == PN_QUAD_EXACT
    if (what == PN_LEAF_QUAD) rows = pn_quad_rows(pending);
#endif
    going = pn_walk(node, level, top, first, last, down) && !pn_is_full(c);
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

vec4 pn_search_report() { return pn_search_done; }
