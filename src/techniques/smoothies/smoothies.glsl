// The lookup: behind the depth map nothing is seen of the light, behind a smoothie the part that it says, else all.
#include "search/lookup.glsl"
#include "techniques/smoothies/samples.glsl"

// What the smoothies over a texel leave of the light for a receiver at w: see smoothie.frag.glsl. The reciprocal is a
// convex function of w that falls, so its lines are nowhere above it except between a pair's samples: there the upper
// one of these bounds it.
float pn_smoothie(int light, highp sampler2DArray smoothies, int map, ivec2 texel, float w) {
  vec4 stored = -texelFetch(smoothies, ivec3(texel, map), 0), at = pn_samples(light);
  vec2 above = (w - at.yw) / pn_sample_step(light);
  vec2 lines = stored.yw + above * (stored.yw - stored.xz);
  if (above.y < 0.0 && above.y > -1.0) lines.y = stored.w;
  float reciprocal = max(lines.x, lines.y);
  return reciprocal > 0.0 ? 1.0 / reciprocal : PN_EVERYTHING;
}

// Whether smoothies are kept as alpha and distance: see alpha.frag.glsl.
bool pn_keeps_alpha(int light) {
  return min(pn_parameter(light, PN_PARAMETER_REMAP), pn_parameter(light, PN_PARAMETER_RECEIVER)) < 0.5;
}

// What the smoothie buffer says of a receiver that is nowhere nearer than w.
float pn_alpha(highp sampler2DArray smoothies, int map, ivec2 texel, float w) {
  vec2 stored = texelFetch(smoothies, ivec3(texel, map), 0).rg;
  return w < -stored.y ? stored.x : PN_EVERYTHING;
}

// How far from the receiver, at most, an edge of its own surface lies whose smoothie covers a texel beside it: the
// texel, and from there back to the edge along the normal, or along a sheet. A sheet goes by A_u and A_v on the axes
// where it goes by A_n, the lesser one at least, along the normal.
vec2 pn_edge_distance(int light) {
  vec2 texel = pn_texel_size(light), extent = pn_extent(light);
  bool sheets = pn_parameter(light, PN_PARAMETER_GEOMETRY) > 0.5 && pn_parameter(light, PN_PARAMETER_WIDTH) == 0.0;
  return texel + length(texel) * (sheets ? extent / max(min(extent.x, extent.y), PN_TINY) : vec2(1.0));
}

// The receiver's tangent plane around it in the map: w there is plane.z + plane.xy . (st - st_R), nearer to the light
// by the errors that it may have within a texel.
vec3 pn_plane(int light, pn_ShadedPoint r) {
  vec2 slope = r.n.xy / r.k, texel = pn_texel_size(light);
  float lever = texel.x + texel.y + r.reach * dot(abs(slope), texel);
  // A smoothie reaches in by its seam, which may lie in this very plane.
  float seam = 4.0 * pn_lights[light].raster_error * max(texel.x, texel.y) * length(r.n.xy);
  return vec3(slope, r.m.z + r.epsilon_w - (r.epsilon_plane + seam + r.sigma * lever) / r.k);
}

// One texel's answer. share: what a smoothie's visibility is multiplied by.
float pn_texel_sees(int light, highp sampler2DArray maps, highp sampler2DArray smoothies, int map, pn_ShadedPoint r,
                    ivec2 texel, vec3 plane, float share) {
  if (pn_map_count(light) > 1) { // a texel counted from one tile of a wide light, which may lie in another
    vec2 st = pn_map_st(light, map, vec2(texel) + 0.5);
    map = pn_map_at(light, st);
    texel = ivec2(floor(pn_map_texel(light, map, st)));
  }
  if (!pn_map_inside(light, map, texel)) return 1.0;
  vec3 q = pn_texel_point(light, maps, map, texel);
  float w = plane.z + dot(plane.xy, q.xy - r.m.xy);
  // Smoothies are as near as their edge, which may be the receiver's own.
  float nearest = plane.z + dot(abs(plane.xy), pn_edge_distance(light));
  float sees = pn_keeps_alpha(light) ? pn_alpha(smoothies, map, texel, nearest)
                                     : pn_smoothie(light, smoothies, map, texel, w) * share;
  return pn_blocks_apart(light, r, q) ? 0.0 : min(sees, 1.0);
}

pn_Visibility pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray smoothies, pn_ShadedPoint r) {
  int map = pn_map_at(light, r.m.xy);
  vec2 at = pn_map_texel(light, map, r.m.xy);
  bool filtered = pn_parameter(light, PN_PARAMETER_FILTER) > 0.5;
  if (filtered) at -= 0.5;
  ivec2 base = ivec2(floor(at)), size = pn_map_size(light, map);
  vec2 f = filtered ? at - vec2(base) : vec2(0.0);
  // What is turned away from the light's centre is out of this shadow, which is the centre's.
  bool asks = r.k < 0.0 && all(greaterThanEqual(base, ivec2(-1))) && all(lessThan(base, size));
  // An edge in the receiver's own plane hides nothing: in the light's plane it is the horizon, which lies -k / |n_uv|
  // from the centre or farther along the edge's normal, where the smoothie ends at the light's half diagonal at most.
  float above = min(-r.k / max(length(r.n.xy) * length(pn_extent(light)), PN_TINY), 1.0);
  // A fixed width under a sun: distances count from the nearest caster's plane.
  bool scaled = pn_parameter(light, PN_PARAMETER_WIDTH) > 0.0 && pn_is_parallel(light);
  float share = (scaled ? max(pn_w_near(light) - r.m.z, 0.0) : 1.0) / above;
  vec3 plane = pn_plane(light, r);
  vec2 sum = vec2(0.0); // hidden, seen: one of them is exactly 0 where nothing, or everything, is
  for (int i = 0; i < (asks ? filtered ? 4 : 1 : 0); i++) {
    ivec2 step = ivec2(i & 1, i >> 1);
    vec2 weight = mix(1.0 - f, f, vec2(step));
    float sees = pn_texel_sees(light, maps, smoothies, map, r, base + step, plane, share);
    sum += weight.x * weight.y * vec2(1.0 - sees, sees);
  }
  return asks && sum.y == 0.0 ? 0.0 : 1.0 - sum.x;
}
