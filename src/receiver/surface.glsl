// From the host's depth to surface points. Depth is affine along any plane in pixel coordinates, under perspective
// too, so planes are found there and carried over by the inverse transpose: no difference of nearly equal positions
// is ever taken.
#include "receiver/depth.glsl"

#if PN_NORMALS
uniform highp sampler2D pn_normal;
uniform mat3 pn_light_from_normal;
#else
uniform highp sampler2D pn_planes; // receiver/planes.frag.glsl
#endif
uniform mat4 pn_light_from_pixel; // (x + 1/2, y + 1/2, stored depth, 1) in the view
uniform mat4 pn_pixel_from_light;
uniform vec4 pn_lost; // by floats far from the origin, of surfaces and casters: by axes, and along z per z
uniform vec4 pn_eye; // the camera's centre in the light's frame; w 0: the direction to it

struct pn_Surface {
  vec3 p, n;   // light frame, n unit and turned to the camera
  vec3 error;  // bound on p's error
  float sigma; // bound on n's, radians
};

vec3 pn_point(ivec2 pixel, float depth) {
  vec4 h = pn_light_from_pixel * vec4(vec2(pixel) + 0.5, depth, 1.0);
  return h.xyz / h.w;
}

// A point and how far it may be off, with a depth that strays by so much beside its own error.
void pn_position_of(ivec2 pixel, float depth, float stray, out vec3 p, out vec3 error) {
  vec4 v = vec4(vec2(pixel) + 0.5, depth, 1.0);
  vec4 h = pn_light_from_pixel * v;
  p = h.xyz / h.w;
  // Depth's own error moves the point along the ray. A float matrix moves it anywhere: each term of a row is rounded
  // as an entry, as a product and in three sums, and a quotient may be off by 2.5 units in the last place: five
  // roundings of 2^-24 each time.
  vec4 along = pn_light_from_pixel[2], aside = pn_light_from_pixel[0];
  vec3 per_depth = (along.xyz - p * along.w) / h.w, per_pixel = (aside.xyz - p * aside.w) / h.w;
  vec4 a = abs(v);
  vec4 sum = abs(pn_light_from_pixel[0]) * a.x + abs(pn_light_from_pixel[1]) * a.y + abs(pn_light_from_pixel[2]) * a.z +
             abs(pn_light_from_pixel[3]);
  // What stands out of a straight surface by much less than a pixel's width is an error; by more, it may be there.
  if (stray * length(per_depth) > 0.125 * length(per_pixel)) stray = 0.0;
  error = abs(per_depth) * (pn_depth_error(depth) + stray) +
          3e-7 * ((sum.xyz + abs(p) * sum.w) / abs(h.w) + abs(p)) +
          pn_lost.xyz + vec3(0.0, 0.0, pn_lost.w * abs(p.z));
}

void pn_position(ivec2 pixel, float depth, out vec3 p, out vec3 error) {
  pn_position_of(pixel, depth, pn_stray(pixel, depth), p, error);
}

#if !PN_NORMALS
void pn_tangent_plane(ivec2 pixel, float depth, out vec3 n, out float sigma) {
  vec4 slopes = texelFetch(pn_planes, pixel, 0);
  vec2 gx = slopes.xy, gy = slopes.zw;
  vec2 at = vec2(pixel) + 0.5;
  // The plane depth = depth + gx (x - at.x) + gy (y - at.y) as a covector, taken to the light's frame by the
  // transpose of the inverse.
  vec4 plane = vec4(gx.x, gy.x, -1.0, depth - gx.x * at.x - gy.x * at.y) * pn_pixel_from_light;
  vec3 per_gx = (vec4(1.0, 0.0, 0.0, -at.x) * pn_pixel_from_light).xyz;
  vec3 per_gy = (vec4(0.0, 1.0, 0.0, -at.y) * pn_pixel_from_light).xyz;
  float size = length(plane.xyz);
  n = plane.xyz / size;
  sigma = (length(per_gx) * gx.y + length(per_gy) * gy.y) / size;
}
#else
vec3 pn_decode_normal(vec4 stored) {
#if PN_NORMALS == 1
  return stored.xyz;
#elif PN_NORMALS == 2
  return 2.0 * stored.xyz - 1.0;
#else
  vec2 e = PN_NORMALS == 3 ? stored.xy : 2.0 * stored.xy - 1.0;
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  float fold = max(-n.z, 0.0);
  n.x += n.x >= 0.0 ? -fold : fold;
  n.y += n.y >= 0.0 ? -fold : fold;
  return n;
#endif
}

void pn_tangent_plane(ivec2 pixel, float depth, out vec3 n, out float sigma) {
  vec3 given = pn_light_from_normal * pn_decode_normal(texelFetch(pn_normal, pn_offset.xy + pixel, 0));
  n = given / max(length(given), 1e-20);
  sigma = pn_quantum.w;
}
#endif

pn_Surface pn_surface(ivec2 pixel) {
  pn_Surface s;
  float depth = pn_depth_at(pixel);
  pn_position(pixel, depth, s.p, s.error);
  pn_tangent_plane(pixel, depth, s.n, s.sigma);
  if (dot(s.n, pn_eye.xyz - s.p * pn_eye.w) < 0.0) s.n = -s.n;
  return s;
}
