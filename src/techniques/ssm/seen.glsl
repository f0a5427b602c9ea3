// The receiver map, as seen.h lays it out. A texel is (w, a, b, c): the receiver's w at the texel's centre, and its
// tangent plane over the error of its numbers, so that a point d = (ds, dt, dw) away from the receiver lies in front of
// the plane where a ds + b dt - c dw > 1. c has what the normal's angle may be off by, which grows with dw.
uniform vec4 pn_seen_bounds; // s0, t0, texels per unit of s, of t

vec2 pn_seen_texel(vec2 st) { return (st - pn_seen_bounds.xy) * pn_seen_bounds.zw; }
vec2 pn_seen_st(vec2 texel) { return pn_seen_bounds.xy + texel / pn_seen_bounds.zw; }

// What a cube as wide as a texel spans in w: surfaces closer than that the map does not tell apart.
float pn_seen_thickness(float w, bool sun) {
  float texel = 1.0 / min(pn_seen_bounds.z, pn_seen_bounds.w);
  return sun ? texel : texel * w;
}

// How far the plane (n.xy, k) rises in w over (ds, dt); a plane too steep for the map's texels is not followed.
float pn_seen_rise(vec2 n, float k, vec2 d, float most) {
  float rise = dot(n, d) / (abs(k) > 1e-20 ? k : 1e-20);
  return clamp(rise, -most, most);
}
