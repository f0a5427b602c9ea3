// Counts to visibility: the seen share of what is above the horizon, 1 where nothing is.
#include "shaders/precision.glsl"
uniform highp sampler2D pn_counts;
layout(location = 0) out vec4 pn_out;

void main() {
  vec2 counts = texelFetch(pn_counts, ivec2(gl_FragCoord.xy), 0).rg;
  pn_out = vec4(counts.y > 0.0 ? counts.x / counts.y : 1.0);
}
