// Percentage-closer soft shadows (Fernando 2005) with the light's real size: blockers are searched where the light can be blocked at all,
// and filtered over what the light covers in the map at the blockers' average w. Regular sampling: no noise.
#include "search/lookup.glsl"
#include "search/window.glsl"

// Sample i of n x n on [-1, 1]^2, at the middle of its cell.
vec2 pn_cell(int i, int n) { return (2.0 * vec2(i % n, i / n) + 1.0) / float(n) - 1.0; }

// Average w of the blockers in the search window; PN_NOTHING without any.
float pn_blockers(int light, highp sampler2DArray maps, pn_Receiver r, int n, float w_max) {
  vec2 window = pn_search_window(pn_extent(light), w_max, r.m.z);
  float sum = 0.0, count = 0.0;
  for (int i = 0; i < n * n; i++) {
    vec2 st = r.m.xy + pn_cell(i, n) * window;
    int map = pn_map_at(light, st);
    vec3 q = pn_texel_point(light, maps, map, ivec2(floor(pn_map_texel(light, map, st))));
    if (!pn_blocks(r, q)) continue;
    sum += q.z;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : PN_NOTHING;
}

float pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_Receiver r) {
  int n = int(pn_parameter(light, 0));
  float w_max = pn_window_nearest(light, range, r);
  if (w_max <= r.m.z + r.epsilon_w) return 1.0;
  float w_blockers = pn_blockers(light, maps, r, n, w_max);
  if (w_blockers == PN_NOTHING) return 1.0;
  float above = 0.0, blocked = 0.0;
  for (int i = 0; i < n * n; i++) {
    vec2 light_point = pn_cell(i, n) * pn_extent(light);
    if (pn_horizon(r.n, r.k, light_point) <= 0.0) continue; // this part of the light is below the receiver's horizon
    above += 1.0;
    blocked += pn_bilinear_blocks(light, maps, r, r.m.xy + light_point * (w_blockers - r.m.z));
  }
  return above > 0.0 ? 1.0 - blocked / above : 1.0;
}
