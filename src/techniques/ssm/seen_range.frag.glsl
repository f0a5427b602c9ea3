// The first level of the pyramid over a receiver map: largest and smallest w of each texel, the one of an empty texel
// below, above everything; and what tells which blocks the tangent plane may cut.
#include "shaders/precision.glsl"
#include "maps/maps.glsl"
uniform highp sampler2DArray pn_seen;
uniform ivec4 pn_layer;
layout(location = 0) out vec4 pn_out;

// A block no larger than e in s and t is all in front of the plane where it lies beyond w + x + e y
// (docs/techniques/ssm.md, "Merging"): (-(w + x), -y), since the pyramid keeps the smallest.
vec2 pn_cut(vec4 seen) {
  vec2 slope = abs(seen.yz);
  float rise = -seen.w - dot(slope, pn_extent(0));
  return rise > 0.0 ? -vec2(seen.x + 1.0 / rise, (slope.x + slope.y) / rise) : vec2(-PN_EVERYTHING, 0.0);
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  bool inside = all(lessThan(texel, textureSize(pn_seen, 0).xy));
  vec4 seen = inside ? texelFetch(pn_seen, ivec3(texel, pn_layer.x), 0) : vec4(PN_NOTHING);
  pn_out = pn_is_nothing(seen.x) ? vec4(PN_NOTHING, vec3(PN_EVERYTHING)) : vec4(seen.x, seen.x, pn_cut(seen));
}
