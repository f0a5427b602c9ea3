// Brings visibility from 1/scale of the resolution up: bilinear over those of the four low-resolution samples around
// the pixel that lie in its tangent plane and face as it does; where none does, or where they disagree so much that a
// shadow's edge may run between them, the pixel is computed itself.

uniform highp sampler2D pn_low; // the low-resolution visibility

pn_Visibility pn_upsampled(ivec2 pixel) {
  if (!pn_receives(pixel)) return pn_Visibility(1.0);
  pn_Surface s = pn_surface(pixel);
  float scale = float(pn_offset.z);
  vec2 low = (vec2(pixel) - float(pn_offset.w)) / scale;
  ivec2 base = ivec2(floor(low));
  vec2 f = low - vec2(base);
  float pixel_size = pn_pixel_size(pixel, s);
  ivec2 size = textureSize(pn_low, 0);
  float weights = 0.0;
  pn_Visibility sum = pn_Visibility(0.0), least = pn_Visibility(1.0), most = pn_Visibility(0.0);
  for (int i = 0; i < 4; i++) {
    ivec2 corner = ivec2(i & 1, i >> 1);
    ivec2 at = clamp(base + corner, ivec2(0), size - 1);
    vec2 w = mix(1.0 - f, f, vec2(corner));
    float weight = w.x * w.y;
    if (weight <= 0.0 || !pn_same_surface(s, pn_sample_pixel(at), pixel_size)) continue;
    pn_Visibility v = pn_visibility_of(texelFetch(pn_low, at, 0));
    sum += weight * v;
    weights += weight;
    least = min(least, v);
    most = max(most, v);
  }
  if (weights < 0.25 || pn_largest(most - least) > 0.25) return pn_pixel_visibility(pixel);
  return least == most ? least : sum / weights; // exactly lit stays exactly lit
}
