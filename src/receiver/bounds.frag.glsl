// Bounds, in (s, t, w), of the surfaces a camera sees: each pixel of the target covers PN_BLOCK x PN_BLOCK of the
// source. The first step reads the receiver's depth, further ones what the last one wrote.
#include "shaders/precision.glsl"
#include "space/limits.glsl"
#define PN_BLOCK 16
#if PN_FIRST
#define PN_NORMALS 1 // only positions are wanted here
#include "space/space.glsl"
#include "receiver/surface.glsl"
uniform int pn_parallel;
#else
uniform highp sampler2D pn_least_below;
uniform highp sampler2D pn_most_below;
#endif
layout(location = 0) out vec4 pn_least; // least s, t, w; 1 where anything was seen
layout(location = 1) out vec4 pn_most;

void main() {
  ivec2 base = ivec2(gl_FragCoord.xy) * PN_BLOCK;
  vec4 least = vec4(vec3(PN_EVERYTHING), 0.0);
  vec4 most = vec4(vec3(PN_NOTHING), 0.0);
  for (int y = 0; y < PN_BLOCK; y++)
    for (int x = 0; x < PN_BLOCK; x++) {
      ivec2 at = base + ivec2(x, y);
#if PN_FIRST
      if (!pn_view_has(at) || !pn_receives(at)) continue;
      vec3 p = pn_point(at, pn_depth_at(at));
      if (pn_parallel == 0 && p.z <= 0.0) continue;
      vec3 m = pn_map_point(p, pn_parallel != 0);
      least = vec4(min(least.xyz, m), 1.0);
      most = vec4(max(most.xyz, m), 1.0);
#else
      if (any(greaterThanEqual(at, textureSize(pn_least_below, 0)))) continue;
      vec4 l = texelFetch(pn_least_below, at, 0);
      if (l.w < 0.5) continue;
      least = vec4(min(least.xyz, l.xyz), 1.0);
      most = vec4(max(most.xyz, texelFetch(pn_most_below, at, 0).xyz), 1.0);
#endif
    }
  pn_least = least;
  pn_most = most;
}
