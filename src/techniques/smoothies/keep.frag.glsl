// Which silhouettes have a smoothie to draw: those that the light's centre sees. What hides the others has an outline
// nearer to the light, whose smoothie is darker.
#include "shaders/precision.glsl"
#include "techniques/smoothies/smoothie.glsl"

uniform highp sampler2DArray pn_maps;
layout(location = 0) out vec4 pn_kept_out;

// Whether the nearest caster beside a point of the edge lies before it.
bool pn_hidden(vec3 p, vec2 outward) {
  vec2 texel = pn_texel_size(0);
  vec2 st = p.xy + outward * max(texel.x, texel.y);
  int map = pn_map_at(0, st);
  return pn_map_fetch(0, pn_maps, map, 0, ivec2(floor(pn_map_texel(0, map, st)))) > p.z;
}

// Edges shorter than two texels are judged by their ends; longer ones may be seen between them.
bool pn_edge_hidden(vec3 p, vec3 q, vec2 outward) {
  vec2 texels = abs(q.xy - p.xy) / pn_texel_size(0);
  return max(texels.x, texels.y) < 2.0 && pn_hidden(p, outward) && pn_hidden(q, outward);
}

void main() {
  int edge = min(int(gl_FragCoord.y) * PN_EDGE_ROW + int(gl_FragCoord.x), pn_mesh.x - 1);
  float side = pn_side(edge);
  uvec4 v = pn_edge(edge);
  vec3 a = pn_vertex(v.x), b = pn_vertex(v.y);
  vec3 p = pn_edge_end(a, b), q = pn_edge_end(b, a);
  vec2 outward = pn_outward(q.xy - p.xy, side);
  bool kept = side > 0.0 && (pn_before_cut(a) || pn_before_cut(b)) && dot(outward, outward) > 0.5 &&
              pn_reach(max(p.z, q.z)) > 0.0 && !pn_edge_hidden(p, q, outward);
  pn_kept_out = vec4(kept ? 1.0 : 0.0);
}
