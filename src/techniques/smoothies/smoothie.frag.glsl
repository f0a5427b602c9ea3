// A smoothie's texel. A point of it at (kappa, w) gives a receiver at w_R the visibility kappa / (w - w_R). Its
// reciprocal is a line over w_R. Where smoothies overlap the least visibility counts, and so does the greatest
// reciprocal; it is stored negative, and the minimum is kept. Values at two close w_R tell the whole line of the one
// that wins there: at the farthest receiver, and half way up to the nearest caster.
#include "shaders/precision.glsl"
#include "maps/maps.glsl"
#include "techniques/smoothies/samples.glsl"

uniform highp vec4 pn_width; // fixed width in map units; 0: the light's
in highp vec2 pn_offset_out;
in highp vec3 pn_linear;
flat in highp vec2 pn_shape;
layout(location = 0) out vec4 pn_out;

// In a rounded corner: distance over the light's width in its direction, and where the corner is sharp as far out as
// the two edges' smoothies would meet.
float pn_corner_kappa(vec2 o) {
  bool fixed_width = pn_width.x > 0.0;
  vec2 extent = fixed_width ? pn_width.xx : pn_extent(0), size = abs(o) / extent;
  if (pn_shape.x > 1.5) return max(size.x, size.y);
  float rounded = fixed_width ? length(size) : dot(o, o) / max(dot(abs(o), extent), PN_TINY);
  return mix(rounded, max(rounded, max(pn_linear.x, pn_linear.y)), pn_shape.y);
}

void main() {
  float w = pn_linear.z, kappa = pn_shape.x > 0.5 ? pn_corner_kappa(pn_offset_out) : pn_linear.x;
  if (pn_width.x > 0.0 && !pn_is_parallel(0)) kappa *= w;
  pn_out = (pn_samples(0) - w) / max(kappa, 1e-9 * pn_sample_step(0));
}
