// Largest and smallest w of neighbourhoods, the smallest beside what is empty (PN_EVERYTHING where all is), and the
// gaps in depth (gaps.glsl); the last two where the image has channels for them. A pyramid's level takes 2 x 2 texels
// of the one below; a stack's level four texels of the one below, half a neighbourhood apart (Bitmask Soft Shadows,
// Fig. 7). The first level reads the depth map. Over quads gaps are those between a texel and its right and upper
// neighbours; with PN_CORNERS the ranges are over these four, too, as the descent wants its blocks.
#include "shaders/precision.glsl"
#include "space/limits.glsl"
#if PN_FIRST
#include "maps/maps.glsl"
uniform highp sampler2DArray pn_maps;
#if PN_QUADS
#include "maps/find_gaps.glsl"
#endif
#else
uniform highp sampler2DArray pn_range;
#endif
uniform ivec4 pn_source; // layer in the array of maps, level drawn, map, layer in the map
uniform ivec4 pn_place;  // stack: array layer of the level below, level drawn; where in the image it begins
#if !PN_FIRST
uniform ivec4 pn_region; // of the level below: where in the image it begins, size
#endif
layout(location = 0) out vec4 pn_out;

vec4 pn_join(vec4 a, vec4 b) { return vec4(max(a.x, b.x), min(a.yzw, b.yzw)); }

#if PN_FIRST
float pn_there(float w) { return w > PN_NOTHING ? w : PN_EVERYTHING; }

// Beyond the map nothing is, and the smallest w says so too.
float pn_w_at(ivec2 at) { return pn_map_fetch(0, pn_maps, pn_source.z, pn_source.w, at); }
float pn_w_of(ivec2 at, float depth) {
  return pn_map_inside(0, pn_source.z, at) ? pn_map_w(0, pn_source.z, depth) : PN_NOTHING;
}

#if PN_QUADS
// A block of 4 x 4 around a quad, but for its corners.
#ifdef PN_GATHER
void pn_block_of(ivec2 at, out float w[16]) {
  float layer = float(pn_array_layer(0, pn_source.z, pn_source.w));
  for (int i = 0; i < 4; i++) {
    ivec2 part = ivec2(2 * (i & 1), i & 2), texel = at - 1 + part;
    vec4 depth = textureGather(pn_maps, vec3(vec2(texel + 1) / vec2(textureSize(pn_maps, 0).xy), layer));
    int first = 4 * part.y + part.x;
    w[first] = pn_w_of(texel, depth.w);
    w[first + 1] = pn_w_of(texel + ivec2(1, 0), depth.z);
    w[first + 4] = pn_w_of(texel + ivec2(0, 1), depth.x);
    w[first + 5] = pn_w_of(texel + 1, depth.y);
  }
}
#else
void pn_block_of(ivec2 at, out float w[16]) {
  for (int i = 0; i < 16; i++) w[i] = (0x9009 >> i & 1) != 0 ? PN_NOTHING : pn_w_at(at + ivec2(i % 4, i / 4) - 1);
}
#endif

vec4 pn_range_of(ivec2 at) {
  float w[16];
  pn_block_of(at, w);
  vec4 corners = vec4(w[5], w[6], w[9], w[10]);
  vec2 two = max(corners.xy, corners.zw);
  if (max(two.x, two.y) <= PN_NOTHING) return vec4(PN_NOTHING, PN_NOTHING, PN_EVERYTHING, PN_NO_GAP);
  vec2 least = min(corners.xy, corners.zw);
  float there = min(min(pn_there(w[5]), pn_there(w[6])), min(pn_there(w[9]), pn_there(w[10])));
  float gaps = pn_find_gaps(0, pn_maps, pn_source.z, at, w);
#if PN_CORNERS
  return vec4(max(two.x, two.y), min(least.x, least.y), there, gaps);
#else
  return vec4(w[5], w[5], pn_there(w[5]), gaps);
#endif
}
#else
vec4 pn_range_of(ivec2 at) {
  float w = pn_w_at(at);
  return vec4(w, w, pn_there(w), 0.0);
}
#endif
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
#if PN_FIRST
  vec4 range = pn_range_of(at);
#elif PN_STACK
  // Level i lies centred: from 2^(i-1) before the texel to 2^(i-1) - 1 after it. Its four parts of level i - 1 are
  // centred a quarter aside; the first level's parts are the texel and those before it. The border is clamped.
  at -= pn_place.zw;
  ivec2 last = pn_region.zw - 1;
  int step = pn_place.y > 1 ? 1 << (pn_place.y - 2) : 0;
  ivec2 a = clamp(at - (pn_place.y > 1 ? step : 1), ivec2(0), last), b = clamp(at + step, ivec2(0), last);
  a += pn_region.xy;
  b += pn_region.xy;
  vec4 range = texelFetch(pn_range, ivec3(a, pn_place.x), 0);
  range = pn_join(range, texelFetch(pn_range, ivec3(b.x, a.y, pn_place.x), 0));
  range = pn_join(range, texelFetch(pn_range, ivec3(a.x, b.y, pn_place.x), 0));
  range = pn_join(range, texelFetch(pn_range, ivec3(b, pn_place.x), 0));
#else
  at -= pn_place.zw;
  ivec2 last = pn_region.zw - 1;
  vec4 range = vec4(PN_NOTHING, vec3(PN_EVERYTHING));
  for (int i = 0; i < 4; i++) {
    ivec2 texel = pn_region.xy + min(2 * at + ivec2(i & 1, i >> 1), last);
    range = pn_join(range, texelFetch(pn_range, ivec3(texel, pn_source.x), 0));
  }
#endif
  pn_out = range;
}
