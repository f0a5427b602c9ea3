// Largest and smallest w of neighbourhoods, and the smallest beside what is empty (PN_EVERYTHING where all is;
// pyramids of three channels keep it). A pyramid's level takes 2 x 2 texels of the one below; a stack's level four
// texels of the one below, half a neighbourhood apart (Bitmask Soft Shadows, Fig. 7). The first level reads the depth
// map; over quads each texel there stands for itself and its right and upper neighbours.
#include "shaders/precision.glsl"
#include "space/limits.glsl"
#if PN_FIRST
#include "maps/maps.glsl"
uniform highp sampler2DArray pn_maps;
#else
uniform highp sampler2DArray pn_range;
#endif
uniform ivec4 pn_source; // layer in the array of maps, level drawn, map, layer in the map
uniform ivec4 pn_place;  // stack: array layer of the level below, level drawn
layout(location = 0) out vec4 pn_out;

vec3 pn_join(vec3 a, vec3 b) { return vec3(max(a.x, b.x), min(a.yz, b.yz)); }

#if PN_FIRST
// Beyond the map nothing is, and the smallest w says so too.
vec3 pn_texels(ivec2 at, int size) {
  vec3 range = vec3(PN_NOTHING, PN_EVERYTHING, PN_EVERYTHING);
  for (int y = 0; y < size; y++)
    for (int x = 0; x < size; x++) {
      float w = pn_map_fetch(0, pn_maps, pn_source.z, pn_source.w, at + ivec2(x, y));
      range = pn_join(range, vec3(w, w, w > PN_NOTHING ? w : PN_EVERYTHING));
    }
  return range;
}
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
#if PN_FIRST
  vec3 range = pn_texels(at, PN_QUADS + 1);
#elif PN_STACK
  // Level i lies centred: from 2^(i-1) before the texel to 2^(i-1) - 1 after it. Its four parts of level i - 1 are
  // centred a quarter aside; the first level's parts are the texel and those before it. The border is clamped.
  ivec2 last = textureSize(pn_range, 0).xy - 1;
  int step = pn_place.y > 1 ? 1 << (pn_place.y - 2) : 0;
  ivec2 a = clamp(at - (pn_place.y > 1 ? step : 1), ivec2(0), last), b = clamp(at + step, ivec2(0), last);
  vec3 range = texelFetch(pn_range, ivec3(a, pn_place.x), 0).rgb;
  range = pn_join(range, texelFetch(pn_range, ivec3(b.x, a.y, pn_place.x), 0).rgb);
  range = pn_join(range, texelFetch(pn_range, ivec3(a.x, b.y, pn_place.x), 0).rgb);
  range = pn_join(range, texelFetch(pn_range, ivec3(b, pn_place.x), 0).rgb);
#else
  ivec2 last = textureSize(pn_range, 0).xy - 1;
  vec3 range = vec3(PN_NOTHING, PN_EVERYTHING, PN_EVERYTHING);
  for (int i = 0; i < 4; i++)
    range = pn_join(range, texelFetch(pn_range, ivec3(min(2 * at + ivec2(i & 1, i >> 1), last), pn_source.x), 0).rgb);
#endif
  pn_out = vec4(range, 1.0);
}
