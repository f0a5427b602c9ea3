// A texel of the receiver map, as the vertex shader made it.
#include "shaders/precision.glsl"
flat in vec4 pn_texel;
layout(location = 0) out vec4 pn_out;

void main() { pn_out = pn_texel; }
