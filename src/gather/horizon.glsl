// The part of the light above a receiver's horizon.

// Share of [-A_u, A_u] x [-A_v, A_v] where n . x > k. The integral over one axis of a line's clamped height over the
// other has a closed form: F, the integral of clamp(h, 0, 1), taken at the ends.
float pn_area_above(vec2 extent, vec2 n, float k) {
  vec2 a = abs(n) * extent; // by symmetry both slopes may be positive
  if (a.x + a.y <= k) return 0.0;
  if (a.x + a.y <= -k) return 1.0;
  if (a.y > a.x) a = a.yx; // the larger one is divided by
  // Along v = a.y y, y in [-1, 1], the share of x above is clamp(1/2 + (v - k) / (2 a.x), 0, 1).
  vec2 h = 0.5 + (vec2(-a.y, a.y) - k) / (2.0 * a.x);
  if (h.y - h.x < 1e-4) return clamp(0.5 * (h.x + h.y), 0.0, 1.0);
  vec2 c = clamp(h, 0.0, 1.0);
  vec2 f = 0.5 * c * c + max(h - 1.0, 0.0);
  return (f.y - f.x) / (h.y - h.x);
}
