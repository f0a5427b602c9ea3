// Each pixel of the camera's view as a point in light map space.
#include "shaders/precision.glsl"
#include "maps/maps.glsl"
#include "receiver/surface.glsl"
#include "maps/receiver_map.glsl"

uniform vec4 pn_seen_depth; // smallest and largest w; width, height of the map
flat out ivec2 pn_pixel;

void main() {
  pn_pixel = ivec2(gl_VertexID % pn_view.z, gl_VertexID / pn_view.z);
  gl_PointSize = 1.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (!pn_receives(pn_pixel)) return;
  bool sun = pn_is_sun(0);
  vec3 p = pn_point(pn_pixel, pn_depth_at(pn_pixel));
  if (!sun && p.z <= 0.0) return;
  vec3 m = pn_map_point(p, sun);
  // To the centre of its texel: where a point on a border goes is then not the rasteriser's choice.
  vec2 texel = floor(pn_seen_texel(m.xy)) + 0.5;
  float depth = (pn_seen_depth.y - m.z) / (pn_seen_depth.y - pn_seen_depth.x);
  gl_Position = vec4(2.0 * texel / pn_seen_depth.zw - 1.0, 2.0 * depth - 1.0, 1.0);
}
