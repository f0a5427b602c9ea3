// The first level of the range pyramid over a receiver map: largest and smallest w of each texel, the one of an empty
// texel below, above everything.
#include "shaders/precision.glsl"
#include "space/limits.glsl"
uniform highp sampler2DArray pn_seen;
uniform ivec4 pn_layer;
layout(location = 0) out vec4 pn_out;

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  bool inside = all(lessThan(texel, textureSize(pn_seen, 0).xy));
  float w = inside ? texelFetch(pn_seen, ivec3(texel, pn_layer.x), 0).x : PN_NOTHING;
  pn_out = vec4(w, pn_is_nothing(w) ? PN_EVERYTHING : w, 0.0, 1.0);
}
