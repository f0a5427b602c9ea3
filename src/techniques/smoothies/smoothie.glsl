// What the passes that draw smoothies know of a silhouette edge. In the map its smoothie lies at
//   P + tau (Q - P) + kappa x,   tau in 0..1, 0 <= kappa <= pn_reach(w),
// P and Q the edge's ends and x the vector along which kappa counts: the outward normal n times A_n, or, for sheets,
// the corner of the light's rectangle that lies farthest out.
#include "maps/maps.glsl"
#include "silhouettes/edges.glsl"

uniform highp ivec4 pn_mode; // tile; 1 for sheets and cones
uniform highp vec4 pn_width; // fixed width in map units; 0: the light's

bool pn_fixed() { return pn_width.x > 0.0; }
// Of a fixed width, cones are the rounded corners that rectangles have too.
bool pn_cones() { return pn_mode.y != 0 && !pn_fixed(); }

// A_n, half the light's width along a unit normal.
float pn_width_along(vec2 n) { return pn_fixed() ? pn_width.x : dot(abs(n), pn_extent(0)); }

// The kappa at which the farthest receiver sees the whole light past an edge at w.
float pn_reach(float w) { return pn_fixed() ? 1.0 : max(w - pn_lights[0].w_reach, 0.0); }

vec2 pn_across(vec2 n) {
  return pn_cones() ? vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0) * pn_extent(0)
                    : n * pn_width_along(n);
}
