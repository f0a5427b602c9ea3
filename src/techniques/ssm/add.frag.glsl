// A batch of micropatches, and the sum of those before it. Where the sum is in 32 bits, it can be drawn to where they
// cannot be blended.
#include "shaders/precision.glsl"
uniform highp sampler2D pn_sum;  // the sum
uniform highp sampler2D pn_batch; // the batch
layout(location = 0) out vec4 pn_out;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  pn_out = texelFetch(pn_sum, at, 0) + texelFetch(pn_batch, at, 0);
}
