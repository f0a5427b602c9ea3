// One node of an occluder map's range pyramid as a micropatch.
//   PN_TILES  the light has several maps
#include "techniques/ssm/patches.glsl"

uniform highp sampler2DArray pn_range;      // of the occluder maps
uniform highp sampler2DArray pn_seen_range; // of the receiver map
uniform ivec4 pn_source;                    // layer in the array, level, layer of the receiver map, map
uniform ivec4 pn_levels; // of the occluders' pyramid, of the receivers'; receiver map's width, height
uniform vec4 pn_share;   // how far merging may move an edge, as a share of the light's width, 0: none; 1: for pairs

// With several maps the light's tiles overlap by their borders: a node belongs to the map its corners lie in.
bool pn_node_owned(vec4 texels) {
#if !PN_TILES
  return true;
#else
  return pn_map_at(0, pn_map_st(0, pn_source.w, texels.xy + 0.5)) == pn_source.w &&
         pn_map_at(0, pn_map_st(0, pn_source.w, texels.zw - 0.5)) == pn_source.w;
#endif
}

// The limit of a node that may be a patch at all; nothing lies below the others'.
float pn_node_limit(ivec2 at, int level, vec4 texels) {
  if (level >= pn_levels.x || (level > 0 && pn_share.x <= 0.0)) return PN_NOTHING;
  if (any(greaterThan(texels.zw, vec2(pn_map_size(0, pn_source.w))))) return PN_NOTHING; // partly beside the map
  vec2 range = texelFetch(pn_range, ivec3(at, pn_source.x), level).rg;
  return pn_patch_full(range) && pn_node_owned(texels) ? pn_patch_limit(range, pn_share.x) : PN_NOTHING;
}

vec4 pn_node_texels(ivec2 at, int level) { return vec4(vec2(at), vec2(at) + 1.0) * float(1 << level); }

// Eq. 3 speaks of pairs: the texel, and its right and upper neighbours.
float pn_pairs_reach(ivec2 at, float w) {
  ivec2 last = textureSize(pn_range, 0).xy - 1;
  float right = texelFetch(pn_range, ivec3(min(at + ivec2(1, 0), last), pn_source.x), 0).r;
  float upper = texelFetch(pn_range, ivec3(min(at + ivec2(0, 1), last), pn_source.x), 0).r;
  return max(w, max(right, upper));
}

// The node as a patch, but for the receivers around it.
pn_Patch pn_node(ivec2 at, int level) {
  pn_Patch p;
  vec4 texels = pn_node_texels(at, level);
  vec2 range = texelFetch(pn_range, ivec3(at, pn_source.x), level).rg;
  p.w = 0.5 * (range.x + range.y);
  p.most = pn_node_limit(at, level, texels);
  p.above = pn_node_limit(at >> 1, level + 1, pn_node_texels(at >> 1, level + 1));
  p.rectangle = vec4(pn_map_st(0, pn_source.w, texels.xy), pn_map_st(0, pn_source.w, texels.zw));
  p.drawn = !pn_is_nothing(p.most);
  p.reach = pn_share.y > 0.0 ? pn_pairs_reach(at, p.w) : p.w;
  p.least = 0.0;
  return p;
}

// A node's texel: how many micropatches there are in and below it, and whether it is one, in the highest bit.
uint pn_counts(uint count, uint own) { return count | own << 31; }
uint pn_count(uint counts) { return counts & 0x7fffffffu; }
uint pn_own(uint counts) { return counts >> 31; }

// w of the farthest receiver in the layer; PN_EVERYTHING where there is none.
float pn_farthest_seen() { return texelFetch(pn_seen_range, ivec3(0, 0, pn_source.z), pn_levels.y - 1).g; }

// Which receivers it reaches: first out to the farthest there is, then to the farthest one found on the way.
void pn_node_reach(inout pn_Patch p) {
  ivec2 size = pn_levels.zw;
  vec2 seen = vec2(p.most, max(pn_farthest_seen(), p.above));
  for (int i = 0; i < 2 && p.drawn; i++) {
    vec2 reach = pn_penumbra_extent(pn_extent(0), p.reach, seen.y);
    vec2 low = p.rectangle.xy - reach, high = p.rectangle.zw + reach;
    seen = pn_seen_between(pn_seen_range, pn_source.z, low, high, size, pn_levels.y);
    p.drawn = seen.y <= p.most && seen.x > p.above;
    seen.y = max(seen.y, p.above);
  }
  p.least = seen.y;
}
