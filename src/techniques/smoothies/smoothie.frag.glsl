// A smoothie's texel. A point of it at (kappa, w) gives a receiver at w_R the visibility kappa / (w - w_R). Its
// reciprocal is linear in w_R, so its values at a few w_R stand for all of them; where smoothies overlap the least
// visibility counts, and so does the greatest reciprocal. It is stored negative, and the minimum is kept.
#include "shaders/precision.glsl"
#include "techniques/smoothies/smoothie.glsl"

uniform highp sampler2DArray pn_maps;
flat in highp vec3 pn_p;
flat in highp vec3 pn_q;
flat in highp vec4 pn_outwards;
flat in highp vec4 pn_neighbours;
layout(location = 0) out vec4 pn_out;

const float none = 1e30;

// Kappa at offset o from the corner between normals n and m: distance over the light's width in its direction, and
// where the corner is sharp as far out as the two edges' smoothies would meet.
float pn_round_corner(vec2 o, vec2 n, vec2 m) {
  vec2 width = vec2(pn_width_along(n), pn_width_along(m));
  float size = length(o), rounded = size > 0.0 ? size / pn_width_along(o / size) : 0.0;
  float straight = max(dot(n, o) / width.x, dot(m, o) / width.y);
  float sharp = 1.0 - max(dot(n, m), 0.0) * max(width.x / width.y, width.y / width.x);
  return pn_fixed() ? rounded : mix(rounded, max(rounded, straight), clamp(sharp, 0.0, 1.0));
}

float pn_cross(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }

// Kappa at offset o from an end of the edge, in the corner between this edge and its neighbour; none outside.
float pn_corner_kappa(vec2 o, vec2 n, vec2 x, vec2 m) {
  if (m == vec2(0.0)) return none;
  if (!pn_cones()) // each edge draws its half, and a hair more
    return dot(o, n) >= dot(o, m) - 1e-3 * length(o) ? pn_round_corner(o, n, m) : none;
  vec2 y = pn_across(m), extent = pn_smoothie_extent();
  float turn = pn_cross(n, m) < 0.0 ? -1.0 : 1.0;
  bool between = turn * pn_cross(x, o) >= 0.0 && (y == -x || turn * pn_cross(o, y) >= 0.0);
  return between ? max(abs(o.x) / extent.x, abs(o.y) / extent.y) : none;
}

void main() {
  vec2 n = pn_outwards.xy, x = pn_outwards.zw, along = pn_q.xy - pn_p.xy;
  vec2 o = pn_map_st(0, pn_mode.x, gl_FragCoord.xy) - pn_p.xy;
  float d = dot(o, n), seam = pn_seam();
  float kappa = d / dot(x, n);
  float tau = dot(o - kappa * x, along) / dot(along, along), over = seam / length(along);
  float w = mix(pn_p.z, pn_q.z, clamp(tau, 0.0, 1.0));
  if (tau < -over) kappa = pn_corner_kappa(o, n, x, pn_neighbours.xy);
  else if (tau > 1.0 + over) kappa = pn_corner_kappa(o - along, n, x, pn_neighbours.zw);
  else if (d < -seam) kappa = none;
  // Behind the nearest caster there is nothing left to darken; and within the seam a caster that goes on there, no
  // steeper than the map can tell, is the edge's own.
  float nearest = pn_map_fetch(0, pn_maps, pn_mode.x, 0, ivec2(gl_FragCoord.xy));
  float beyond = d < 0.0 ? 64.0 * seam * (pn_is_sun(0) ? 1.0 : w) : 0.0;
  if (w - beyond <= nearest || kappa >= none) {
    pn_out = vec4(none);
    return;
  }
  if (pn_fixed() && !pn_is_sun(0)) kappa *= w;
  vec2 range = vec2(pn_lights[0].extent.w, pn_lights[0].range.x);
  vec4 w_receiver = mix(range.xxxx, range.yyyy, vec4(0.0, 1.0, 2.0, 3.0) / 3.0);
  pn_out = (w_receiver - w) / max(kappa, 1e-9 * (range.y - range.x));
}
