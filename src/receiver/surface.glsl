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
uniform vec4 pn_shining; // the light's half extents, 0; w 0: a sun

struct pn_Surface {
  vec3 p, n;   // light frame, n unit and turned to the camera
  vec3 error;  // bound on p's error
  float sigma; // bound on n's, radians
  float lift;  // what it may rise above its plane, where it is so narrow that only bounds of n are known
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
// From a point towards the light, to the share of the way from its centre to a corner: the one that the plane sees
// most of, or least where the share is negative.
vec3 pn_to_light(vec3 p, vec3 plane, float share) {
  vec2 corner = share * pn_shining.xy * vec2(plane.x < 0.0 ? -1.0 : 1.0, plane.y < 0.0 ? -1.0 : 1.0);
  return pn_shining.w == 0.0 ? vec3(corner, -1.0) : vec3(corner, 0.0) - p;
}

// Of the planes a + t b, |t| <= width, the one that faces a point of the light most: the cosine has at most one
// stationary point in t, and its largest value there or at an end.
vec3 pn_lightest(vec3 a, vec3 b, float width, vec3 light) {
  float al = dot(a, light), bl = dot(b, light), ab = dot(a, b), below = al * dot(b, b) - bl * ab;
  float t = below != 0.0 ? clamp((bl * dot(a, a) - al * ab) / below, -width, width) : 0.0;
  vec3 planes[3] = vec3[](a - width * b, a + t * b, a + width * b), best = planes[0];
  for (int i = 1; i < 3; i++)
    if (dot(planes[i], light) * length(best) > dot(best, light) * length(planes[i])) best = planes[i];
  return best;
}

// The first of them, seen from a, that sees the point, or the last that does not.
vec3 pn_turned(vec3 a, vec3 b, float width, vec3 light) {
  float al = dot(a, light), bl = dot(b, light);
  return al < 0.0 && bl != 0.0 ? a + clamp(-al / bl, -width, width) * b : a;
}

// Where a surface is narrower than slopes take, its plane may be any of a few. One that sees all of the light is taken
// if there is any, since whatever casts on the surface is in front of it too: the one that faces it most. If none does,
// one that sees some of it: a plane that sees none is lit whatever casts (docs/space.md).
vec3 pn_plane_of(vec3 p, vec3 plane, vec3 per_gx, vec3 per_gy, vec2 widths) {
  vec3 centre = pn_to_light(p, plane, 0.0);
  vec3 lightest = pn_lightest(pn_lightest(plane, per_gx, widths.x, centre), per_gy, widths.y, centre);
  if (dot(lightest, pn_to_light(p, lightest, -1.0)) >= 0.0) return lightest;
  vec3 some = pn_to_light(p, plane, 0.5);
  return pn_turned(pn_turned(plane, per_gx, widths.x, some), per_gy, widths.y, some);
}

// Slopes of unlimited error turn a plane edge-on, nearly.
float pn_half_width(float error, vec3 plane, vec3 per_slope) {
  return min(max(-error, 0.0), 1e3 * length(plane) / max(length(per_slope), 1e-30));
}

void pn_tangent_plane(ivec2 pixel, float depth, inout pn_Surface s) {
  vec4 slopes = texelFetch(pn_planes, pixel, 0);
  vec2 at = vec2(pixel) + 0.5;
  // The plane depth = depth + gx (x - at.x) + gy (y - at.y) as a covector, taken to the light's frame by the
  // transpose of the inverse.
  vec3 plane = (vec4(slopes.xz, -1.0, depth - dot(slopes.xz, at)) * pn_pixel_from_light).xyz;
  vec3 per_gx = (vec4(1.0, 0.0, 0.0, -at.x) * pn_pixel_from_light).xyz;
  vec3 per_gy = (vec4(0.0, 1.0, 0.0, -at.y) * pn_pixel_from_light).xyz;
  // All planes through the point turn the same side to the camera.
  if (dot(plane, pn_eye.xyz - s.p * pn_eye.w) < 0.0) plane = -plane, per_gx = -per_gx, per_gy = -per_gy;
  float size = length(plane);
  s.sigma = (length(per_gx) * max(slopes.y, 0.0) + length(per_gy) * max(slopes.w, 0.0)) / size;
  s.lift = 0.0;
  if (min(slopes.y, slopes.w) < 0.0) {
    float wx = pn_half_width(slopes.y, plane, per_gx), wy = pn_half_width(slopes.w, plane, per_gy);
    float turn = (length(per_gx) * wx + length(per_gy) * wy) / size;
    s.lift = min(turn, 1.0) * length(pn_point(pixel + ivec2(1, 0), depth) - s.p);
    plane = pn_plane_of(s.p, plane, per_gx, per_gy, vec2(wx, wy));
  }
  s.n = normalize(plane);
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

void pn_tangent_plane(ivec2 pixel, float depth, inout pn_Surface s) {
  vec3 given = pn_light_from_normal * pn_decode_normal(texelFetch(pn_normal, pn_offset.xy + pixel, 0));
  s.n = given / max(length(given), 1e-20);
  if (dot(s.n, pn_eye.xyz - s.p * pn_eye.w) < 0.0) s.n = -s.n;
  s.sigma = pn_quantum.w;
  s.lift = 0.0;
}
#endif

pn_Surface pn_surface(ivec2 pixel) {
  pn_Surface s;
  float depth = pn_depth_at(pixel);
  pn_position(pixel, depth, s.p, s.error);
  pn_tangent_plane(pixel, depth, s);
  return s;
}
