// The average of many hard shadows, each from its own point of the light: what the others are approximations of. One
// pass reads a batch of maps and adds to the counts of the passes before it.
#include "shaders/precision.glsl"
#include "search/lookup.glsl"
#include "gather/shaded_surface.glsl"

uniform highp sampler2DArray pn_maps;
uniform highp sampler2D pn_counts; // seen, above the horizon
layout(location = 0) out vec4 pn_out;

// Whether the receiver sees the point of the light that this map was drawn from.
bool pn_sees(pn_ShadedPoint r, int map) {
  vec2 light_point = pn_lights[0].maps[map].light_point;
  ivec2 texel = ivec2(floor(pn_map_texel(0, map, pn_map_shear(0, map, r.m).xy)));
  vec3 q = pn_texel_point(0, pn_maps, map, texel);
  q.xy += light_point * q.z; // back from the sheared map
  return !pn_blocks_apart(0, r, q);
}

void main() {
  ivec2 pixel = min(ivec2(gl_FragCoord.xy) * pn_offset.z + pn_offset.w, pn_view.zw - 1);
  vec2 counts = texelFetch(pn_counts, ivec2(gl_FragCoord.xy), 0).rg;
  if (pn_receives(pixel)) {
    pn_Surface s = pn_surface(pixel);
    pn_ShadedPoint r = pn_shaded_surface(0, s);
    if (!pn_unlit(0, r))
      for (int map = 0; map < pn_map_count(0); map++) {
        if (pn_horizon(r.n, r.k, pn_lights[0].maps[map].light_point) <= 0.0) continue;
        counts += vec2(pn_sees(r, map) ? 1.0 : 0.0, 1.0);
      }
  }
  pn_out = vec4(counts, 0.0, 1.0);
}
