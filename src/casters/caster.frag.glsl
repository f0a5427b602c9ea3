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
#if PN_FLOOR
// Depth of the floor over window coordinates: what lies on it or below shadows nothing that is seen.
uniform vec4 pn_floor;
#endif

void main() {
#if PN_FLOOR
  if (gl_FragCoord.z >= dot(pn_floor.xyz, vec3(gl_FragCoord.xy, 1.0))) discard;
#endif
#if PN_PEEL
  pn_peel();
#endif
#if PN_ALPHA
  if (texture(pn_alpha, pn_texcoord)[pn_alpha_channel.x] < pn_alpha_cutoff.x) discard;
#endif
}
