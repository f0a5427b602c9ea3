// For each block of PN_BLOCK x PN_BLOCK pixels a plane w = c + a (s - s0) + b (t - t0) that none of it lies below,
// around the middle (s0, t0) of its bounds. Any plane with slopes that the light's window allows will do
// (docs/space.md): of a few that go through pixels of the block, and one without slopes, the highest in the middle is
// taken. So where the block shows one flat surface the plane is the surface's. With PN_GIVEN slopes are given, and the
// plane is as high as the pixels' errors let it be.
#include "shaders/precision.glsl"
#include "space/limits.glsl"
#define PN_BLOCK 16
#define PN_NORMALS 1 // only positions are wanted here
#include "space/space.glsl"
#include "receiver/surface.glsl"
uniform int pn_parallel;
#if PN_GIVEN
uniform vec4 pn_given; // slopes of the plane, the same for all blocks
#endif
uniform vec4 pn_window;           // A_u, A_v; the largest of their sum with the slopes
uniform highp sampler2D pn_least; // receiver/bounds.frag.glsl
uniform highp sampler2D pn_most;
layout(location = 0) out vec4 pn_plane; // a, b, c; error of w

#define PN_CANDIDATES 6

bool pn_counts(ivec2 at) { return pn_view_has(at) && pn_receives(at); }

// (s, t, w) beside the middle. False: nothing that counts is seen there.
bool pn_seen_at(ivec2 at, vec2 middle, out vec3 m) {
  m = vec3(0.0);
  if (!pn_counts(at)) return false;
  vec3 p = pn_point(at, pn_depth_at(at));
  if (pn_parallel == 0 && p.z <= 0.0) return false;
  m = pn_map_point(p, pn_parallel != 0);
  m.xy -= middle;
  return true;
}

// A bound on how far w - a s - b t may be off there.
float pn_error_at(ivec2 at, vec2 slopes) {
  float depth = pn_depth_at(at);
  vec3 p, e;
  pn_position(at, depth, p, e);
  vec3 m = pn_map_point(p, pn_parallel != 0);
  if (pn_parallel == 0) e = vec3(e.xy + abs(m.xy) * e.z, m.z * e.z) * m.z;
  e += 3e-7 * abs(m);
  return e.z + dot(abs(slopes), e.xy);
}

// Slopes of the plane through three pixels, as far as the window allows.
vec2 pn_slopes_at(ivec2 at, int apart, vec2 middle) {
  vec3 m0, m1, m2;
  bool all3 = pn_seen_at(at, middle, m0) && pn_seen_at(at + ivec2(apart, 0), middle, m1) &&
              pn_seen_at(at + ivec2(0, apart), middle, m2);
  if (!all3) return vec2(0.0);
  vec3 d1 = m1 - m0, d2 = m2 - m0;
  float area = d1.x * d2.y - d1.y * d2.x;
  if (abs(area) <= 1e-6 * length(d1.xy) * length(d2.xy)) return vec2(0.0);
  vec2 slopes = vec2(d1.z * d2.y - d1.y * d2.z, d1.x * d2.z - d1.z * d2.x) / area;
  float share = dot(abs(slopes), pn_window.xy);
  return share > pn_window.z ? slopes * (pn_window.z / share) : slopes;
}

// Slopes to try: none; those of all of the block, of its quarters.
vec2 pn_candidate(int i, ivec2 base, vec2 middle) {
  if (i == 0) return vec2(0.0);
  if (i == 1) return pn_slopes_at(base, PN_BLOCK - 1, middle);
  return pn_slopes_at(base + 1 + ivec2(i & 1, (i - 2) >> 1) * (PN_BLOCK / 2), PN_BLOCK / 2 - 3, middle);
}

void main() {
  ivec2 block = ivec2(gl_FragCoord.xy), base = block * PN_BLOCK;
  vec2 middle = 0.5 * (texelFetch(pn_least, block, 0).xy + texelFetch(pn_most, block, 0).xy);
#if PN_GIVEN
  // Each pixel is taken as high as it may be. Errors are those of the lowest one so far, but for pixels that lie lower
  // than that by more.
  float lowest = PN_EVERYTHING, error = 0.0;
#else
  vec2 slopes[PN_CANDIDATES];
  float offset[PN_CANDIDATES];
  for (int i = 0; i < PN_CANDIDATES; i++) {
    offset[i] = PN_EVERYTHING;
    slopes[i] = pn_candidate(i, base, middle);
  }
  ivec2 nearest = base, farthest = base; // by depth: errors are largest at one of them
  float least = PN_EVERYTHING, most = PN_NOTHING;
#endif
  for (int y = 0; y < PN_BLOCK; y++)
    for (int x = 0; x < PN_BLOCK; x++) {
      ivec2 at = base + ivec2(x, y);
      vec3 m;
      if (!pn_seen_at(at, middle, m)) continue;
#if PN_GIVEN
      float own = m.z - dot(pn_given.xy, m.xy);
      if (own + error < lowest) {
        error = 3.0 * pn_error_at(at, pn_given.xy);
        lowest = min(lowest, own + error);
      }
#else
      float depth = pn_depth_at(at);
      if (depth < least) nearest = at;
      if (depth > most) farthest = at;
      least = min(least, depth);
      most = max(most, depth);
      for (int i = 0; i < PN_CANDIDATES; i++) offset[i] = min(offset[i], m.z - dot(slopes[i], m.xy));
#endif
    }
#if PN_GIVEN
  pn_plane = vec4(pn_given.xy, lowest, 0.0);
#else
  int best = 0;
  for (int i = 1; i < PN_CANDIDATES; i++)
    if (offset[i] > offset[best]) best = i;
  float worst = max(pn_error_at(nearest, slopes[best]), pn_error_at(farthest, slopes[best]));
  pn_plane = vec4(slopes[best], offset[best], worst);
#endif
}
