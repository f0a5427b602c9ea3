// The list of smoothies: entry i is the edge before which there are i others, found by going down the sums.
#include "shaders/precision.glsl"
#include "techniques/smoothies/smoothie.glsl"

uniform highp ivec4 pn_count;        // entries of the highest sums
uniform highp sampler2D pn_kept;      // 1 for silhouettes that have a smoothie

uniform highp sampler2D pn_sums_low; // among 64 edges, 64 of those, 64 of those
uniform highp sampler2D pn_sums_middle;
uniform highp sampler2D pn_sums_high;
uniform highp usampler2D pn_total;
layout(location = 0) out highp uvec4 pn_list_out;

// The entry of a level, from first on, that holds place, which becomes the place within it.
void pn_descend(sampler2D sums, int most, inout int first, inout int place) {
  for (int i = 0; i < most; i++, first++) {
    int here = int(texelFetch(sums, pn_entry(first), 0).r);
    if (place < here) break;
    place -= here;
  }
}

void main() {
  int place = int(gl_FragCoord.y) * PN_EDGE_ROW + int(gl_FragCoord.x);
  int total = int(texelFetch(pn_total, ivec2(0), 0).x / 12u), first = 0;
  bool some = place < total;
  pn_descend(pn_sums_high, some ? pn_count.x : 0, first, place);
  first *= 64;
  pn_descend(pn_sums_middle, some ? 64 : 0, first, place);
  first *= 64;
  pn_descend(pn_sums_low, some ? 64 : 0, first, place);
  first *= 64;
  for (int i = 0; i < (some ? 64 : 0); i++, first++) {
    if (texelFetch(pn_kept, pn_entry(first), 0).r < 0.5) continue;
    if (place == 0) break;
    place--;
  }
  pn_list_out = uvec4(uint(first), 0u, 0u, 0u);
}
