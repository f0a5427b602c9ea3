// One layer of the map of seen surfaces: each pixel of the camera's view as a point in light map space. Of those that
// fall into a texel the depth test keeps the one nearest to the light; those that lie on the layer before are left
// out. All of it happens here, once a pixel, and nothing for each fragment.
#include "shaders/precision.glsl"
#include "maps/maps.glsl"
#include "receiver/surface.glsl"
#include "techniques/ssm/seen.glsl"

uniform vec4 pn_seen_depth; // smallest and largest w; width, height of the map
uniform ivec4 pn_pixels;    // of the view, those that may show something of the map: x, y, width
#if PN_PEEL
uniform highp sampler2DArray pn_seen;
uniform ivec4 pn_layer; // the one before
#endif
flat out vec4 pn_texel;

// Error of the tangent plane's test against blockers that can shade this receiver, but for that of the normal's angle.
// A surface that bends towards the light (a crease, a facetted mesh) rises in front of the plane on the way to a
// sample; what is lower than a texel neither map can tell from the surface itself.
float pn_plane_error(pn_Surface s, vec3 m, float k, bool sun) {
  float map_error = pn_lights[0].w_error, scale = sun ? 1.0 : m.z;
  vec2 texel = max(pn_texel_size(0), 1.0 / pn_seen_bounds.zw);
  return scale * (dot(abs(s.n), s.error) + s.lift) + abs(k) * map_error + max(texel.x, texel.y);
}

// What an angle sigma moves the test of a sample by, for each unit of dw: the lever is |ds| + |dt| + reach dw, and a
// sample that hides light has |ds| <= A_u dw, |dt| <= A_v dw.
float pn_plane_lever(pn_Surface s, bool sun) {
  float reach = sun ? 1.0 : length(s.p);
  return (s.sigma + 1e-6) * (pn_extent(0).x + pn_extent(0).y + reach);
}

void main() {
  ivec2 pixel = pn_pixels.xy + ivec2(gl_VertexID % pn_pixels.z, gl_VertexID / pn_pixels.z);
  gl_PointSize = 1.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // out of sight
  pn_texel = vec4(0.0);
  if (!pn_receives(pixel)) return;
  bool sun = pn_is_parallel(0);
  pn_Surface s = pn_surface(pixel);
  vec3 m = pn_map_point(s.p, sun);
  float k = pn_plane_offset(s.n, s.p, sun);
  // Behind the light, or turned away from all of it.
  if ((!sun && s.p.z <= 0.0) || dot(abs(s.n.xy), pn_extent(0)) - k <= 0.0) return;
  vec2 centre = floor(pn_seen_texel(m.xy)) + 0.5, off = pn_seen_st(centre) - m.xy;
  float thickness = pn_seen_thickness(m.z, sun);
#if PN_PEEL
  ivec2 last = textureSize(pn_seen, 0).xy - 1;
  vec4 before = texelFetch(pn_seen, ivec3(clamp(ivec2(centre), ivec2(0), last), pn_layer.x), 0);
  if (m.z >= before.x + pn_seen_rise(before.yz, before.w, -off, 4.0 * thickness) - thickness) return;
#endif
  float w = m.z + pn_seen_rise(s.n.xy, k, off, 4.0 * thickness);
  pn_texel = vec4(w, vec3(s.n.xy, k + pn_plane_lever(s, sun)) / pn_plane_error(s, m, k, sun));
  // At its texel's centre: where a point on a border goes is then not the rasteriser's choice.
  // Whose plane is known speaks for the texel before who lies on the same surface and only knows bounds.
  float nearness = m.z - (s.lift > 0.0 ? thickness : 0.0);
  float depth = (pn_seen_depth.y - nearness) / (pn_seen_depth.y - pn_seen_depth.x);
  gl_Position = vec4(2.0 * centre / pn_seen_depth.zw - 1.0, 2.0 * clamp(depth, 0.0, 1.0) - 1.0, 1.0);
}
