// For each end of each silhouette edge: the outward normal of the silhouette's next edge, where the two make a convex
// corner; zero where they do not.
#include "shaders/precision.glsl"
#include "casters/edges.glsl"

#define PN_RING_MAX 64 // edges at a vertex that are looked at

layout(location = 0) out vec4 pn_corner_out;

// The angle from along, turning over outward, as a number that grows with it from 0 to 4.
float pn_turn(vec2 along, vec2 outward, vec2 v) {
  float c = dot(along, v), s = dot(outward, v);
  float size = abs(c) + abs(s);
  return s >= 0.0 ? 1.0 - c / size : 3.0 + c / size;
}

// The normal, in the map, of the silhouette edge from vertex that comes next after turning from along over outward.
vec2 pn_next_normal(int self, uint vertex, vec2 along, vec2 outward) {
  vec3 p = pn_vertex(vertex);
  if (!pn_before_cut(p)) return vec2(0.0);
  vec2 at = pn_map_point(p, pn_edge_sun()).xy;
  uvec2 ring = texelFetch(pn_rings, pn_entry(int(vertex)), 0).xy;
  float best = 4.0;
  vec2 normal = vec2(0.0);
  for (int i = 0; i < min(int(ring.y), PN_RING_MAX); i++) {
    uvec2 entry = texelFetch(pn_entries, pn_entry(int(ring.x) + i), 0).xy;
    int edge = int(entry.x);
    float side = pn_side(edge);
    if (edge == self || side == 0.0) continue;
    vec2 v = pn_edge_end(pn_vertex(entry.y), p).xy - at;
    float turn = pn_turn(along, outward, v);
    if (!(turn < best)) continue;
    best = turn;
    normal = pn_outward(pn_edge(edge).x == vertex ? v : -v, side);
  }
  return best > 2.0 && best < 4.0 ? normal : vec2(0.0);
}

void main() {
  int edge = min(int(gl_FragCoord.y) * PN_EDGE_ROW + int(gl_FragCoord.x), pn_count.x - 1);
  float side = pn_side(edge);
  vec4 corners = vec4(0.0);
  for (int i = 0; i < (side > 0.0 ? 2 : 0); i++) { // no turn where no pixel nearby has a silhouette
    uvec4 v = pn_edge(edge);
    vec3 p = pn_vertex(v.x), q = pn_vertex(v.y);
    if (!pn_before_cut(p) && !pn_before_cut(q)) continue;
    vec2 along = pn_edge_end(q, p).xy - pn_edge_end(p, q).xy;
    vec2 outward = pn_outward(along, side);
    along /= max(length(along), 1e-30);
    if (i == 0) corners.xy = pn_next_normal(edge, v.x, along, outward);
    else corners.zw = pn_next_normal(edge, v.y, -along, outward);
  }
  pn_corner_out = corners;
}
