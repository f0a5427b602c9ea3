// Slopes of planes that a block of pixels may show, for receiver/patches.frag.glsl: each texel finds one of the block's
// PN_TRIED, those of all of the block, then of its quarters. As far as the light's window allows (docs/space.md).
#include "shaders/precision.glsl"
#include "space/limits.glsl"
#define PN_BLOCK 16
#define PN_TRIED 5
#define PN_NORMALS 1 // only positions are wanted here
#include "space/space.glsl"
#include "receiver/surface.glsl"
uniform int pn_parallel;
uniform vec4 pn_window; // A_u, A_v; the largest of their sum with the slopes
layout(location = 0) out vec4 pn_slopes;

// (s, t, w). False: nothing that counts is seen there.
bool pn_seen_at(ivec2 at, out vec3 m) {
  m = vec3(0.0);
  if (!pn_view_has(at) || !pn_receives(at)) return false;
  vec3 p = pn_point(at, pn_depth_at(at));
  if (pn_parallel == 0 && p.z <= 0.0) return false;
  m = pn_map_point(p, pn_parallel != 0);
  return true;
}

vec2 pn_slopes_at(ivec2 at, int apart) {
  vec3 m0, m1, m2;
  bool all3 =
      pn_seen_at(at, m0) && pn_seen_at(at + ivec2(apart, 0), m1) && pn_seen_at(at + ivec2(0, apart), m2);
  if (!all3) return vec2(0.0);
  vec3 d1 = m1 - m0, d2 = m2 - m0;
  float area = d1.x * d2.y - d1.y * d2.x;
  if (abs(area) <= 1e-6 * length(d1.xy) * length(d2.xy)) return vec2(0.0);
  vec2 slopes = vec2(d1.z * d2.y - d1.y * d2.z, d1.x * d2.z - d1.z * d2.x) / area;
  float share = dot(abs(slopes), pn_window.xy);
  return share > pn_window.z ? slopes * (pn_window.z / share) : slopes;
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy), base = ivec2(texel.x / PN_TRIED, texel.y) * PN_BLOCK;
  int tried = texel.x % PN_TRIED, quarter = tried - 1;
  ivec2 at = tried == 0 ? base : base + 1 + ivec2(quarter & 1, quarter >> 1) * (PN_BLOCK / 2);
  pn_slopes = vec4(pn_slopes_at(at, tried == 0 ? PN_BLOCK - 1 : PN_BLOCK / 2 - 3), 0.0, 0.0);
}
