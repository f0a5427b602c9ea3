// A mesh's vertices in the light's frame, once for each, since every edge wants four of them.
#include "shaders/precision.glsl"

uniform highp sampler2D pn_positions; // the floats of the mesh's buffer
uniform highp mat4 pn_light_from_object;
uniform highp ivec4 pn_layout; // vertices, floats from one to the next
layout(location = 0) out vec4 pn_point_out;

float pn_number(int i) {
  return texelFetch(pn_positions, ivec2(i & (PN_POSITION_ROW - 1), i / PN_POSITION_ROW), 0).r;
}

void main() {
  int vertex = int(gl_FragCoord.y) * PN_EDGE_ROW + int(gl_FragCoord.x);
  int at = min(vertex, pn_layout.x - 1) * pn_layout.y;
  vec3 p = vec3(pn_number(at), pn_number(at + 1), pn_number(at + 2));
  // In this order of operations; silhouettes.c has the same.
  vec3 q = ((pn_light_from_object[0].xyz * p.x + pn_light_from_object[1].xyz * p.y) +
            pn_light_from_object[2].xyz * p.z) + pn_light_from_object[3].xyz;
  pn_point_out = vec4(q, 1.0);
}
