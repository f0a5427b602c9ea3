// How many smoothies there are among 64 edges, then among 64 of those, and so on: what each place in their list is
// found by.
#include "shaders/precision.glsl"
uniform highp sampler2D pn_below; // 1 for edges that have one; the sums below
uniform highp ivec4 pn_count;     // entries there
layout(location = 0) out vec4 pn_sum_out;

void main() {
  int first = 64 * (int(gl_FragCoord.y) * PN_EDGE_ROW + int(gl_FragCoord.x));
  float sum = 0.0;
  for (int i = first; i < min(first + 64, pn_count.x); i++)
    sum += texelFetch(pn_below, ivec2(i & (PN_EDGE_ROW - 1), i / PN_EDGE_ROW), 0).r;
  pn_sum_out = vec4(sum);
}
