// Single texels of a map as occluders.
#include "gather/shaded_point.glsl"

// The sample that a texel stores, as a point at the texel's centre; w is PN_NOTHING where it is empty.
vec3 pn_texel_point(int light, highp sampler2DArray maps, int map, ivec2 texel) {
  return vec3(pn_map_st(light, map, vec2(texel) + 0.5), pn_map_fetch(light, maps, map, 0, texel));
}

// 1 where the texel hides light from the receiver.
float pn_texel_blocks(int light, highp sampler2DArray maps, int map, pn_ShadedPoint r, ivec2 texel) {
  return pn_blocks_apart(light, r, pn_texel_point(light, maps, map, texel)) ? 1.0 : 0.0;
}

// The same, weighted bilinearly over the four texels around a position: comparisons are filtered, never depths.
float pn_bilinear_blocks(int light, highp sampler2DArray maps, pn_ShadedPoint r, vec2 st) {
  int map = pn_map_at(light, st);
  vec2 at = pn_map_texel(light, map, st) - 0.5;
  ivec2 base = ivec2(floor(at));
  vec2 f = at - vec2(base);
  vec2 low = vec2(pn_texel_blocks(light, maps, map, r, base), pn_texel_blocks(light, maps, map, r, base + ivec2(1, 0)));
  vec2 high = vec2(pn_texel_blocks(light, maps, map, r, base + ivec2(0, 1)),
                   pn_texel_blocks(light, maps, map, r, base + 1));
  vec2 columns = mix(low, high, f.y);
  return mix(columns.x, columns.y, f.x);
}
