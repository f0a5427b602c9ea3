// A smoothie's texel in the notes' smoothie buffer: alpha and distance. Of smoothies that overlap the least alpha and
// the nearest distance are kept, each for itself; w grows towards the light, so it is stored negative.
#include "shaders/precision.glsl"
#include "techniques/smoothies/shape.glsl"

uniform highp ivec4 pn_mode; // tile; _; 1 for remapped alpha
uniform highp sampler2DArray pn_maps;
uniform highp vec4 pn_ground; // below all that is seen: w = z + x s + y t; w: 1 where that is known
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

// The surface that the light sees through the texel. Where none casts there, what receives lies no farther than this.
float pn_receiver_w(ivec2 texel) {
  float w = pn_map_fetch(0, pn_maps, pn_mode.x, 0, texel), farthest = pn_lights[0].w_reach;
  if (!pn_is_nothing(w)) return w;
  vec2 st = pn_map_st(0, pn_mode.x, vec2(texel) + 0.5);
  return pn_ground.w > 0.0 ? max(farthest, pn_ground.z + dot(pn_ground.xy, st)) : farthest;
}

void main() {
  float w = pn_linear.z, alpha;
  if (pn_mode.z != 0) {
    // The map is read here, so it cannot be the pass's depth too.
    float w_r = pn_receiver_w(ivec2(gl_FragCoord.xy));
    if (w_r > w) discard;
    alpha = pn_remapped(w, w_r);
  } else {
    alpha = pn_alpha(w);
  }
  pn_out = vec4(clamp(alpha, 0.0, 1.0), -w, 0.0, 0.0);
}
