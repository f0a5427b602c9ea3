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

float pn_depth_error(float depth) { return max(pn_quantum.x, pn_quantum.y * abs(depth)); }

// Rasterisers are farther off where they cut huge triangles: thin pieces are left along an edge, and single pixels of
// them lie beside a surface that is straight around them.

// At the view's border: how far depth lies beside a straight line through the three pixels inwards; 0 where it lies on
// it, or there is none.
float pn_stray_inwards(ivec2 pixel, ivec2 inwards, float depth, float error) {
  if (!pn_view_has(pixel + 3 * inwards)) return 0.0;
  float d1 = pn_depth_at(pixel + inwards), d2 = pn_depth_at(pixel + 2 * inwards);
  float beside = abs(depth - 2.0 * d1 + d2);
  bool straight = abs(d1 - 2.0 * d2 + pn_depth_at(pixel + 3 * inwards)) <= 4.0 * error;
  return beside > 4.0 * error && straight ? beside : 0.0;
}

// The same elsewhere, of a line through the two pixels on either side.
float pn_stray_along(ivec2 pixel, ivec2 axis, float depth, float error) {
  if (!pn_view_has(pixel - 2 * axis)) return pn_stray_inwards(pixel, axis, depth, error);
  if (!pn_view_has(pixel + 2 * axis)) return pn_stray_inwards(pixel, -axis, depth, error);
  float before = pn_depth_at(pixel - axis), after = pn_depth_at(pixel + axis);
  float beside = abs(depth - 0.5 * (before + after)), slope = 0.5 * (after - before);
  if (beside <= 2.0 * error) return 0.0;
  bool straight = abs(before - pn_depth_at(pixel - 2 * axis) - slope) <= 4.0 * error &&
                  abs(pn_depth_at(pixel + 2 * axis) - after - slope) <= 4.0 * error;
  return straight ? beside : 0.0;
}

float pn_stray(ivec2 pixel, float depth) {
  float error = pn_depth_error(depth);
  return max(pn_stray_along(pixel, ivec2(1, 0), depth, error), pn_stray_along(pixel, ivec2(0, 1), depth, error));
}
