// A level of the pyramid of counts: how many micropatches there are in and below each node of the occluder map's
// range pyramid, and whether the node is one itself. With the counts, the list that is drawn is found from its indices
// (a histogram pyramid), so empty texels cost nothing after this.
#include "shaders/precision.glsl"
#include "techniques/ssm/node.glsl"

#if !PN_FIRST
uniform highp usampler2D pn_counted; // the level below
#endif
layout(location = 0) out uvec4 pn_out;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  // Nothing is here, and the target says so already; leaving costs less than any condition.
  float nearest = texelFetch(pn_range, ivec3(at, pn_source.x), pn_source.y).r;
  if (pn_is_nothing(-pn_farthest_seen()) || pn_is_nothing(nearest)) discard;
  pn_Patch p = pn_node(at, pn_source.y);
  pn_node_reach(p);
  uint own = p.drawn ? 1u : 0u, count = own;
#if !PN_FIRST
  ivec2 last = textureSize(pn_counted, 0) - 1;
  for (int i = 0; i < 4; i++) {
    ivec2 child = 2 * at + ivec2(i & 1, i >> 1);
    if (all(lessThanEqual(child, last))) count += pn_count(texelFetch(pn_counted, child, 0).r);
  }
#endif
  pn_out = uvec4(pn_counts(count, own), 0u, 0u, 0u);
}
