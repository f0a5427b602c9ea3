// What a micropatch hides of the light at one texel of the soft shadow map (Soft Shadow Maps, section 3.4): its
// projection from the receiver onto the light, cut with the light.
#include "shaders/precision.glsl"
#include "techniques/ssm/patches.glsl"

uniform highp sampler2DArray pn_seen; // the receiver map
uniform ivec4 pn_layer;
flat in vec4 pn_rectangle;
flat in vec3 pn_served;
layout(location = 0) out vec4 pn_out;

void main() {
  vec4 seen = texelFetch(pn_seen, ivec3(ivec2(gl_FragCoord.xy), pn_layer.x), 0);
  vec2 st = pn_seen_st(gl_FragCoord.xy);
  float w = pn_served.x, nearer = w - seen.x;
  // In front of the receiver's tangent plane, tested at the patch's middle.
  vec2 middle = 0.5 * (pn_rectangle.xy + pn_rectangle.zw) - st;
  bool blocks = seen.x > -1e29 && seen.x < w && seen.x <= pn_served.y && seen.x > pn_served.z &&
                dot(seen.yz, middle) - seen.w * nearer > 1.0;
  vec2 scale = 0.5 / (pn_extent(0) * max(nearer, 1e-30));
  vec2 low = clamp((pn_rectangle.xy - st) * scale, -0.5, 0.5), high = clamp((pn_rectangle.zw - st) * scale, -0.5, 0.5);
  vec2 covered = high - low;
  pn_out = vec4(blocks ? covered.x * covered.y : 0.0, 0.0, 0.0, 1.0);
}
