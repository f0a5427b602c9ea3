#include "search/lookup.glsl"

pn_Visibility pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r) {
  return pn_parameter(light, PN_PARAMETER_TWENTIETH);
}
