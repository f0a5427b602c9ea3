// Finds the micro-primitives that can hide light from a receiver, in one layer of one map, and hands them to the technique's cover. The technique defines
// before this file: pn_Cover, pn_cover_rectangle, pn_cover_quad, pn_is_covered, pn_is_full, and the macros
//   PN_PRIMITIVE  what a texel stands for, see primitive.glsl
//   PN_GAPS       patches are widened to meet their left and lower neighbours
//   PN_DESCENT    1: adaptive descent of the range pyramid; 0: every texel of the window, or of a coarser level past the cap
//   PN_REFINE     what narrows the window first: 0 nothing, 1 the range pyramid, 2 the range stack
#include "search/window.glsl"

// What the search did, for looking at (docs/techniques/bitmask.md): class (0 not searched, 1 lit, 2 umbra, 3 penumbra), blocks visited,
// primitives covered, texels in the window.
vec4 pn_search_done = vec4(0.0);

struct pn_Window {
  ivec2 low, high; // texels, both included
  vec2 w;          // largest and smallest there
};

// ---- plane rejection over a box of (s, t, w), relative to the receiver --------------------------------------------------

// Least and greatest pn_plane_front, with the receiver's own uncertainty taken off and added.
vec2 pn_front_range(pn_Receiver r, vec2 low, vec2 high, float dw_least, float dw_most) {
  vec2 a = r.n.xy * low, b = r.n.xy * high;
  vec2 c = -r.k * vec2(dw_least, dw_most);
  float least = min(a.x, b.x) + min(a.y, b.y) + min(c.x, c.y);
  float most = max(a.x, b.x) + max(a.y, b.y) + max(c.x, c.y);
  vec2 lever = max(abs(low), abs(high));
  float slack = r.epsilon_plane + r.sigma * (lever.x + lever.y + r.reach * dw_most);
  return vec2(least, most) - slack;
}

// ---- single primitives ----------------------------------------------------------------------------------------------------

bool pn_texel_hides(int light, pn_Receiver r, int map, ivec2 texel, float w) {
  return pn_blocks(r, vec3(pn_map_st(light, map, vec2(texel) + 0.5), w));
}

// A block of texels, from low to high (map coordinates), at w: a micropatch, or the coarser one that stands for many.
void pn_add_patch(int light, pn_Receiver r, vec2 low, vec2 high, float w, inout pn_Cover c) {
  float dw = w - r.m.z;
  pn_cover_rectangle(c, pn_on_light(light, low - r.m.xy, dw), pn_on_light(light, high - r.m.xy, dw));
  pn_search_done.z += 1.0;
}

void pn_texel_patch(int light, highp sampler2DArray maps, pn_Receiver r, int map, int layer, ivec2 texel, inout pn_Cover c) {
  float w = pn_map_fetch(light, maps, map, layer, texel);
  if (w <= r.m.z + r.epsilon_w || !pn_texel_hides(light, r, map, texel, w)) return;
  vec2 low = pn_map_st(light, map, vec2(texel)) - r.m.xy, high = pn_map_st(light, map, vec2(texel) + 1.0) - r.m.xy;
  vec2 a = pn_on_light(light, low, w - r.m.z), b = pn_on_light(light, high, w - r.m.z);
#if PN_GAPS
  // Guennebaud et al. 2006: a neighbour nearer to the light ends, seen from the receiver, before this patch begins; the patch is drawn out to it.
  float left = pn_map_fetch(light, maps, map, layer, texel - ivec2(1, 0));
  float below = pn_map_fetch(light, maps, map, layer, texel - ivec2(0, 1));
  if (left > r.m.z + r.epsilon_w && pn_texel_hides(light, r, map, texel - ivec2(1, 0), left)) {
    float x = pn_on_light(light, low, left - r.m.z).x;
    a.x = min(a.x, x);
    b.x = max(b.x, x);
  }
  if (below > r.m.z + r.epsilon_w && pn_texel_hides(light, r, map, texel - ivec2(0, 1), below)) {
    float y = pn_on_light(light, low, below - r.m.z).y;
    a.y = min(a.y, y);
    b.y = max(b.y, y);
  }
#endif
  pn_cover_rectangle(c, a, b);
  pn_search_done.z += 1.0;
}

// The quad from this texel's centre to that of its right upper neighbour: only where all four corners hide light (section 4).
void pn_texel_quad(int light, highp sampler2DArray maps, pn_Receiver r, int map, int layer, ivec2 texel, inout pn_Cover c) {
  float w[4];
  for (int i = 0; i < 4; i++) {
    ivec2 corner = texel + ivec2(i & 1, i >> 1);
    w[i] = pn_map_fetch(light, maps, map, layer, corner);
    if (w[i] <= r.m.z + r.epsilon_w || !pn_texel_hides(light, r, map, corner, w[i])) return;
  }
  vec2 low = pn_map_st(light, map, vec2(texel) + 0.5) - r.m.xy, high = pn_map_st(light, map, vec2(texel) + 1.5) - r.m.xy;
  pn_cover_quad(c, pn_on_light(light, low, w[0] - r.m.z), pn_on_light(light, vec2(high.x, low.y), w[1] - r.m.z),
                pn_on_light(light, vec2(low.x, high.y), w[2] - r.m.z), pn_on_light(light, high, w[3] - r.m.z));
  pn_search_done.z += 1.0;
}

