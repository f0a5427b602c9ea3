// Bitmask Soft Shadows (Schwarz and Stamminger 2007): every micro-primitive sets the bits of the light's sample
// points that it hides. Overlaps set the same bits, so occluders fuse as they should, and any number of maps may add
// theirs.
#include "techniques/bitmask/field.glsl"
#include "search/primitive.glsl"

#define pn_Cover pn_Field
#define PN_OVERLAPS 1 // sets of bits

void pn_cover_rectangle(inout pn_Cover c, vec2 low, vec2 high) {
  pn_Field f = pn_rectangle(low, high);
  for (int i = 0; i < PN_WORDS; i++) c.bits[i] |= f.bits[i];
}

#if PN_PRIMITIVE == PN_QUAD_EXACT
// A quad covered exactly, a row at a time, as the walk of the search takes it.
ivec2 pn_quad_rows(pn_Quad q) {
  return pn_rows_between(min(min(q.y.x, q.y.y), min(q.y.z, q.y.w)), max(max(q.y.x, q.y.y), max(q.y.z, q.y.w)));
}

void pn_cover_quad_row(inout pn_Cover c, pn_Quad q, int row) {
  vec2 p10 = vec2(q.x.y, q.y.y), p01 = vec2(q.x.z, q.y.z);
  pn_add_triangle_row(c, vec2(q.x.x, q.y.x), p10, p01, row);
  pn_add_triangle_row(c, p10, vec2(q.x.w, q.y.w), p01, row);
}
#endif

// Section 4: an arbitrary quad is covered by its rectangle.
void pn_cover_quad(inout pn_Cover c, pn_Quad q) { pn_cover_rectangle(c, q.low, q.high); }

// Covers what a block hides at least; true when nothing is left of what it hides at most. (one: both are the same.)
bool pn_cover_and_ask(inout pn_Cover c, vec2 low, vec2 high, vec2 most_low, vec2 most_high, bool one) {
  pn_Field least = pn_rectangle(low, high), most = pn_rectangle(most_low, most_high);
  uvec4 open = uvec4(0u);
  for (int i = 0; i < PN_WORDS; i++) {
    c.bits[i] |= least.bits[i];
    open |= most.bits[i] & ~c.bits[i];
  }
  return open == uvec4(0u);
}

bool pn_is_full(pn_Cover c) {
  uvec4 closed = uvec4(0xffffffffu);
  for (int i = 0; i < PN_WORDS; i++) closed &= c.bits[i];
#if PN_GRID == 8
  return closed.xy == uvec2(0xffffffffu);
#else
  return closed == uvec4(0xffffffffu);
#endif
}

#include "search/search.glsl"
#include "gather/horizon.glsl"

pn_Visibility pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r) {
  pn_Cover hidden = pn_field_empty();
  // Samples below the horizon count as hidden from the start, and are left out of the count at the end.
  bool whole = dot(abs(r.n.xy), pn_extent(light)) < -r.k;
  float total = float(PN_GRID * PN_GRID);
  if (!whole) {
    pn_Field above = pn_field_horizon(pn_extent(light), r.n.xy, r.k);
    total = pn_field_count(above);
    if (total == 0.0) return 1.0;
    for (int i = 0; i < PN_WORDS; i++) hidden.bits[i] = ~above.bits[i];
#if PN_GRID == 8
    hidden.bits[0].zw = uvec2(0u);
#endif
  }
  for (int map = 0; map < pn_map_count(light); map++)
    for (int layer = 0; layer < pn_map_layers(light, map); layer++) {
      pn_search(light, maps, range, r, map, layer, hidden);
#if !PN_AREA
      if (pn_is_full(hidden)) return 0.0;
#endif
    }
#if PN_AREA
  pn_seen_area = 1.0 - pn_hidden_area / pn_area_above(pn_extent(light), r.n.xy, r.k);
#endif
  float below = float(PN_GRID * PN_GRID) - total;
  return 1.0 - (pn_field_count(hidden) - below) / total;
}
