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

vec4 least = vec4(vec3(PN_EVERYTHING), 0.0), most = vec4(vec3(PN_NOTHING), 0.0);

void pn_include(bool seen, vec3 low, vec3 high) {
  least = seen ? vec4(min(least.xyz, low), 1.0) : least;
  most = seen ? vec4(max(most.xyz, high), 1.0) : most;
}

#if PN_FIRST
void pn_include_pixel(ivec2 pixel, float depth) {
  vec3 p = pn_point(pixel, depth), m = pn_map_point(p, pn_parallel != 0);
  pn_include(!pn_is_background(depth) && (pn_parallel != 0 || p.z > 0.0), m, m);
}

void pn_include_quad(ivec2 quad) {
  vec4 depth = pn_depths_of_quad(quad);
  pn_include_pixel(quad, depth.x);
  pn_include_pixel(quad + ivec2(1, 0), depth.y);
  pn_include_pixel(quad + ivec2(0, 1), depth.z);
  pn_include_pixel(quad + 1, depth.w);
}
#else
void pn_include_texel(ivec2 at) {
  if (any(greaterThanEqual(at, textureSize(pn_least_below, 0)))) return;
  vec4 low = texelFetch(pn_least_below, at, 0);
  pn_include(low.w > 0.5, low.xyz, texelFetch(pn_most_below, at, 0).xyz);
}
#endif

void main() {
  ivec2 base = ivec2(gl_FragCoord.xy) * PN_BLOCK;
#if PN_FIRST
  for (int i = 0; i < PN_BLOCK * PN_BLOCK / 4; i++)
    pn_include_quad(base + 2 * ivec2(i % (PN_BLOCK / 2), i / (PN_BLOCK / 2)));
#else
  for (int i = 0; i < PN_BLOCK * PN_BLOCK; i++) pn_include_texel(base + ivec2(i % PN_BLOCK, i / PN_BLOCK));
#endif
  pn_least = least;
  pn_most = most;
}
