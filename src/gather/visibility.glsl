// The frame around every gathering technique: pixel to shaded point, the cases that need no map, then the technique's
//   pn_Visibility pn_technique(int light, sampler2DArray maps, sampler2DArray range, pn_ShadedPoint r)
// which follows this file.
#include "shaders/precision.glsl"
#include "gather/channels.glsl"
#include "gather/shaded_surface.glsl"
#include "gather/same_surface.glsl"

uniform highp sampler2DArray pn_maps;
uniform highp sampler2DArray pn_range; // the range pyramid, or what the technique puts in its place
layout(location = 0) out vec4 pn_out;
#if PN_AREA
float pn_seen_area = 1.0; // what a sum of areas leaves of the light, beside its visibility; below 0 past all of it
#endif
#if PN_DEBUG
layout(location = 1) out vec4 pn_search_out;
layout(location = 2) out vec4 pn_levels_out;
vec4 pn_search_report(out vec2 levels);
#endif

pn_Visibility pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r);

pn_Visibility pn_pixel_visibility(ivec2 pixel) {
  if (!pn_receives(pixel)) return pn_Visibility(1.0);
  pn_Surface s = pn_surface(pixel);
  pn_ShadedPoint r = pn_shaded_surface(0, s);
  if (pn_unlit(0, r) || pn_above_casters(0, r)) return pn_Visibility(1.0);
  return clamp(pn_technique(0, pn_maps, pn_range, r), 0.0, 1.0);
}

#if PN_UPSAMPLE
#include "gather/upsample.glsl"
#endif

#if PN_AREA
// Along which axes both of a sample's neighbours see its surface: 1 x, 2 y. Across a step or a crease visibility goes
// on neither smoothly nor as the area does.
float pn_smooth_axes(ivec2 sample_at) {
  ivec2 pixel = pn_sample_pixel(sample_at);
  if (!pn_receives(pixel)) return 0.0;
  pn_Surface s = pn_surface(pixel);
  float size = pn_pixel_size(pixel, s), axes = 0.0;
  for (int axis = 0; axis < 2; axis++) {
    ivec2 step = ivec2(1 - axis, axis);
    ivec2 before = sample_at - step, after = sample_at + step;
    bool inside = all(greaterThanEqual(before, ivec2(0))) && all(lessThan(pn_sample_pixel(after), pn_view.zw));
    if (inside && pn_same_surface(s, pn_sample_pixel(before), size) && pn_same_surface(s, pn_sample_pixel(after), size))
      axes += float(1 + axis);
  }
  return axes;
}
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
#if PN_UPSAMPLE
  pn_Visibility v = pn_upsampled(at);
#else
  pn_Visibility v = pn_pixel_visibility(min(at * pn_offset.z + pn_offset.w, pn_view.zw - 1));
#endif
#if PN_AREA
  pn_out = vec4(v, pn_seen_area, pn_smooth_axes(at), v);
#else
  pn_out = pn_visibility_texel(v);
#endif
#if PN_DEBUG
  vec2 levels;
  pn_search_out = pn_search_report(levels);
  pn_levels_out = vec4(levels, 0.0, 1.0);
#endif
}
