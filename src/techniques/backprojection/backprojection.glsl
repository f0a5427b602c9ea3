// Soft shadow mapping by backprojection (Guennebaud, Barthe, Paulin 2006): the areas that micro-primitives hide of
// the light are added up. Primitives that overlap on the light are counted twice: the fault that bit fields mend.
// Layers are therefore merged by maximum (Bitmask Soft Shadows, Fig. 9d).
#include "search/primitive.glsl"

#define pn_Cover float
#define PN_OVERLAPS 0 // a sum

void pn_cover_rectangle(inout pn_Cover c, vec2 low, vec2 high) {
  vec2 size = max(clamp(high, 0.0, 1.0) - clamp(low, 0.0, 1.0), 0.0);
  c += size.x * size.y;
}

// Section 4: corners clamped to the light, which keeps neighbouring quads watertight; then the quad's area from its
// diagonals.
void pn_cover_quad(inout pn_Cover c, pn_Quad q) {
  vec4 x = clamp(q.x, 0.0, 1.0), y = clamp(q.y, 0.0, 1.0);
  vec2 a = vec2(x.w - x.x, y.w - y.x), b = vec2(x.z - x.y, y.z - y.y);
  c += 0.5 * abs(a.x * b.y - a.y * b.x);
}

// Covers a block that is one primitive. What others hide at least would be counted again with their parts, and what is
// hidden already a sum does not know: they are done only when nothing of them lies on the light.
bool pn_cover_and_ask(inout pn_Cover c, vec2 low, vec2 high, vec2 most_low, vec2 most_high, bool one) {
  if (one) pn_cover_rectangle(c, low, high);
  return one || any(lessThanEqual(most_high, most_low));
}

bool pn_is_full(pn_Cover c) { return c >= 1.0; }

#include "search/search.glsl"
#include "gather/horizon.glsl"

pn_Visibility pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r) {
  float above = pn_area_above(pn_extent(light), r.n.xy, r.k);
  if (above <= 0.0) return 1.0;
  float most = 0.0;
  for (int layer = 0; layer < pn_layers(light); layer++) {
    float hidden = 0.0;
    for (int map = 0; map < pn_map_count(light); map++) pn_search(light, maps, range, r, map, layer, hidden);
    most = max(most, hidden);
  }
  // Each primitive's addition may round 2^-24 away: where no more is missing, nothing is seen of the light.
  return most + 6e-8 * pn_search_done.z >= above ? 0.0 : 1.0 - most / above;
}
