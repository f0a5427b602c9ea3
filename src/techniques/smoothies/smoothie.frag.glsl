// A smoothie's texel. A point of it at (kappa, w) gives a receiver at w_R the visibility kappa / (w - w_R). Its
// reciprocal is linear in w_R, so its values at a few w_R stand for all of them; where smoothies overlap the least
// visibility counts, and so does the greatest reciprocal. It is stored negative, and the minimum is kept.
#include "shaders/precision.glsl"
#include "maps/maps.glsl"

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
  float rounded = fixed_width ? length(size) : dot(o, o) / max(dot(abs(o), extent), 1e-30);
  return mix(rounded, max(rounded, max(pn_linear.x, pn_linear.y)), pn_shape.y);
}

void main() {
  float w = pn_linear.z, kappa = pn_shape.x > 0.5 ? pn_corner_kappa(pn_offset_out) : pn_linear.x;
  if (pn_width.x > 0.0 && !pn_is_sun(0)) kappa *= w;
  vec2 range = vec2(pn_lights[0].extent.w, pn_lights[0].range.x);
  vec4 w_receiver = mix(range.xxxx, range.yyyy, vec4(0.0, 1.0, 2.0, 3.0) / 3.0);
  pn_out = (w_receiver - w) / max(kappa, 1e-9 * (range.y - range.x));
}
