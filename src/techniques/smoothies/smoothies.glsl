// The lookup: behind the depth map nothing is seen of the light, behind a smoothie the part that it says, else all.
#include "search/lookup.glsl"

// What the smoothies over a texel leave of the light for a receiver at w: see smoothie.frag.glsl.
float pn_smoothie(int light, highp sampler2DArray smoothies, int map, ivec2 texel, float w) {
  vec4 stored = texelFetch(smoothies, ivec3(texel, map), 0);
  float near = pn_lights[light].range.x, far = pn_lights[light].extent.w;
  float at = 3.0 * (w - far) / (near - far), low = clamp(floor(at), 0.0, 2.0);
  vec2 pair = low < 0.5 ? stored.xy : low < 1.5 ? stored.yz : stored.zw;
  float reciprocal = -mix(pair.x, pair.y, at - low);
  return reciprocal > 0.0 ? 1.0 / reciprocal : 1e30;
}

// The w that the receiver's tangent plane has at a place in the map beside it, and the errors it may have there.
float pn_plane_w(pn_Receiver r, vec2 st) {
  vec2 aside = st - r.m.xy;
  float rise = dot(r.n.xy, aside) / r.k;
  float lever = abs(aside.x) + abs(aside.y) + r.reach * abs(rise);
  return r.m.z + rise + r.epsilon_w - (r.epsilon_plane + r.sigma * lever) / r.k;
}

// One texel's answer. share: see pn_technique.
float pn_texel_sees(int light, highp sampler2DArray maps, highp sampler2DArray smoothies, int map, pn_Receiver r,
                    ivec2 texel, float share) {
  if (pn_map_count(light) > 1) { // a texel counted from one tile of a wide light, which may lie in another
    vec2 st = pn_map_st(light, map, vec2(texel) + 0.5);
    map = pn_map_at(light, st);
    texel = ivec2(floor(pn_map_texel(light, map, st)));
  }
  if (!pn_map_inside(light, texel)) return 1.0;
  if (pn_texel_blocks(light, maps, map, r, texel) > 0.5) return 0.0;
  float w = pn_plane_w(r, pn_map_st(light, map, vec2(texel) + 0.5));
  return min(pn_smoothie(light, smoothies, map, texel, w) * share, 1.0);
}

float pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray smoothies, pn_Receiver r) {
  if (r.k >= 0.0) return 1.0; // turned away from the light's centre, whose shadow this is
  // Where the horizon cuts the light, visibility is the share of what lies above it.
  float above = min(-r.k / dot(abs(r.n.xy), pn_extent(light)), 1.0);
  // A fixed width under a sun: distances count from the nearest caster's plane.
  bool scaled = pn_parameter(light, 2) > 0.0 && pn_is_sun(light);
  float share = (scaled ? max(pn_lights[light].range.x - r.m.z, 0.0) : 1.0) / above;
  int map = pn_map_at(light, r.m.xy);
  vec2 at = pn_map_texel(light, map, r.m.xy);
  if (pn_parameter(light, 3) < 0.5)
    return pn_texel_sees(light, maps, smoothies, map, r, ivec2(floor(at)), share);
  ivec2 base = ivec2(floor(at - 0.5));
  vec2 f = at - 0.5 - vec2(base);
  float sum = 0.0;
  for (int i = 0; i < 4; i++) {
    ivec2 step = ivec2(i & 1, i >> 1);
    vec2 weight = mix(1.0 - f, f, vec2(step));
    sum += weight.x * weight.y * pn_texel_sees(light, maps, smoothies, map, r, base + step, share);
  }
  return sum;
}
