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
