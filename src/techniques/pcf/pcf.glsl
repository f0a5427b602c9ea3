// Percentage-closer filtering (Reeves, Salesin, Cook 1987): the blocked share of a fixed neighbourhood in the map. It
// smooths a hard shadow's edge by so many texels; the light's size plays no part.
#include "search/lookup.glsl"

// A texel counted from one tile of a wide light, which may lie in another.
float pn_tap(int light, highp sampler2DArray maps, int map, pn_ShadedPoint r, ivec2 texel) {
  if (pn_map_count(light) > 1) {
    vec2 st = pn_map_st(light, map, vec2(texel) + 0.5);
    map = pn_map_at(light, st);
    texel = ivec2(floor(pn_map_texel(light, map, st)));
  }
  return pn_texel_blocks(light, maps, map, r, texel);
}

// A box of n x n texels centred on the position: texels at its border count by the part that lies inside.
float pn_box(int light, highp sampler2DArray maps, int map, pn_ShadedPoint r, vec2 at, int n) {
  vec2 low = at - 0.5 * float(n);
  ivec2 first = ivec2(floor(low));
  float blocked = 0.0;
  for (int y = 0; y <= n; y++)
    for (int x = 0; x <= n; x++) {
      ivec2 texel = first + ivec2(x, y);
      vec2 inside = clamp(low + float(n) - vec2(texel), 0.0, 1.0) - clamp(low - vec2(texel), 0.0, 1.0);
      blocked += inside.x * inside.y * pn_tap(light, maps, map, r, texel);
    }
  return blocked / float(n * n);
}

// Weights of the cubic B-spline at fraction f: 4 x 4 texels, the filter that the smoothies notes compare against.
vec4 pn_cubic(float f) {
  float g = 1.0 - f;
  return vec4(g * g * g, 3.0 * f * f * (f - 2.0) + 4.0, 3.0 * g * g * (g - 2.0) + 4.0, f * f * f) / 6.0;
}

float pn_bicubic(int light, highp sampler2DArray maps, int map, pn_ShadedPoint r, vec2 at) {
  ivec2 base = ivec2(floor(at - 0.5));
  vec2 f = at - 0.5 - vec2(base);
  vec4 wx = pn_cubic(f.x), wy = pn_cubic(f.y);
  float blocked = 0.0;
  for (int y = 0; y < 4; y++)
    for (int x = 0; x < 4; x++)
      blocked += wx[x] * wy[y] * pn_tap(light, maps, map, r, base + ivec2(x, y) - 1);
  return blocked;
}

pn_Visibility pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r) {
  int map = pn_map_at(light, r.m.xy);
  vec2 at = pn_map_texel(light, map, r.m.xy);
  bool bicubic = pn_parameter(light, PN_PARAMETER_FILTER) > 0.5;
  return 1.0 - (bicubic ? pn_bicubic(light, maps, map, r, at)
                        : pn_box(light, maps, map, r, at, int(pn_parameter(light, PN_PARAMETER_TAPS))));
}