void pn_texel_primitive(int light, highp sampler2DArray maps, pn_Receiver r, int map, int layer, ivec2 texel, inout pn_Cover c) {
#if PN_PRIMITIVE == PN_PATCH
  pn_texel_patch(light, maps, r, map, layer, texel, c);
#else
  pn_texel_quad(light, maps, r, map, layer, texel, c);
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

// ---- the window -------------------------------------------------------------------------------------------------------------

// Texels within reach of casters up to w. Tiles leave their border to their neighbours.
void pn_window_texels(int light, pn_Receiver r, int map, float w, out ivec2 low, out ivec2 high) {
  vec2 window = pn_search_window(pn_extent(light), w, r.m.z);
  int border = pn_map_count(light) > 1 ? 1 : 0;
#if PN_PRIMITIVE == PN_PATCH
  const float shift = 0.0;
#else
  const float shift = 0.5; // a quad lies between the centres of its texel and the next
#endif
  low = max(ivec2(floor(pn_map_texel(light, map, r.m.xy - window) - shift)), ivec2(border));
  high = min(ivec2(floor(pn_map_texel(light, map, r.m.xy + window) - shift)), pn_map_size(light) - 1 - border);
}

#if PN_REFINE == 2
// The range stack keeps its levels as array layers: level i holds largest and smallest w of the 2^i x 2^i texels centred on each texel.
vec2 pn_stack_at(int light, highp sampler2DArray stack, int map, int layer, int level, ivec2 texel) {
  int levels = textureSize(stack, 0).z / (pn_map_count(light) * pn_map_layers(light));
  ivec2 at = clamp(texel, ivec2(0), pn_map_size(light) - 1);
  return texelFetch(stack, ivec3(at, (map * pn_map_layers(light) + layer) * levels + level), 0).rg;
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
    int level = pn_stack_level(extent + 1); // the centre of a neighbourhood of even size is half a texel off
    return pn_stack_at(light, stack, map, layer, level, (low + high + 1) / 2);
  }
  // Section 5: four neighbourhoods of half the size, pushed into the window's corners.
  int level = pn_stack_level((extent + 1) / 2);
  int before = (1 << level) / 2, after = (1 << level) - before - 1; // texels of a neighbourhood before and after its centre
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
pn_Window pn_find_window(int light, highp sampler2DArray range, pn_Receiver r, int map, int layer) {
  pn_Window window;
  window.w = vec2(pn_lights[light].range.x, PN_NOTHING);
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
bool pn_is_umbra(int light, pn_Receiver r, int map, pn_Window window) {
  if (window.w.y <= r.m.z + r.epsilon_w) return false;
  vec2 reach = pn_search_window(pn_extent(light), window.w.x, r.m.z);
  vec2 low = pn_block_st(light, map, window.low) - r.m.xy, high = pn_block_st(light, map, window.high + 1) - r.m.xy;
  bool inside = all(lessThanEqual(low, -reach)) && all(greaterThanEqual(high, reach)); // not cut off by the map's border
  return inside && pn_front_range(r, low, high, window.w.y - r.m.z, window.w.x - r.m.z).x > 0.0;
}

// ---- every texel ---------------------------------------------------------------------------------------------------------------

#if !PN_DESCENT
// Texels of a row that one turn of the loop takes: software GL ends a shader's loops after 65535 turns in all.
#define PN_ROW 8
#define PN_TEXELS_MAX 360000

// A texel of a coarser level past the cap, on the pyramid's fixed grid: nearest surface of its block, as one patch (section 5).
void pn_coarse_patch(int light, highp sampler2DArray range, pn_Receiver r, int map, int layer, ivec2 block, int level, inout pn_Cover c) {
#if PN_REFINE == 2
  vec2 w = pn_stack_at(light, range, map, layer, level, (block << level) + ((1 << level) >> 1));
#else
  vec2 w = texelFetch(range, ivec3(block, map * pn_map_layers(light) + layer), level - 1).rg;
#endif
  float dw = w.x - r.m.z;
  if (dw <= r.epsilon_w) return;
  ivec2 first = block << level, last = min((block + 1) << level, pn_map_size(light));
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

void pn_scan(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_Receiver r, int map, int layer, pn_Window window,
             int cap, inout pn_Cover c) {
  int level = pn_level_for(window.high - window.low + 1, cap);
  ivec2 first = window.low >> level, last = window.high >> level;
  for (int y = first.y; y <= last.y; y++)
    for (int x = first.x; x <= last.x; x += PN_ROW)
      for (int i = 0; i < PN_ROW; i++) {
        ivec2 at = ivec2(x + i, y);
        if (at.x > last.x) continue;
        pn_search_done.y += 1.0;
        if (level == 0)
          pn_texel_primitive(light, maps, r, map, layer, at, c);
        else
          pn_coarse_patch(light, range, r, map, layer, at, level, c);
      }
}
#endif

// ---- adaptive descent --------------------------------------------------------------------------------------------------------------

#if PN_DESCENT
// One block of the pyramid. Returns whether its children must be looked at.
bool pn_visit_block(int light, highp sampler2DArray range, pn_Receiver r, int map, int layer, ivec2 node, int level, float merge,
                    inout pn_Cover c) {
  vec2 w = texelFetch(range, ivec3(node, map * pn_map_layers(light) + layer), level).rg;
  float dw_most = w.x - r.m.z;
  if (dw_most <= r.epsilon_w) return false; // nothing nearer than the receiver
  vec2 extent = pn_extent(light);
  vec2 low = pn_block_st(light, map, node << (level + 1)) - r.m.xy;
  vec2 high = pn_block_st(light, map, (node + 1) << (level + 1)) - r.m.xy;
  if (any(greaterThan(low, extent * dw_most)) || any(lessThan(high, -extent * dw_most))) return false; // beside the light
  float dw_least = max(w.y - r.m.z, r.epsilon_w);
  vec2 front = pn_front_range(r, low, high, dw_least, dw_most);
  if (front.y <= 0.0) return false; // behind the receiver's tangent plane
  // Where the block's edges fall on the light, at its nearest and at its farthest.
  vec2 a0 = clamp(pn_on_light(light, low, dw_most), 0.0, 1.0), a1 = clamp(pn_on_light(light, low, dw_least), 0.0, 1.0);
  vec2 b0 = clamp(pn_on_light(light, high, dw_most), 0.0, 1.0), b1 = clamp(pn_on_light(light, high, dw_least), 0.0, 1.0);
  if (pn_is_covered(c, min(a0, a1), max(b0, b1))) return false;
  bool all_hide = w.y - r.m.z > r.epsilon_w && front.x > 0.0;
  vec2 moved = max(abs(a0 - a1), abs(b0 - b1));
  if (!all_hide || max(moved.x, moved.y) > merge) return true;
  pn_cover_rectangle(c, 0.5 * (a0 + a1), 0.5 * (b0 + b1));
  pn_search_done.z += 1.0;
  return false;
}

// Depth first over the blocks that the window touches, without a stack: from a last child up, from any other to the next one. Level -1 are texels.
void pn_descend(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_Receiver r, int map, int layer, pn_Window window,
                float merge, inout pn_Cover c) {
  int extent = max(window.high.x - window.low.x, window.high.y - window.low.y), top = 0;
  while ((extent >> (top + 1)) > 2) top++;
  ivec2 first = window.low >> (top + 1), last = window.high >> (top + 1);
  ivec2 node = first;
  int level = top;
  for (int turn = 0; turn < 60000; turn++) { // software GL ends a shader's loops after 65535 turns
    bool down;
    pn_search_done.y += 1.0;
    if (level >= 0) {
      down = pn_visit_block(light, range, r, map, layer, node, level, merge, c);
    } else {
      pn_texel_primitive(light, maps, r, map, layer, node, c);
      down = false;
    }
    if (down) {
      level--;
      node <<= 1;
      continue;
    }
    // To the next block in this order: past all last children, then aside.
    int both = node.x & node.y, up = 0;
    while (level + up < top && (both >> up & 1) == 1) up++;
    level += up;
    node >>= up;
    if (level < top) {
      node = (node.x & 1) == 0 ? node + ivec2(1, 0) : node + ivec2(-1, 1);
    } else {
      node.x++;
      if (node.x > last.x) node = ivec2(first.x, node.y + 1);
      if (node.y > last.y || pn_is_full(c)) break;
    }
  }
}
#endif

// ---- one layer of one map --------------------------------------------------------------------------------------------------------------

void pn_search(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_Receiver r, int map, int layer, inout pn_Cover c) {
  pn_Window window = pn_find_window(light, range, r, map, layer);
  pn_search_done.x = max(pn_search_done.x, 1.0);
  if (any(lessThan(window.high, window.low)) || window.w.x <= r.m.z + r.epsilon_w) return; // lit, as far as this layer goes
  pn_search_done.w += float((window.high.x - window.low.x + 1) * (window.high.y - window.low.y + 1));
  if (pn_is_umbra(light, r, map, window)) {
    pn_cover_rectangle(c, vec2(0.0), vec2(1.0));
    pn_search_done.x = max(pn_search_done.x, 2.0);
    return;
  }
  pn_search_done.x = 3.0;
#if PN_DESCENT
  pn_descend(light, maps, range, r, map, layer, window, 0.01 * pn_parameter(light, PN_MERGE), c);
#else
  pn_scan(light, maps, range, r, map, layer, window, int(pn_parameter(light, PN_CAP)), c);
#endif
}

vec4 pn_search_report() { return pn_search_done; }
