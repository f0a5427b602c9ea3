// The draw's arguments: twelve vertices for each smoothie.
#include "shaders/precision.glsl"
uniform highp sampler2D pn_below; // sums of the highest level
uniform highp ivec4 pn_count;    // entries there
layout(location = 0) out highp uvec4 pn_count_out;

void main() {
  float sum = 0.0;
  for (int i = 0; i < pn_count.x; i++) sum += texelFetch(pn_below, ivec2(i, 0), 0).r;
  pn_count_out = uvec4(12u * uint(sum), 1u, 0u, 0u);
}
