// Which edges are silhouettes, seen from the light's centre: those whose faces lie on one side of the plane through
// the edge and the light. That is so where one face looks at the light and the other away, however they are wound,
// and where there is one face only. silhouettes.c has the same in C.
#include "shaders/precision.glsl"
#include "silhouettes/edges.glsl"

layout(location = 0) out vec4 pn_side_out;

// Six times the volume of the edge, the vertex, and the light's centre (or the direction to it); > 0 on one side.
float pn_plane_side(vec3 p, vec3 e, vec3 q, vec3 d) {
  vec3 f = q - p;
  vec3 c = vec3(e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x);
  return (c.x * d.x + c.y * d.y) + c.z * d.z;
}

void main() {
  int edge = min(int(gl_FragCoord.y) * PN_EDGE_ROW + int(gl_FragCoord.x), pn_mesh.x - 1);
  uvec4 v = pn_edge(edge);
  vec3 p = pn_vertex(v.x), e = pn_vertex(v.y) - p;
  vec3 d = pn_edge_parallel() ? vec3(0.0, 0.0, 1.0) : p;
  float a = pn_plane_side(p, e, pn_vertex(v.z), d), b = pn_plane_side(p, e, pn_vertex(v.w), d);
  // A face seen from its edge lies on both sides; numbers that are none compare false.
  bool left = a >= 0.0 && b >= 0.0 && (a > 0.0 || b > 0.0);
  bool right = a <= 0.0 && b <= 0.0 && (a < 0.0 || b < 0.0);
  pn_side_out = vec4(left ? 1.0 : right ? 0.5 : 0.0);
}
