// A batch of micropatches onto the sum of those before (Soft Shadow Maps, appendix A, and the report it cites).
#include "shaders/precision.glsl"
uniform highp sampler2D pn_work;
layout(location = 0) out vec4 pn_out;

void main() { pn_out = texelFetch(pn_work, ivec2(gl_FragCoord.xy), 0); }
