// One layer of the receiver map: of the pixels that fall into a texel, the one nearest to the light that does not lie
// on the layer before.
#include "shaders/precision.glsl"
#include "maps/maps.glsl"
#include "receiver/surface.glsl"
#include "maps/receiver_map.glsl"

#if PN_PEEL
uniform highp sampler2DArray pn_seen;
uniform ivec4 pn_layer; // the one before
#endif
flat in ivec2 pn_pixel;
layout(location = 0) out vec4 pn_out;

// Error of the tangent plane's test against blockers that can shade this receiver. A surface that bends towards the
// light (a crease, a facetted mesh) rises in front of the plane on the way to a sample; what is lower than a texel
// neither map can tell from the surface itself.
float pn_plane_error(pn_Surface s, vec3 m, float k, bool sun) {
  float near = pn_lights[0].range.x, map_error = pn_lights[0].range.z;
  vec2 lever = pn_search_window(pn_extent(0), near, m.z);
  float scale = sun ? 1.0 : m.z, reach = sun ? 1.0 : length(s.p);
  vec2 texel = max(1.0 / pn_lights[0].map_bounds[0].zw, 1.0 / pn_seen_bounds.zw);
  return scale * dot(abs(s.n), s.error) + abs(k) * map_error + max(texel.x, texel.y) +
         (s.sigma + 1e-6) * (lever.x + lever.y + reach * max(near - m.z, 0.0));
}

void main() {
  bool sun = pn_is_sun(0);
  pn_Surface s = pn_surface(pn_pixel);
  vec3 m = pn_map_point(s.p, sun);
  float k = pn_plane_offset(s.n, s.p, sun);
  if (dot(abs(s.n.xy), pn_extent(0)) - k <= 0.0) discard; // no part of the light shines on it
  ivec2 texel = ivec2(gl_FragCoord.xy);
  float thickness = pn_seen_thickness(m.z, sun);
#if PN_PEEL
  vec4 before = texelFetch(pn_seen, ivec3(texel, pn_layer.x), 0);
  vec2 off = m.xy - pn_seen_st(vec2(texel) + 0.5);
  if (m.z >= before.x + pn_seen_rise(before.yz, before.w, off, 4.0 * thickness) - thickness) discard;
#endif
  float w = m.z + pn_seen_rise(s.n.xy, k, pn_seen_st(vec2(texel) + 0.5) - m.xy, 4.0 * thickness);
  pn_out = vec4(w, vec3(s.n.xy, k) / pn_plane_error(s, m, k, sun));
}
