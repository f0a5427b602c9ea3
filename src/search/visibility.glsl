// The frame around every gathering technique: pixel to receiver, the cases that need no map, then the technique's
//   float pn_technique(int light, sampler2DArray maps, sampler2DArray range, pn_Receiver r)
// which follows this file.
#include "shaders/precision.glsl"
#include "search/receiver.glsl"
#include "receiver/surface.glsl"

uniform highp sampler2DArray pn_maps;
uniform highp sampler2DArray pn_range; // the range pyramid, for techniques that want it
layout(location = 0) out vec4 pn_out;
#if PN_DEBUG
layout(location = 1) out vec4 pn_search_out;
vec4 pn_search_report();
#endif

float pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_Receiver r);

float pn_pixel_visibility(ivec2 pixel) {
  if (!pn_receives(pixel)) return 1.0;
  pn_Surface s = pn_surface(pixel);
  pn_Receiver r = pn_receiver(0, s.p, s.error, s.n, s.sigma);
  if (pn_unlit(0, r) || pn_above_casters(0, r)) return 1.0;
  return clamp(pn_technique(0, pn_maps, pn_range, r), 0.0, 1.0);
}

#if PN_UPSAMPLE
#include "search/upsample.glsl"
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
#if PN_UPSAMPLE
  float v = pn_upsampled(at);
#else
  float v = pn_pixel_visibility(min(at * pn_offset.z + pn_offset.w, pn_view.zw - 1));
#endif
  pn_out = vec4(v, v, v, 1.0);
#if PN_DEBUG
  pn_search_out = pn_search_report();
#endif
}
