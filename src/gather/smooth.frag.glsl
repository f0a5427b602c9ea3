// One pass of the post-filter (Bitmask Soft Shadows, section 3.1): a pixel's visibility takes the place between its two
// neighbours' that its accumulated area has between theirs; along x or along y, whichever changes it less. Bounds on
// that are ours (pni_smoothing). docs/techniques/bitmask.md, "The post-filter".
#include "shaders/precision.glsl"
uniform highp sampler2D pn_from; // visibility; what the accumulated area leaves; axes: 1 x, 2 y; visibility at first
// share of the way; how much it may change in all, and neighbours may differ by; 1: only on one surface
uniform highp vec4 pn_bounds;
layout(location = 0) out vec4 pn_out;

#define PN_NO_CHANGE 2.0 // more than any

// The change along one axis, where the area tells one: where it and visibility grow the same way, it lies between its
// neighbours', and visibility changes so little that its steps could be seen.
float pn_change(vec2 at, vec2 before, vec2 after) {
  vec2 step = after - before;
  float place = at.y - before.y;
  bool tells = abs(step.x) <= pn_bounds.z && step.x * step.y > 0.0 && place * (after.y - at.y) > 0.0;
  return tells ? place / step.y * step.x + before.x - at.x : PN_NO_CHANGE;
}

vec2 pn_beside(ivec2 at) { return texelFetch(pn_from, clamp(at, ivec2(0), textureSize(pn_from, 0) - 1), 0).rg; }

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), axes = ivec2(1, 2);
  vec4 here = texelFetch(pn_from, at, 0);
  bvec2 one_surface = notEqual(ivec2(here.b) & axes, ivec2(0));
  float x = pn_change(here.rg, pn_beside(at - ivec2(1, 0)), pn_beside(at + ivec2(1, 0)));
  float y = pn_change(here.rg, pn_beside(at - ivec2(0, 1)), pn_beside(at + ivec2(0, 1)));
  if (pn_bounds.w > 0.0 && !one_surface.x) x = PN_NO_CHANGE;
  if (pn_bounds.w > 0.0 && !one_surface.y) y = PN_NO_CHANGE;
  float change = abs(x) < abs(y) ? x : y;
  float seen = here.r + (change < PN_NO_CHANGE ? pn_bounds.x * change : 0.0);
  pn_out = vec4(clamp(seen, here.a - pn_bounds.y, here.a + pn_bounds.y), here.gba);
}
