// The soft shadow map projected onto what the camera sees.
#include "shaders/precision.glsl"
#include "search/lookup.glsl"
#include "gather/shaded_surface.glsl"
#include "techniques/ssm/seen.glsl"
#include "gather/horizon.glsl"

uniform highp sampler2DArray pn_maps; // the occluder maps
uniform highp sampler2DArray pn_seen; // the receiver map
uniform highp sampler2DArray pn_soft; // the soft shadow map: for each side, a layer for each of the receiver map's
uniform ivec4 pn_layer;               // layers of the receiver map, sides
layout(location = 0) out vec4 pn_out;
#define PN_AROUND 8 // texels, even

// Section 3.5: the sides are merged by maximum. A sum of overlapping patches is no more than the whole light.
float pn_hidden_at(ivec2 texel, int layer) {
  float most = 0.0;
  for (int side = 0; side < pn_layer.y; side++)
    most = max(most, texelFetch(pn_soft, ivec3(texel, side * pn_layer.x + layer), 0).r);
  return min(most, 1.0);
}

// What a texel's layers say: each by how near its surface passes the receiver. One is as good as on it within a texel's
// thickness, and of no use past four. x: weighted sum, y: sum of weights, of those of use; z, w: of all.
vec4 pn_layers_at(ivec2 texel, vec3 m, float thickness, float share) {
  vec4 sums = vec4(0.0);
  vec2 off = m.xy - pn_seen_st(vec2(texel) + 0.5);
  for (int layer = 0; layer < pn_layer.x; layer++) {
    vec4 seen = texelFetch(pn_seen, ivec3(texel, layer), 0);
    if (pn_is_nothing(seen.x)) break;
    float away = (m.z - seen.x - pn_seen_rise(seen.yz, seen.w, off, 4.0 * thickness)) / thickness;
    vec2 term = share / (1.0 + away * away * away * away) * vec2(pn_hidden_at(texel, layer), 1.0);
    sums += vec4(abs(away) < 4.0 ? term : vec2(0.0), term);
  }
  return sums;
}

// Bilinear over the four texels around the receiver. Where they hold its surface in no layer, since others lie before
// it in all of them, those somewhat farther around are asked; then whatever there is, and the hard shadow where it is
// darker.
float pn_hidden(pn_ShadedPoint r, bool sun) {
  vec2 at = pn_seen_texel(r.m.xy) - 0.5;
  ivec2 base = ivec2(floor(at)), last = textureSize(pn_seen, 0).xy - 1;
  vec2 f = at - vec2(base);
  float thickness = pn_seen_thickness(r.m.z, sun);
  vec4 sums = vec4(0.0);
  for (int i = 0; i < 4; i++) {
    ivec2 corner = ivec2(i & 1, i >> 1), texel = base + corner;
    if (any(lessThan(texel, ivec2(0))) || any(greaterThan(texel, last))) continue;
    vec2 bilinear = mix(1.0 - f, f, vec2(corner)) + 1e-3;
    sums += pn_layers_at(texel, r.m, thickness, bilinear.x * bilinear.y);
  }
  if (sums.w <= 0.0) return 0.0; // outside the map
  vec4 around = vec4(0.0);
  int turns = sums.y > 0.0 ? 0 : PN_AROUND * PN_AROUND;
  for (int i = 0; i < turns; i++) {
    ivec2 texel = base + ivec2(i % PN_AROUND, i / PN_AROUND) - (PN_AROUND / 2 - 1);
    if (any(lessThan(texel, ivec2(0))) || any(greaterThan(texel, last))) continue;
    vec2 away = vec2(texel) - at;
    around += pn_layers_at(texel, r.m, thickness, 1.0 / (1e-3 + dot(away, away)));
  }
  if (sums.y > 0.0) return sums.x / sums.y;
  if (around.y > 0.0) return around.x / around.y;
  return max(sums.z / sums.w, pn_bilinear_blocks(0, pn_maps, r, r.m.xy));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float hidden = 0.0;
  if (pn_receives(pixel)) {
    pn_Surface s = pn_surface(pixel);
    pn_ShadedPoint r = pn_shaded_surface(0, s);
    if (!pn_unlit(0, r)) {
      float above = pn_area_above(pn_extent(0), r.n.xy, r.k);
      if (above > 0.0) hidden = min(pn_hidden(r, pn_is_parallel(0)) / above, 1.0);
    }
  }
#if PN_BOUND
  pn_out = vec4(hidden, 0.0, 0.0, 1.0);
#else
  pn_out = vec4(1.0 - hidden);
#endif
}
