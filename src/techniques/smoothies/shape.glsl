// What a smoothie's texel gets from smoothie.vert.glsl, and how far out in the smoothie it lies.
#include "maps/maps.glsl"

uniform highp vec4 pn_width; // fixed width in map units; 0: the light's
in highp vec2 pn_offset_out;
in highp vec3 pn_linear;
flat in highp vec2 pn_shape;

// In a rounded corner: distance over the light's width in its direction, and where the corner is sharp as far out as
// the two edges' smoothies would meet.
float pn_corner_kappa(vec2 o) {
  bool fixed_width = pn_width.x > 0.0;
  vec2 extent = fixed_width ? pn_width.xx : pn_extent(0), size = abs(o) / extent;
  if (pn_shape.x > 1.5) return max(size.x, size.y);
  float rounded = fixed_width ? length(size) : dot(o, o) / max(dot(abs(o), extent), PN_TINY);
  return mix(rounded, max(rounded, max(pn_linear.x, pn_linear.y)), pn_shape.y);
}

// Distance from the edge over the light's width, or over the fixed one.
float pn_kappa() { return pn_shape.x > 0.5 ? pn_corner_kappa(pn_offset_out) : pn_linear.x; }
