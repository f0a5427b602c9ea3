// What a micropatch hides of the light at one texel of the soft shadow map (Soft Shadow Maps, section 3.4): its
// projection from the receiver onto the light, cut with the light.
#include "shaders/precision.glsl"
#include "techniques/ssm/patches.glsl"

uniform highp sampler2DArray pn_seen; // the receiver map
uniform ivec4 pn_layer; // of the receiver map; of the occluder maps' array, last texel of the map
flat in vec4 pn_rectangle;
flat in vec3 pn_served;
layout(location = 0) out vec4 pn_out;

#if PN_SUM == 0
flat in vec4 pn_larger, pn_ranges;
flat in vec2 pn_inset;

// Each receiver has each texel in one block: the largest that may serve it, and all of which its plane leaves in front.
bool pn_serves(vec4 seen, vec2 st) {
  if (pn_is_nothing(seen.x) || seen.x >= pn_served.x || seen.x > pn_served.y) return false;
  bool larger = seen.x <= pn_served.z && pn_patch_in_front(seen, st, pn_larger, pn_inset, pn_ranges.zw);
  return !larger && pn_patch_in_front(seen, st, pn_rectangle, pn_inset, pn_ranges.xy);
}
#elif PN_SUM == 1
flat in vec2 pn_neighbours;

// Soft Shadow Maps, Eq. 3: how far a micropatch and its neighbour beyond the edge at position at overlap, or part, at
// most, where that edge falls onto the light; as a share of the light, over the edge's length.
float pn_overlap(float w, float neighbour, float w_r, float at, float extent, float edge) {
  float lower = min(w, neighbour) - w_r;
  if (pn_is_nothing(neighbour) || lower <= 0.0) return 0.0;
  float nearest = abs(at) / (max(w, neighbour) - w_r); // the farther one projects farther out
  return nearest <= extent ? min(0.5 * abs(w - neighbour) / lower, 1.0) * edge : 0.0;
}

float pn_error_bound(vec2 st, float w_r, vec2 covered) {
  vec2 at = pn_rectangle.zw - st;
  return pn_overlap(pn_served.x, pn_neighbours.x, w_r, at.x, pn_extent(0).x, covered.y) +
         pn_overlap(pn_served.x, pn_neighbours.y, w_r, at.y, pn_extent(0).y, covered.x);
}
#endif

void main() {
  vec4 seen = texelFetch(pn_seen, ivec3(ivec2(gl_FragCoord.xy), pn_layer.x), 0);
  vec2 st = pn_seen_st(gl_FragCoord.xy);
  float w = pn_served.x, nearer = w - seen.x;
  vec2 scale = 0.5 / (pn_extent(0) * max(nearer, PN_TINY));
  vec2 low = clamp((pn_rectangle.xy - st) * scale, -0.5, 0.5), high = clamp((pn_rectangle.zw - st) * scale, -0.5, 0.5);
  vec2 covered = high - low;
#if PN_SUM == 2
  pn_out = vec4(1.0, 0.0, 0.0, 1.0);
#elif PN_SUM == 1
  bool below = !pn_is_nothing(seen.x) && seen.x < w;
  pn_out = vec4(below ? pn_error_bound(st, seen.x, covered) : 0.0, 0.0, 0.0, 1.0);
#else
  pn_out = vec4(pn_serves(seen, st) ? covered.x * covered.y : 0.0, 0.0, 0.0, 1.0);
#endif
}
