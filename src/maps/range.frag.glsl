// The range pyramid: the largest and smallest w of 2 x 2 texels of the level below; the first level reads the depth map.
#include "shaders/precision.glsl"
#if PN_FIRST
#include "maps/maps.glsl"
uniform highp sampler2DArray pn_maps;
#else
uniform highp sampler2DArray pn_range;
#endif
uniform ivec4 pn_source; // array layer, level below, map, layer in the map
layout(location = 0) out vec4 pn_out;

void main() {
  ivec2 base = ivec2(gl_FragCoord.xy) * 2;
  vec2 range = vec2(-1e30, 1e30);
  for (int i = 0; i < 4; i++) {
    ivec2 at = base + ivec2(i & 1, i >> 1);
#if PN_FIRST
    // A border beyond the map holds nothing, and says so in its smallest w too.
    float w = pn_map_fetch(0, pn_maps, pn_source.z, pn_source.w, at);
    vec2 below = vec2(w);
#else
    ivec2 last = textureSize(pn_range, pn_source.y).xy - 1;
    vec2 below = texelFetch(pn_range, ivec3(min(at, last), pn_source.x), pn_source.y).rg;
#endif
    range = vec2(max(range.x, below.x), min(range.y, below.y));
  }
  pn_out = vec4(range, 0.0, 1.0);
}
