// How many vertices a list has, as the arguments of two draws: of its micropatches, and of its rows.
#include "shaders/precision.glsl"
uniform highp usampler2D pn_counted; // the pyramid of counts
// first entry of this list, the most it holds, last level of the pyramid, list's width
uniform ivec4 pn_place;
layout(location = 0) out uvec4 pn_out;

void main() {
  uint total = texelFetch(pn_counted, ivec2(0), pn_place.z).r & 0x7fffffffu; // the highest bit is not of the count
  uint first = uint(pn_place.x), width = uint(pn_place.w);
  uint count = total > first ? min(total - first, uint(pn_place.y)) : 0u;
  uint quads = gl_FragCoord.x < 1.0 ? count : (count + width - 1u) / width;
  pn_out = uvec4(6u * quads, 1u, 0u, 0u);
}
