// Percentage-closer soft shadows (Fernando 2005) with the light's real size: blockers are searched where the light
// can be blocked at all, and filtered over what the light covers in the map at the blockers' average w. Regular
// sampling: no noise.
#include "search/lookup.glsl"
#include "search/window.glsl"

// Sample i of n x n on [-1, 1]^2, at the middle of its cell.
vec2 pn_cell(int i, int n) { return (2.0 * vec2(i % n, i / n) + 1.0) / float(n) - 1.0; }

// Blockers among n x n samples of the window that belongs to casters at w: adds their w, and their weights. What a
// sample hides of the light is its share of the map over (w - w_R)^2; that is its weight. inner: the middle quarter
// is left to a finer step.
vec2 pn_search_step(int light, highp sampler2DArray maps, pn_ShadedPoint r, int n, float w, bool inner) {
  vec2 window = pn_search_window(pn_extent(light), w, r.m.z);
  vec2 share = window / (float(n) * pn_extent(light));
  float cell = share.x * share.y;
  vec2 sum = vec2(0.0);
  for (int i = 0; i < n * n; i++) {
    vec2 at = pn_cell(i, n);
    if (inner && all(lessThan(abs(at), vec2(0.25)))) continue;
    vec2 st = r.m.xy + at * window;
    int map = pn_map_at(light, st);
    vec3 q = pn_texel_point(light, maps, map, ivec2(floor(pn_map_texel(light, map, st))));
    // A texel that does not project onto the light blocks nothing, though it lies in the window of a nearer one.
    vec2 reach = pn_search_window(pn_extent(light), q.z, r.m.z) + 0.5 / pn_lights[light].maps[map].density;
    if (!pn_blocks_apart(light, r, q) || any(greaterThan(abs(q.xy - r.m.xy), reach))) continue;
    // All samples together hide no more than the light, also where they fall into one texel close before the receiver.
    float weight = min(cell / ((q.z - r.m.z) * (q.z - r.m.z)), 1.0 / float(n * n));
    sum += weight * vec2(q.z, 1.0);
  }
  return sum;
}

// Average w of the blockers; PN_NOTHING without any. Casters far from the light lie in a small part of the window
// only, which n x n samples may miss: the middle is searched again, four times finer, until samples lie a texel
// apart.
float pn_blockers(int light, highp sampler2DArray maps, pn_ShadedPoint r, int n, float w_max) {
  vec2 texels = 2.0 * pn_search_window(pn_extent(light), w_max, r.m.z) / pn_texel_size(light) / float(n);
  float spacing = max(texels.x, texels.y);
  float reach = w_max - r.m.z;
  vec2 sum = vec2(0.0);
  for (int step = 0; step < 8; step++) {
    bool inner = spacing > 1.0 && n > 1;
    sum += pn_search_step(light, maps, r, n, r.m.z + reach, inner);
    if (!inner) break;
    spacing *= 0.25;
    reach *= 0.25;
  }
  return sum.y > 0.0 ? sum.x / sum.y : PN_NOTHING;
}

pn_Visibility pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r) {
  int n = int(pn_parameter(light, PN_PARAMETER_SAMPLES));
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
