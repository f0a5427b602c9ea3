// The corners of a silhouette.
#include "silhouettes/edges.glsl"

// The angle from along, turning over outward, as a number that grows with it from 0 to 4.
float pn_turn(vec2 along, vec2 outward, vec2 v) {
  float c = dot(along, v), s = dot(outward, v);
  float size = abs(c) + abs(s);
  return s >= 0.0 ? 1.0 - c / size : 3.0 + c / size;
}

// The outward normal, in the map, of the silhouette's edge from vertex that comes next after turning from along over
// outward, where the two make a convex corner; zero where they do not.
vec2 pn_next_normal(int self, uint vertex, vec2 along, vec2 outward) {
  vec3 p = pn_vertex(vertex);
  if (!pn_before_cut(p)) return vec2(0.0);
  vec2 at = pn_map_point(p, pn_edge_parallel()).xy;
  uvec2 ring = texelFetch(pn_rings, pn_entry(int(vertex)), 0).xy;
  float best = 4.0;
  vec2 normal = vec2(0.0);
  for (int i = 0; i < min(int(ring.y), pn_mesh.z); i++) {
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
