// A mesh's edges as the passes over them read them: tables in textures (silhouettes/edges.h).
#include "space/limits.glsl"
#include "space/space.glsl"

uniform highp usampler2D pn_edges;   // two ends, the vertices opposite in the two faces
uniform highp sampler2D pn_points;   // the vertices in the light's frame
uniform highp sampler2D pn_sides;    // 0: no silhouette, 1/2 or 1: on which side the mesh lies
uniform highp usampler2D pn_rings;   // by vertex: where its edges are listed, how many
uniform highp usampler2D pn_entries; // an edge, its other end
uniform highp ivec4 pn_mesh;         // edges; 1 for a sun; how many of a vertex's edges are looked at
uniform highp vec4 pn_cut;           // rectangle: what lies nearer than this is cut off

ivec2 pn_entry(int i) { return ivec2(i & (PN_EDGE_ROW - 1), i / PN_EDGE_ROW); }

bool pn_edge_parallel() { return pn_mesh.y != 0; }

uvec4 pn_edge(int edge) { return texelFetch(pn_edges, pn_entry(edge), 0); }

vec3 pn_vertex(uint vertex) { return texelFetch(pn_points, pn_entry(int(vertex)), 0).xyz; }

float pn_side(int edge) { return texelFetch(pn_sides, pn_entry(edge), 0).r; }

bool pn_before_cut(vec3 p) { return pn_edge_parallel() || p.z > pn_cut.x; }

// An end in (s, t, w); where the edge crosses the plane that is cut at, the place where it does.
vec3 pn_edge_end(vec3 p, vec3 other) {
  if (!pn_before_cut(p)) p = mix(p, other, (pn_cut.x - p.z) / (other.z - p.z));
  return pn_map_point(p, pn_edge_parallel());
}

// The normal in the map that points away from the mesh. along: from the edge's first end to its second.
vec2 pn_outward(vec2 along, float side) {
  vec2 right = vec2(along.y, -along.x) / max(length(along), PN_TINY);
  return side > 0.75 ? right : -right;
}
