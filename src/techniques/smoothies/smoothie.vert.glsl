// One triangle for each edge, around its smoothie and the corners at its ends; for edges that are no silhouette it has
// no area. Loops of at most one turn skip, in software, what no vertex of a group needs.
#include "shaders/precision.glsl"
#include "casters/edges.glsl"
#include "techniques/smoothies/smoothie.glsl"

flat out highp vec3 pn_p;       // ends in (s, t, w)
flat out highp vec3 pn_q;
flat out highp vec4 pn_outwards; // outward normal, x
flat out highp vec4 pn_neighbours; // outward normals of the neighbours at p, at q; zero without a corner

// Bounds in (tau, kappa): least and most tau, most kappa.
vec3 pn_include(vec3 bounds, vec2 v, vec2 along, vec2 n, vec2 x) {
  float kappa = dot(v, n) / dot(x, n);
  float tau = dot(v - kappa * x, along) / dot(along, along);
  return vec3(min(bounds.x, tau), max(bounds.y, tau), max(bounds.z, kappa));
}

// Adds the corner between normals n and m, at an end that lies at offset v from p. Rounded corners: with phi half the
// angle between the normals, points o with |o| <= reach A_o, and A_o <= A_n cos + A_across sin.
vec3 pn_include_corner(vec3 bounds, vec2 v, vec2 along, vec2 n, vec2 x, vec2 m, float reach, float back) {
  if (pn_cones()) {
    vec2 y = pn_across(m);
    bounds = pn_include(bounds, v + reach * y, along, n, x);
    bounds = pn_include(bounds, v + reach * vec2(x.x, y.y), along, n, x);
    return pn_include(bounds, v + reach * vec2(y.x, x.y), along, n, x);
  }
  float sine = sqrt(clamp(0.5 - 0.5 * dot(n, m), 0.0, 1.0));
  vec2 a = vec2(pn_width_along(n), pn_width_along(vec2(-n.y, n.x))) * reach;
  float out_most = a.x + a.y * min(sine, 0.5);
  float back_most = a.x * min(sine, 0.5) + a.y * sine * sine;
  return pn_include(bounds, v + n * out_most + back * back_most * along / length(along), along, n, x);
}

void main() {
  int edge = gl_VertexID / 3, corner = gl_VertexID - 3 * edge;
  float side = pn_side(edge);
  vec2 at = vec2(0.0);
  pn_p = pn_q = vec3(0.0);
  pn_outwards = pn_neighbours = vec4(0.0);
  for (int i = 0; i < (side > 0.0 ? 1 : 0); i++) {
    uvec4 v = pn_edge(edge);
    vec3 a = pn_vertex(v.x), b = pn_vertex(v.y);
    if (!pn_before_cut(a) && !pn_before_cut(b)) break;
    vec3 p = pn_edge_end(a, b), q = pn_edge_end(b, a);
    vec2 along = q.xy - p.xy, n = pn_outward(along, side), x = pn_across(n);
    if (!(dot(x, n) > 0.0) || pn_reach(max(p.z, q.z)) <= 0.0) break;
    vec4 next = texelFetch(pn_corners, pn_entry(edge), 0);
    vec3 bounds = vec3(0.0, 1.0, max(pn_reach(p.z), pn_reach(q.z)));
    if (next.xy != vec2(0.0))
      bounds = pn_include_corner(bounds, vec2(0.0), along, n, x, next.xy, pn_reach(p.z), -1.0);
    if (next.zw != vec2(0.0)) bounds = pn_include_corner(bounds, along, along, n, x, next.zw, pn_reach(q.z), 1.0);
    // A box in (tau, kappa), a seam wider on all sides; its triangle is twice as high, and twice as wide at its base.
    float seam = 2.0 * pn_seam();
    float low = -seam / dot(x, n), high = bounds.z;
    bounds.xy += vec2(-seam, seam) / length(along);
    float middle = 0.5 * (bounds.x + bounds.y), half_width = bounds.y - bounds.x;
    float tau = middle + (corner == 0 ? -half_width : corner == 1 ? half_width : 0.0);
    float kappa = corner == 2 ? low + 2.0 * (high - low) : low;
    vec2 texel = pn_map_texel(0, pn_mode.x, p.xy + tau * along + kappa * x);
    at = 2.0 * texel / vec2(pn_map_size(0)) - 1.0;
    pn_p = p;
    pn_q = q;
    pn_outwards = vec4(n, x);
    pn_neighbours = next;
  }
  gl_Position = vec4(at, 0.0, 1.0);
}
