// For each block of PN_BLOCK x PN_BLOCK pixels a plane w = c + a (s - s0) + b (t - t0) that none of it lies below,
// around the middle (s0, t0) of its bounds. Any plane with slopes that the light's window allows will do
// (docs/space.md): of a few that go through pixels of the block, and one without slopes, the highest in the middle is
// taken. So where the block shows one flat surface the plane is the surface's. With PN_GIVEN slopes are given, and the
// plane is as high as the pixels' errors let it be.
#include "shaders/precision.glsl"
#include "space/limits.glsl"
#define PN_BLOCK 16
#define PN_TRIED 5       // of receiver/slopes.frag.glsl
#define PN_NORMALS 1     // only positions are wanted here
#include "space/space.glsl"
#include "receiver/surface.glsl"
uniform int pn_parallel;
#if PN_GIVEN
uniform vec4 pn_given; // slopes of the plane, the same for all blocks
#else
uniform highp sampler2D pn_tried; // receiver/slopes.frag.glsl
#endif
uniform highp sampler2D pn_least; // receiver/bounds.frag.glsl
uniform highp sampler2D pn_most;
layout(location = 0) out vec4 pn_plane; // a, b, c; error of w

// A bound on how far w - a s - b t may be off there.
float pn_error_at(ivec2 at, float depth, float stray, vec2 slopes) {
  vec3 p, e;
  pn_position_of(at, depth, stray, p, e);
  vec3 m = pn_map_point(p, pn_parallel != 0);
  if (pn_parallel == 0) e = vec3(e.xy + abs(m.xy) * e.z, m.z * e.z) * m.z;
  e += 3e-7 * abs(m);
  return e.z + dot(abs(slopes), e.xy);
}

// (s, t, w) beside the middle. False: nothing that counts is seen there.
bool pn_seen(ivec2 at, float depth, vec2 middle, out vec3 m) {
  vec3 p = pn_point(at, depth);
  m = pn_map_point(p, pn_parallel != 0) - vec3(middle, 0.0);
  return !pn_is_background(depth) && (pn_parallel != 0 || p.z > 0.0);
}

#if PN_GIVEN
// Each pixel is taken as high as it may be. Errors are those of the lowest one so far, but for pixels that lie lower
// than that by more.
vec4 pn_plane_below(ivec2 base, vec2 middle) {
  float lowest = PN_EVERYTHING, error = 0.0;
  for (int i = 0; i < PN_BLOCK * PN_BLOCK; i++) {
    ivec2 at = base + ivec2(i % PN_BLOCK, i / PN_BLOCK);
    vec3 m;
    if (!pn_view_has(at) || !pn_receives(at)) continue;
    float depth = pn_depth_at(at);
    if (!pn_seen(at, depth, middle, m)) continue;
    float own = m.z - dot(pn_given.xy, m.xy);
    if (own + error >= lowest) continue;
    error = 3.0 * pn_error_at(at, depth, pn_stray(at, depth), pn_given.xy);
    lowest = min(lowest, own + error);
  }
  return vec4(pn_given.xy, lowest, 0.0);
}
#else
vec2 slopes[PN_TRIED + 1];
float offset[PN_TRIED + 1];
ivec2 nearest, farthest; // by depth: errors are largest at one of them
float least = PN_EVERYTHING, most = PN_NOTHING;

void pn_include(ivec2 at, float depth, vec2 middle) {
  vec3 m;
  bool seen = pn_seen(at, depth, middle, m);
  nearest = seen && depth < least ? at : nearest;
  farthest = seen && depth > most ? at : farthest;
  least = seen ? min(least, depth) : least;
  most = seen ? max(most, depth) : most;
  for (int i = 0; i <= PN_TRIED; i++)
    offset[i] = seen ? min(offset[i], m.z - dot(slopes[i], m.xy)) : offset[i];
}

vec4 pn_plane_below(ivec2 base, vec2 middle) {
  nearest = farthest = base;
  for (int i = 0; i <= PN_TRIED; i++) {
    offset[i] = PN_EVERYTHING;
    slopes[i] = i < PN_TRIED
                    ? texelFetch(pn_tried, ivec2(PN_TRIED * (base.x / PN_BLOCK) + i, base.y / PN_BLOCK), 0).xy
                    : vec2(0.0);
  }
  // One long loop: of two nested ones compilers unroll the inner one, and then take seconds.
  for (int i = 0; i < PN_BLOCK * PN_BLOCK / 4; i++) {
    ivec2 quad = base + 2 * ivec2(i % (PN_BLOCK / 2), i / (PN_BLOCK / 2));
    vec4 depth = pn_depths_of_quad(quad);
    pn_include(quad, depth.x, middle);
    pn_include(quad + ivec2(1, 0), depth.y, middle);
    pn_include(quad + ivec2(0, 1), depth.z, middle);
    pn_include(quad + 1, depth.w, middle);
  }
  int best = PN_TRIED;
  for (int i = 0; i < PN_TRIED; i++)
    if (offset[i] > offset[best]) best = i;
  float error = max(pn_error_at(nearest, least, 0.0, slopes[best]), pn_error_at(farthest, most, 0.0, slopes[best]));
  return vec4(slopes[best], offset[best], error);
}
#endif

void main() {
  ivec2 block = ivec2(gl_FragCoord.xy);
  vec2 middle = 0.5 * (texelFetch(pn_least, block, 0).xy + texelFetch(pn_most, block, 0).xy);
  pn_plane = pn_plane_below(block * PN_BLOCK, middle);
}
