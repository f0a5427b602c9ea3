// The point that is shaded, of what the camera sees.
#include "gather/shaded_point.glsl"
#include "receiver/surface.glsl"

pn_ShadedPoint pn_shaded_surface(int light, pn_Surface s) {
  pn_ShadedPoint r = pn_shaded_point(light, s.p, s.error, s.n, s.sigma);
  r.epsilon_plane += (pn_is_parallel(light) ? 1.0 : r.m.z) * s.lift;
  return r;
}
