// The soft shadow map projected onto what the camera sees.
#include "shaders/precision.glsl"
#include "search/lookup.glsl"
#include "receiver/surface.glsl"
#include "maps/receiver_map.glsl"
#include "search/horizon.glsl"

uniform highp sampler2DArray pn_maps; // the occluder maps
uniform highp sampler2DArray pn_seen; // the receiver map
uniform highp sampler2DArray pn_work; // the soft shadow map: for each side, a layer for each of the receiver map's
uniform ivec4 pn_layer;               // layers of the receiver map, sides
layout(location = 0) out vec4 pn_out;

// Section 3.5: the sides are merged by maximum. A sum of overlapping patches is no more than the whole light.
float pn_hidden_at(ivec2 texel, int layer) {
  float most = 0.0;
  for (int side = 0; side < pn_layer.y; side++)
    most = max(most, texelFetch(pn_work, ivec3(texel, side * pn_layer.x + layer), 0).r);
  return min(most, 1.0);
}

// Bilinear over the four texels around the receiver, each by how near its surface passes the receiver: one is as good
// as on it within a texel's thickness, and of no use past four. Only on a surface that no layer holds, which lies behind others
// as the light sees it, the rest speak, and the hard shadow of the first side where it is darker.
float pn_hidden(pn_Receiver r, bool sun) {
  vec3 m = r.m;
  vec2 at = pn_seen_texel(m.xy) - 0.5;
  ivec2 base = ivec2(floor(at)), last = textureSize(pn_seen, 0).xy - 1;
  vec2 f = at - vec2(base);
  float thickness = pn_seen_thickness(m.z, sun);
  vec2 near = vec2(0.0), far = vec2(0.0); // weighted sum, sum of weights
  for (int i = 0; i < 4; i++) {
    ivec2 corner = ivec2(i & 1, i >> 1), texel = base + corner;
    if (any(lessThan(texel, ivec2(0))) || any(greaterThan(texel, last))) continue;
    vec2 bilinear = mix(1.0 - f, f, vec2(corner)) + 1e-3;
    vec2 off = m.xy - pn_seen_st(vec2(texel) + 0.5);
    for (int layer = 0; layer < pn_layer.x; layer++) {
      vec4 seen = texelFetch(pn_seen, ivec3(texel, layer), 0);
      if (seen.x < -1e29) break;
      float away = (m.z - seen.x - pn_seen_rise(seen.yz, seen.w, off, 4.0 * thickness)) / thickness;
      float weight = bilinear.x * bilinear.y / (1.0 + away * away * away * away);
      vec2 term = weight * vec2(pn_hidden_at(texel, layer), 1.0);
      far += term;
      if (abs(away) < 4.0) near += term;
    }
  }
  float rest = max(far.y > 0.0 ? far.x / far.y : 0.0, pn_bilinear_blocks(0, pn_maps, r, m.xy));
  return near.y > 0.0 ? near.x / near.y : rest;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float hidden = 0.0;
  if (pn_receives(pixel)) {
    pn_Surface s = pn_surface(pixel);
    pn_Receiver r = pn_receiver(0, s.p, s.error, s.n, s.sigma);
    if (!pn_unlit(0, r)) {
      float above = pn_area_above(pn_extent(0), r.n.xy, r.k);
      if (above > 0.0) hidden = min(pn_hidden(r, pn_is_sun(0)) / above, 1.0);
    }
  }
#if PN_BOUND
  pn_out = vec4(hidden, 0.0, 0.0, 1.0);
#else
  pn_out = vec4(vec3(1.0 - hidden), 1.0);
#endif
}
