// How depth goes on around each pixel of a view that comes without normals: its slopes along x and y, and bounds on
// their errors. They are the same for every light and every pass of a frame, and cost five fetches each, so they are
// found once.
#include "shaders/precision.glsl"
#define PN_MASK 0 // slopes go on across what does not receive
#include "receiver/depth.glsl"

// Along x, then along y: a slope and a bound on its error, or, negative, how far it may lie on either side where faces
// are so narrow that depth tells no more.
layout(location = 0) out vec4 pn_slopes;

// How much depth bends from d0 over its neighbour d1 to the next one, d2. PN_EVERYTHING: d1 is another surface, since
// the step to it is nothing like the one behind it. Where d2 is another surface nothing tells whether d1 is: such a
// pair bends by its own step.
float pn_bend(float d0, float d1, float d2, bool has1, bool has2, float q) {
  if (!has1) return PN_EVERYTHING;
  float step = abs(d0 - d1), next = abs(d1 - d2);
  if (!has2 || next > 8.0 * (step + q)) return max(step, 5.0 * q);
  return step > 8.0 * (next + q) ? PN_EVERYTHING : abs(d0 - 2.0 * d1 + d2);
}

// Slope of depth along one axis from five neighbours. At an edge the side is taken on which depth goes on in a straight
// line; where both do, a wider baseline makes the error smaller.
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
  float before = pn_bend(d0, d[1], d[0], has[1], has[0], q), after = pn_bend(d0, d[3], d[4], has[3], has[4], q);
  float least = min(before, after), most = max(before, after), bend = d[1] - 2.0 * d0 + d[3];
  if (has[1] && has[3] && abs(bend) <= 4.0 * q) {
    bool wide = has[0] && has[4] && most <= 4.0 * q && abs(d[0] - 2.0 * d0 + d[4]) <= 4.0 * q;
    return wide ? vec2(0.25 * (d[4] - d[0]), 0.5 * q) : vec2(0.5 * (d[3] - d[1]), q);
  }
  float slope = before < after ? d0 - d[1] : d[3] - d0;
  bool stands_out = most < PN_EVERYTHING && (bend > 0.0) == (pn_quantum.z > 0.5);
  if (most <= 8.0 * q && stands_out) return vec2(slope, -abs(bend) - 2.0 * q); // right on an edge: of either face
  if (least <= 8.0 * q) return vec2(slope, least > 4.0 * q ? 2.0 * q + least : 2.0 * q);
  if (most == PN_EVERYTHING) return vec2(least < most ? slope : 0.0, -PN_EVERYTHING); // perhaps one pixel wide
  if (!stands_out) return vec2(slope, -least);
  // Between both sides; where depth bends unevenly, they may be other surfaces.
  bool even = max(most, abs(bend)) <= 4.0 * min(least, abs(bend)) + 8.0 * q;
  return vec2(0.5 * (d[3] - d[1]), even ? -0.5 * abs(bend) - 2.0 * q : -most);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float depth = pn_depth_at(pixel);
  pn_slopes = vec4(pn_slope(pixel, ivec2(1, 0), depth), pn_slope(pixel, ivec2(0, 1), depth));
}
