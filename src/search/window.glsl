// The search window: texels that can block a receiver, from the light's extent and the nearest caster there, narrowed
// by the range pyramid.
#include "gather/shaded_point.glsl"
#include "maps/gaps.glsl"

// Largest and smallest w, smallest that is there, gaps in depth (the last two over quads only).
vec4 pn_join_ranges(vec4 a, vec4 b) { return vec4(max(a.x, b.x), min(a.yzw, b.yzw)); }

// The range of a window of texels (both ends included), from the pyramid whose level i has them over 2^i
// x 2^i texels. Four samples of the coarsest level that is still no larger than the window.
vec4 pn_range_over(int light, highp sampler2DArray pyramid, int map, int layer, ivec2 low, ivec2 high) {
  ivec2 last = pn_map_size(light, map) - 1;
  if (any(lessThan(high, ivec2(0))) || any(greaterThan(low, last)))
    return vec4(vec2(PN_NOTHING), PN_EVERYTHING, PN_NO_GAP);
  low = max(low, ivec2(0));
  high = min(high, last);
  int extent = max(high.x - low.x, high.y - low.y);
  int level = 0;
  while ((extent >> level) > 1) level++;
  int array_layer = pn_array_layer(light, map, layer);
  ivec2 a = low >> level, b = high >> level;
  // The window may touch three blocks along an axis where it is not aligned; the one between is then read as well.
  ivec2 c = (a + b) >> 1;
  vec4 range = vec4(PN_NOTHING, vec3(PN_EVERYTHING));
  for (int i = 0; i < 9; i++) {
    ivec2 at = ivec2(i % 3 == 0 ? a.x : i % 3 == 1 ? c.x : b.x, i / 3 == 0 ? a.y : i / 3 == 1 ? c.y : b.y);
    range = pn_join_ranges(range, texelFetch(pyramid, ivec3(at, array_layer), level));
  }
  return range;
}

// Largest w that any map has inside the receiver's search window; at first the window reaches as far as the nearest
// caster of all could need, then as far as the nearest caster found in it needs.
float pn_window_nearest(int light, highp sampler2DArray pyramid, pn_ShadedPoint r) {
  float w_max = pn_w_near(light);
  for (int step = 0; step < 2; step++) {
    vec2 window = pn_search_window(pn_extent(light), w_max, r.m.z);
    float found = PN_NOTHING;
    for (int map = 0; map < pn_map_count(light); map++) {
      ivec2 low = ivec2(floor(pn_map_texel(light, map, r.m.xy - window)));
      ivec2 high = ivec2(floor(pn_map_texel(light, map, r.m.xy + window)));
      found = max(found, pn_range_over(light, pyramid, map, 0, low, high).x);
    }
    w_max = found;
    if (w_max <= r.m.z + r.epsilon_w) break;
  }
  return w_max;
}
