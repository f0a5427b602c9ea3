// How depth goes on around each pixel of a view that comes without normals: its slopes along x and y, and bounds on
// their errors. They are the same for every light and every pass of a frame, and cost five fetches each, so they are
// found once.
#include "shaders/precision.glsl"
#define PN_MASK 0 // slopes go on across what does not receive
#include "receiver/depth.glsl"

layout(location = 0) out vec4 pn_slopes; // along x: slope, error; along y

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
  float left = has[1] ? (has[0] ? abs(d[0] - 2.0 * d[1] + d0) : abs(d0 - d[1])) : PN_EVERYTHING;
  float right = has[3] ? (has[4] ? abs(d[4] - 2.0 * d[3] + d0) : abs(d0 - d[3])) : PN_EVERYTHING;
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

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float depth = pn_depth_at(pixel);
  pn_slopes = vec4(pn_slope(pixel, ivec2(1, 0), depth), pn_slope(pixel, ivec2(0, 1), depth));
}
