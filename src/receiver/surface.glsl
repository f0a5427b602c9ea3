// From the host's depth to surface points. Depth is affine along any plane in pixel coordinates, under perspective
// too, so planes are found there and carried over by the inverse transpose: no difference of nearly equal positions
// is ever taken.

uniform highp sampler2D pn_depth;
#if PN_NORMALS
uniform highp sampler2D pn_normal;
uniform mat3 pn_light_from_normal;
#endif
#if PN_MASK
uniform highp sampler2D pn_mask;
#endif
uniform mat4 pn_light_from_pixel; // (x + 1/2, y + 1/2, stored depth, 1) in the view
uniform mat4 pn_pixel_from_light;
uniform vec4 pn_eye;     // the camera's centre in the light's frame; w 0: the direction to it
uniform ivec4 pn_view;   // origin in the textures, width, height
uniform ivec4 pn_offset; // origin in normal and mask textures, scale, sample in the block of scale x scale pixels
uniform vec4 pn_quantum; // error of a depth: absolute, relative; background depth; angle error of given normals

struct pn_Surface {
  vec3 p, n;   // light frame, n unit and turned to the camera
  vec3 error;  // bound on p's error
  float sigma; // bound on n's, radians
};

bool pn_view_has(ivec2 pixel) { return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, pn_view.zw)); }

float pn_depth_at(ivec2 pixel) { return texelFetch(pn_depth, pn_view.xy + pixel, 0).r; }

bool pn_is_background(float depth) { return depth == pn_quantum.z; }

// Whether the pixel shows a surface that receives.
bool pn_receives(ivec2 pixel) {
  if (pn_is_background(pn_depth_at(pixel))) return false;
#if PN_MASK
  if (texelFetch(pn_mask, pn_offset.xy + pixel, 0).r == 0.0) return false;
#endif
  return true;
}

float pn_depth_error(float depth) { return max(pn_quantum.x, pn_quantum.y * abs(depth)); }

vec3 pn_point(ivec2 pixel, float depth) {
  vec4 h = pn_light_from_pixel * vec4(vec2(pixel) + 0.5, depth, 1.0);
  return h.xyz / h.w;
}

void pn_position(ivec2 pixel, float depth, out vec3 p, out vec3 error) {
  vec4 v = vec4(vec2(pixel) + 0.5, depth, 1.0);
  vec4 h = pn_light_from_pixel * v;
  p = h.xyz / h.w;
  // Depth's own error moves the point along the ray. A float matrix moves it anywhere: each term of a row is rounded
  // as an entry, as a product and in three sums, and a quotient may be off by 2.5 units in the last place: five
  // roundings of 2^-24 each time.
  vec4 along = pn_light_from_pixel[2];
  vec4 a = abs(v);
  vec4 sum = abs(pn_light_from_pixel[0]) * a.x + abs(pn_light_from_pixel[1]) * a.y + abs(pn_light_from_pixel[2]) * a.z +
             abs(pn_light_from_pixel[3]);
  error = abs((along.xyz - p * along.w) / h.w) * pn_depth_error(depth) +
          3e-7 * ((sum.xyz + abs(p) * sum.w) / abs(h.w) + abs(p));
}

#if !PN_NORMALS
// Slope of depth along one axis from five neighbours, and a bound on its error. At an edge the side is taken on which
// depth goes on in a straight line; where both do, a wider baseline makes the error smaller.
vec2 pn_slope(ivec2 pixel, ivec2 axis, float d0) {
  float d[5];
  bool has[5];
  for (int i = 0; i < 5; i++) {
    ivec2 at = pixel + (i - 2) * axis;
    has[i] = pn_view_has(at);
    d[i] = has[i] ? pn_depth_at(at) : 0.0;
    has[i] = has[i] && !pn_is_background(d[i]);
  }
  float q = pn_depth_error(d0);
  float left = has[1] ? (has[0] ? abs(d[0] - 2.0 * d[1] + d0) : abs(d0 - d[1])) : 1e30;
  float right = has[3] ? (has[4] ? abs(d[4] - 2.0 * d[3] + d0) : abs(d0 - d[3])) : 1e30;
  if (has[1] && has[3] && abs(d[1] - 2.0 * d0 + d[3]) <= 4.0 * q) {
    bool wide = has[0] && has[4] && left <= 4.0 * q && right <= 4.0 * q && abs(d[0] - 2.0 * d0 + d[4]) <= 4.0 * q;
    return wide ? vec2(0.25 * (d[4] - d[0]), 0.5 * q) : vec2(0.5 * (d[3] - d[1]), q);
  }
  if (!has[1] && !has[3]) return vec2(0.0, 0.0); // a surface one pixel wide: as if it faced the camera
  // Where neither side goes on straight, faces are two pixels wide or less: the slope stays open by as much as it
  // bends.
  float open = min(left, right) > 4.0 * q ? min(left, right) : 0.0;
  return left < right ? vec2(d0 - d[1], 2.0 * q + open) : vec2(d[3] - d0, 2.0 * q + open);
}

void pn_tangent_plane(ivec2 pixel, float depth, out vec3 n, out float sigma) {
  vec2 gx = pn_slope(pixel, ivec2(1, 0), depth);
  vec2 gy = pn_slope(pixel, ivec2(0, 1), depth);
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
