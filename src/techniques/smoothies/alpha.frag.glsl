// A smoothie's texel in the notes' smoothie buffer: alpha and distance. Of smoothies that overlap the least alpha and
// the nearest distance are kept, each for itself; w grows towards the light, so it is stored negative.
#include "shaders/precision.glsl"
#include "techniques/smoothies/shape.glsl"

uniform highp ivec4 pn_mode; // tile
uniform highp sampler2DArray pn_maps;
layout(location = 0) out vec4 pn_out;

// From 0 at the edge to 1 where the smoothie ends.
float pn_alpha(float w) {
  float reach = pn_width.x > 0.0 ? 1.0 : max(w - pn_lights[0].w_reach, PN_TINY);
  return clamp(pn_kappa() / reach, 0.0, 1.0);
}

void main() {
  float w = pn_linear.z;
  // The map is read here, so it cannot be the pass's depth too.
  if (pn_map_fetch(0, pn_maps, pn_mode.x, 0, ivec2(gl_FragCoord.xy)) > w) discard;
  pn_out = vec4(pn_alpha(w), -w, 0.0, 0.0);
}
