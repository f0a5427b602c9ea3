#include "search/lookup.glsl"

pn_Visibility pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r) {
  int map = pn_map_at(light, r.m.xy);
  ivec2 texel = ivec2(floor(pn_map_texel(light, map, r.m.xy)));
  return mix(1.0, pn_parameter(light, PN_PARAMETER_LEVEL), pn_texel_blocks(light, maps, map, r, texel));
}
