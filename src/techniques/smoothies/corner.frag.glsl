// For each end of each silhouette edge: the outward normal of the silhouette's next edge, where the two make a convex
// corner; zero where they do not. pn_no_smoothie for the other edges, and for silhouettes that the light's centre does
// not see: what hides them has an outline nearer to the light, whose smoothie is darker.
#include "shaders/precision.glsl"
#include "techniques/smoothies/smoothie.glsl"

#define PN_RING_MAX 64 // edges at a vertex that are looked at

uniform highp sampler2DArray pn_maps;
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

// Whether the nearest caster beside a point of the edge lies before it.
bool pn_hidden(vec3 p, vec2 outward) {
  vec2 texel = 1.0 / pn_lights[0].map_bounds[0].zw;
  vec2 st = p.xy + outward * max(texel.x, texel.y);
  int map = pn_map_at(0, st);
  return pn_map_fetch(0, pn_maps, map, 0, ivec2(floor(pn_map_texel(0, map, st)))) > p.z;
}

// Edges shorter than two texels are judged by their ends; longer ones may be seen between them.
bool pn_edge_hidden(vec3 p, vec3 q, vec2 outward) {
  vec2 texels = abs(q.xy - p.xy) * pn_lights[0].map_bounds[0].zw;
  return max(texels.x, texels.y) < 2.0 && pn_hidden(p, outward) && pn_hidden(q, outward);
}

void main() {
  int edge = min(int(gl_FragCoord.y) * PN_EDGE_ROW + int(gl_FragCoord.x), pn_count.x - 1);
  float side = pn_side(edge);
  vec4 corners = vec4(pn_no_smoothie);
  int turns = int(side + 0.75); // 0 or 1, which a compiler does not see: software skips a loop that no pixel nearby takes
  for (int i = 0; i < turns; i++) {
    uvec4 v = pn_edge(edge);
    vec3 a = pn_vertex(v.x), b = pn_vertex(v.y);
    if (!pn_before_cut(a) && !pn_before_cut(b)) break;
    vec3 p = pn_edge_end(a, b), q = pn_edge_end(b, a);
    vec2 along = q.xy - p.xy, outward = pn_outward(along, side);
    if (!(dot(outward, outward) > 0.5) || pn_reach(max(p.z, q.z)) <= 0.0 || pn_edge_hidden(p, q, outward)) break;
    along /= length(along);
    corners = vec4(pn_next_normal(edge, v.x, along, outward), pn_next_normal(edge, v.y, -along, outward));
  }
  pn_corner_out = corners;
}
