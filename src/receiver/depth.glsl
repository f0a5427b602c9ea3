// The host's depth buffer, pixel by pixel of the view.
#include "space/limits.glsl"

uniform highp sampler2D pn_depth;
#if PN_MASK
uniform highp sampler2D pn_mask;
#endif
uniform ivec4 pn_view;   // origin in the textures, width, height
uniform ivec4 pn_offset; // origin in normal and mask textures, scale, sample in the block of scale x scale pixels
uniform vec4 pn_quantum; // error of a depth: absolute, relative; background depth; angle error of given normals

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

// The first channel of four texels, (0, 0), (1, 0), (0, 1), (1, 1) beside one: a gather costs little more than a fetch.
vec4 pn_quad_of(highp sampler2D image, ivec2 texel) {
#ifdef PN_GATHER
  return textureGather(image, vec2(texel + 1) / vec2(textureSize(image, 0))).wzxy;
#else
  return vec4(texelFetch(image, texel, 0).r, texelFetch(image, texel + ivec2(1, 0), 0).r,
              texelFetch(image, texel + ivec2(0, 1), 0).r, texelFetch(image, texel + 1, 0).r);
#endif
}

// Depths of the pixels (0, 0), (1, 0), (0, 1), (1, 1) beside a pixel of the view; the background's where they lie
// outside of it or do not receive. For passes that look at all pixels.
vec4 pn_depths_of_quad(ivec2 pixel) {
  vec4 depth = pn_quad_of(pn_depth, pn_view.xy + pixel);
#if PN_MASK
  vec4 mask = pn_quad_of(pn_mask, pn_offset.xy + pixel);
#else
  vec4 mask = vec4(1.0);
#endif
  vec2 has = vec2(lessThan(pixel + 1, pn_view.zw));
  return mix(vec4(pn_quantum.z), depth, notEqual(mask * vec4(1.0, has.x, has.y, has.x * has.y), vec4(0.0)));
}

float pn_depth_error(float depth) { return max(pn_quantum.x, pn_quantum.y * abs(depth)); }

// Rasterisers are farther off where they cut huge triangles: thin pieces are left along an edge, and single pixels of
// them lie beside a surface that is straight around them.

// Depths of a pixel and the next one along an axis.
vec2 pn_depths_of_pair(ivec2 pixel, ivec2 axis) {
#ifdef PN_GATHER
  vec4 quad = pn_quad_of(pn_depth, pn_view.xy + pixel);
  return axis.x > 0 ? quad.xy : quad.xz;
#else
  return vec2(pn_depth_at(pixel), pn_depth_at(pixel + axis));
#endif
}

// How far depth lies beside a straight line through the two pixels on either side, or at the view's border through the
// three inwards; 0 where those are not straight, or are not there. Two pairs either way: this runs in every pass.
float pn_stray_along(ivec2 pixel, ivec2 axis, float depth, float error) {
  int at = pixel.x * axis.x + pixel.y * axis.y, last = pn_view.z * axis.x + pn_view.w * axis.y - 1;
  bool low = at < 2, high = !low && at > last - 2, border = low || high;
  int first = low ? 2 : high ? -3 : -2, second = high ? -1 : 1;
  if (!pn_view_has(pixel + (low ? 3 : first) * axis)) return 0.0;
  vec2 before = pn_depths_of_pair(pixel + first * axis, axis), after = pn_depths_of_pair(pixel + second * axis, axis);
  if (low) before = before.yx; // from afar
  float slope = border ? after.x - before.y : 0.5 * (after.x - before.y);
  float beside = abs(depth - after.x + (border ? -slope : slope));
  bool straight = abs(before.y - before.x - slope) <= 4.0 * error &&
                  (border || abs(after.y - after.x - slope) <= 4.0 * error);
  return straight && beside > (border ? 4.0 : 2.0) * error ? beside : 0.0;
}

float pn_stray(ivec2 pixel, float depth) {
  float error = pn_depth_error(depth);
  return max(pn_stray_along(pixel, ivec2(1, 0), depth, error), pn_stray_along(pixel, ivec2(0, 1), depth, error));
}
