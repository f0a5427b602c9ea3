// A smoothie's texel in the notes' smoothie buffer: alpha and distance. Of smoothies that overlap the least alpha and
// the nearest distance are kept, each for itself; w grows towards the light, so it is stored negative.
#include "shaders/precision.glsl"
#include "techniques/smoothies/shape.glsl"

uniform highp ivec4 pn_mode; // tile; _; 1 for remapped alpha
uniform highp sampler2DArray pn_maps;
layout(location = 0) out vec4 pn_out;

// From 0 at the edge to 1 where the smoothie ends.
float pn_alpha(float w) {
  return pn_kappa() / (pn_width.x > 0.0 ? 1.0 : max(w - pn_lights[0].w_reach, PN_TINY));
}

// For the receiver at w_r: alpha / (1 - b / r), where under a sun b and r count from the nearest caster's plane.
float pn_remapped(float w, float w_r) {
  float from = pn_is_parallel(0) ? pn_w_near(0) - w_r : w;
  return pn_kappa() * (pn_width.x > 0.0 ? from : 1.0) / max(w - w_r, PN_TINY);
}

void main() {
  float w = pn_linear.z;
  // The map is read here, so it cannot be the pass's depth too.
  float w_r = pn_map_fetch(0, pn_maps, pn_mode.x, 0, ivec2(gl_FragCoord.xy));
  if (w_r > w) discard;
  if (pn_is_nothing(w_r)) w_r = pn_lights[0].w_reach; // the receiver casts nothing; it is not farther than this
  pn_out = vec4(clamp(pn_mode.z != 0 ? pn_remapped(w, w_r) : pn_alpha(w), 0.0, 1.0), -w, 0.0, 0.0);
}
