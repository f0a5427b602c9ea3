// Depth as w, for reading back: depth itself cannot be read everywhere.
#include "shaders/precision.glsl"
#include "space/limits.glsl"
uniform highp sampler2D pn_map;
uniform vec4 pn_w_of_depth; // w at depth 0, w per depth
layout(location = 0) out vec4 pn_out;

void main() {
  float depth = texelFetch(pn_map, ivec2(gl_FragCoord.xy), 0).r;
  pn_out = vec4(depth <= 0.0 || depth >= 1.0 ? PN_NOTHING : pn_w_of_depth.x + pn_w_of_depth.y * depth);
}
