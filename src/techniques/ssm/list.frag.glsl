// The list of micropatches: entry k is found by going down the pyramid of counts.
#include "shaders/precision.glsl"
#include "techniques/ssm/node.glsl"

uniform highp usampler2D pn_work; // the pyramid of counts
uniform ivec4 pn_place;           // first entry of this list, its width
layout(location = 0) out vec4 pn_out;
layout(location = 1) out vec4 pn_limits;

void main() {
  uint k = uint(pn_place.x) + uint(gl_FragCoord.y) * uint(pn_place.y) + uint(gl_FragCoord.x);
  int level = pn_levels.x - 1;
  ivec2 at = ivec2(0);
  pn_out = vec4(0.0);
  pn_limits = vec4(0.0);
  if (k >= texelFetch(pn_work, at, level).r) return;
  for (int i = 0; i < 16 && level > 0; i++) {
    uint own = texelFetch(pn_work, at, level).g;
    if (k < own) break;
    k -= own;
    level--;
    ivec2 last = textureSize(pn_work, level) - 1, child = 2 * at;
    for (int c = 0; c < 4; c++) {
      ivec2 candidate = 2 * at + ivec2(c & 1, c >> 1);
      if (any(greaterThan(candidate, last))) continue;
      uint count = texelFetch(pn_work, candidate, level).r;
      child = candidate;
      if (k < count) break;
      k -= count;
    }
    at = child;
  }
  pn_Patch p = pn_node(at, level);
  float scale = float(1 << level);
  pn_out = vec4(vec2(at) * scale, scale, p.w);
  pn_limits = vec4(p.most, p.above, p.least, 1.0);
}
