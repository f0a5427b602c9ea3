// How many vertices a list has, as the arguments of a draw.
#include "shaders/precision.glsl"
uniform highp usampler2D pn_work; // the pyramid of counts
uniform ivec4 pn_place;           // first entry of this list, the most it holds, last level of the pyramid
layout(location = 0) out uvec4 pn_out;

void main() {
  uint total = texelFetch(pn_work, ivec2(0), pn_place.z).r, first = uint(pn_place.x);
  uint count = total > first ? min(total - first, uint(pn_place.y)) : 0u;
  pn_out = uvec4(6u * count, 1u, 0u, 0u);
}
