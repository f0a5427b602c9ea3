// The list of smoothies: entry i is the edge before which there are i others, found by going down the sums.
#include "shaders/precision.glsl"
#include "techniques/smoothies/smoothie.glsl"

uniform highp sampler2D pn_sums_low; // among 64 edges, 64 of those, 64 of those
uniform highp sampler2D pn_sums_middle;
uniform highp sampler2D pn_sums_high;
uniform highp usampler2D pn_total;
layout(location = 0) out highp uvec4 pn_list_out;

// The entry, from first on, that holds place, which becomes the place within it.
#define PN_DESCEND(value) \
  for (int i = 0; i < most; i++, first++) { \
    int here = value; \
    if (place < here) break; \
    place -= here; \
  }

void main() {
  int place = int(gl_FragCoord.y) * PN_EDGE_ROW + int(gl_FragCoord.x);
  int total = int(texelFetch(pn_total, ivec2(0), 0).x / 12u), first = 0;
  int most = place < total ? pn_count.z : 0;
  PN_DESCEND(int(texelFetch(pn_sums_high, pn_entry(first), 0).r))
  first *= 64;
  most = min(most, 1) * 64;
  PN_DESCEND(int(texelFetch(pn_sums_middle, pn_entry(first), 0).r))
  first *= 64;
  PN_DESCEND(int(texelFetch(pn_sums_low, pn_entry(first), 0).r))
  first *= 64;
  PN_DESCEND((texelFetch(pn_corners, pn_entry(first), 0).x < pn_no_smoothie ? 1 : 0))
  pn_list_out = uvec4(uint(first), 0u, 0u, 0u);
}
