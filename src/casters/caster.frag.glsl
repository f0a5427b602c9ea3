#include "shaders/precision.glsl"
#if PN_PEEL
#include "casters/peel.glsl"
#endif
#if PN_ALPHA
in highp vec2 pn_texcoord;
uniform sampler2D pn_alpha;
uniform ivec4 pn_alpha_channel; // channel
uniform vec4 pn_alpha_cutoff;   // cutoff
#endif

void main() {
#if PN_PEEL
  pn_peel();
#endif
#if PN_ALPHA
  if (texture(pn_alpha, pn_texcoord)[pn_alpha_channel.x] < pn_alpha_cutoff.x) discard;
#endif
}
