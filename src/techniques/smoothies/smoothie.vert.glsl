// Four triangles for each entry of the list: two along the edge, and one at each of its ends that makes a convex corner
// with the next edge, half of the corner. All reach a seam farther than they need, so that nothing shows between them
// or between them and the mesh.
#include "shaders/precision.glsl"
#include "techniques/smoothies/smoothie.glsl"
#include "techniques/smoothies/corner.glsl"

uniform highp usampler2D pn_list;
uniform highp usampler2D pn_total;

out highp vec2 pn_offset_out;   // from the edge's end, for corners
out highp vec3 pn_linear;       // kappa along this edge's normal, along the neighbour's; w
flat out highp vec2 pn_shape;   // 0 along the edge, 1 a rounded corner, 2 one shaped like the light; how sharp

float pn_seam() {
  vec2 texel = pn_map_texel_size(0, pn_mode.x);
  return 2.0 * pn_lights[0].raster_error * max(texel.x, texel.y);
}

void pn_place(vec2 st, float w) {
  vec2 texel = pn_map_texel(0, pn_mode.x, st);
  vec2 depth = pn_lights[0].maps[pn_mode.x].w_of_depth;
  gl_Position = vec4(2.0 * texel / vec2(pn_map_size(0, pn_mode.x)) - 1.0, 2.0 * (w - depth.x) / depth.y - 1.0, 1.0);
}

// index 0..5 of the two triangles along the edge.
void pn_straight(int index, vec3 p, vec3 q, vec2 n, vec2 x) {
  int corner = index > 2 ? index - 2 : index; // 0 1 2, 1 2 3
  vec2 along = q.xy - p.xy;
  float over = pn_seam() / length(along), width = dot(x, n);
  float tau = (corner & 1) == 0 ? -over : 1.0 + over;
  float kappa = corner < 2 ? -pn_seam() / width : pn_reach((corner & 1) == 0 ? p.z : q.z);
  float w = mix(p.z, q.z, tau);
  pn_linear = vec3(kappa, 0.0, w);
  pn_place(p.xy + tau * along + kappa * x, w);
}

// index 0..2 of the triangle at end v, between this edge and the half of the turn to the next, whose normal is m. Of
// rounded corners, with phi half the angle between the normals, points are wanted that lie at most reach A_o away,
// and A_o <= A_n cos + A_across sin in all directions of the triangle.
void pn_corner(int index, vec3 v, vec2 n, vec2 x, vec2 m, vec2 back) {
  float reach = pn_reach(v.z);
  vec2 a, b, y = pn_across(m);
  if (pn_cones()) {
    float turn = n.x * m.y - n.y * m.x;
    vec2 aside = vec2(x.x, -x.y);
    if ((x.x * aside.y - x.y * aside.x) * turn < 0.0) aside = -aside;
    a = x * reach;
    b = (y == -x ? aside : 0.5 * (x + y)) * reach;
  } else {
    vec2 sum = n + m;
    vec2 middle = length(sum) > 1e-3 ? normalize(sum) : back;
    float cosine = clamp(dot(n, middle), 0.0, 1.0), sine = sqrt(1.0 - cosine * cosine);
    float most = pn_fixed() ? pn_width.x : length(pn_extent(0));
    float size = min(pn_width_along(n) + pn_width_along(vec2(-n.y, n.x)) * sine, most);
    size *= reach / sqrt(0.5 + 0.5 * cosine);
    a = n * size;
    b = middle * size;
  }
  if (pn_cones() && x == y) b = a = vec2(0.0);
  vec2 side = length(a - b) > 0.0 ? 2.0 * pn_seam() * normalize(a - b) : vec2(0.0);
  vec2 inside = dot(a, a) > 0.0 ? -pn_seam() * normalize(a + b) : vec2(0.0);
  vec2 o = index == 0 ? inside : index == 1 ? a + side : b - side;
  vec2 widths = vec2(dot(x, n), pn_width_along(m));
  float sharp = 1.0 - max(dot(n, m), 0.0) * max(widths.x / widths.y, widths.y / widths.x);
  pn_offset_out = o;
  pn_linear = vec3(dot(o, n) / widths.x, dot(o, m) / widths.y, v.z);
  pn_shape = vec2(pn_cones() ? 2.0 : 1.0, pn_fixed() ? 0.0 : clamp(sharp, 0.0, 1.0));
  pn_place(v.xy + o, v.z);
}

void main() {
  int place = gl_VertexID / 12, index = gl_VertexID - 12 * place;
  gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
  pn_offset_out = vec2(0.0);
  pn_linear = vec3(0.0);
  pn_shape = vec2(0.0);
  if (uint(gl_VertexID) >= texelFetch(pn_total, ivec2(0), 0).x) return; // where the device cannot count its draws
  int edge = int(texelFetch(pn_list, pn_entry(place), 0).x);
  uvec4 v = pn_edge(edge);
  vec3 a = pn_vertex(v.x), b = pn_vertex(v.y);
  vec3 p = pn_edge_end(a, b), q = pn_edge_end(b, a);
  vec2 along = q.xy - p.xy, n = pn_outward(along, pn_side(edge)), x = pn_across(n), unit = normalize(along);
  if (index < 6) {
    pn_straight(index, p, q, n, x);
    return;
  }
  bool first = index < 9;
  vec2 back = first ? -unit : unit, m = pn_next_normal(edge, first ? v.x : v.y, -back, n);
  if (m != vec2(0.0)) pn_corner(index - (first ? 6 : 9), first ? p : q, n, x, m, back);
}
