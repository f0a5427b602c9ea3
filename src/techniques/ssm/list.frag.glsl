// The list of micropatches: entry k is found by going down the pyramid of counts.
#include "shaders/precision.glsl"
#include "techniques/ssm/node.glsl"

uniform highp usampler2D pn_counted; // the pyramid of counts
uniform ivec4 pn_place;           // first entry of this list, its width, its height
layout(location = 0) out vec4 pn_out;
layout(location = 1) out vec4 pn_limits;

// The child that entry k of a node's children lies in; k becomes its place there.
ivec2 pn_child(ivec2 at, int level, inout uint k) {
  // From the first level: software GL answers a size for one level to all pixels of a group.
  ivec2 last = max(textureSize(pn_counted, 0) >> level, 1) - 1, child = 2 * at;
  bool found = false;
  for (int c = 0; c < 4; c++) {
    ivec2 candidate = 2 * at + ivec2(c & 1, c >> 1);
    uint count = pn_count(texelFetch(pn_counted, min(candidate, last), level).r);
    count = any(greaterThan(candidate, last)) ? 0u : count;
    bool here = !found && k < count;
    child = here ? candidate : child;
    k -= found || here ? 0u : count;
    found = found || here;
  }
  return child;
}

void main() {
  uint k = uint(pn_place.x) + uint(gl_FragCoord.y) * uint(pn_place.y) + uint(gl_FragCoord.x);
  int level = pn_levels.x - 1;
  ivec2 at = ivec2(0);
  pn_out = vec4(0.0);
  pn_limits = vec4(0.0);
  int found = k < pn_count(texelFetch(pn_counted, at, level).r) ? 1 : 0;
  // Selections instead of jumps: pixels of one loop go down to different levels.
  bool down = true;
  for (int i = 1; i < pn_levels.x * found; i++) {
    uint own = pn_own(texelFetch(pn_counted, at, level).r);
    down = down && k >= own;
    if (down) {
      k -= own;
      level--;
      at = pn_child(at, level, k);
    }
  }
  // A loop, not a condition: software GL runs through both sides of a condition, but not through a loop of no turns.
  for (int i = 0; i < found; i++) {
    pn_Patch p = pn_node(at, level);
    pn_node_reach(p);
    float scale = float(1 << level);
    pn_out = vec4(vec2(at) * scale, scale, p.w);
    pn_limits = vec4(p.most, p.above, p.least, 1.0);
  }
}
