// The point that is shaded: a surface in the light's space, with the errors its numbers carry. Those errors are the
// only biases there are: derived from the precision of depth and map, not chosen.
#include "maps/maps.glsl"

struct pn_ShadedPoint {
  vec3 p;              // light frame
  vec3 n;              // unit geometric normal, light frame, turned to the side that is seen and shaded
  vec3 m;              // (s, t, w)
  float k;             // pn_plane_offset
  float epsilon_w;     // how much w may be wrong, map and receiver together
  float epsilon_plane; // how much pn_plane_front may be wrong
  float sigma;         // angle by which the normal may be wrong, radians
  float reach;         // factor of dw in the lever that sigma acts on
};

// position: light frame. error: bound on its error, component by component. normal: unit, light frame.
pn_ShadedPoint pn_shaded_point(int light, vec3 position, vec3 error, vec3 normal, float sigma) {
  bool parallel = pn_is_parallel(light);
  pn_ShadedPoint r;
  r.p = position;
  r.n = normal;
  r.m = pn_map_point(position, parallel);
  r.k = pn_plane_offset(normal, position, parallel);
  r.sigma = sigma + 1e-6;
  r.reach = parallel ? 1.0 : length(position);
  float scale = parallel ? 1.0 : r.m.z;
  float map_error = pn_lights[light].w_error;
  vec2 texel = pn_texel_size(light);
  r.epsilon_w = map_error + scale * (parallel ? 1.0 : r.m.z) * error.z;
  r.epsilon_plane = scale * dot(abs(normal), error) + abs(r.k) * map_error +
                    pn_lights[light].raster_error * dot(abs(normal.xy), texel);
  return r;
}

// Whether a stored sample at q = (s, t, w) can hide any of the light from the receiver: nearer, and in front of the
// tangent plane.
bool pn_blocks(pn_ShadedPoint r, vec3 q) {
  vec3 d = q - r.m;
  float lever = abs(d.x) + abs(d.y) + r.reach * abs(d.z);
  return d.z > r.epsilon_w && pn_plane_front(r.n, r.k, q, r.m) > r.epsilon_plane + r.sigma * lever;
}

// The same for a sample that stands for a whole texel, as in a hard shadow's comparison: it was taken up to a texel
// aside of the line it is asked about, and a surface that bends towards the light (a crease, a facetted mesh) rises
// by up to that much in front of the tangent plane on the way. What is lower than that the map cannot tell from the
// surface itself.
bool pn_blocks_apart(int light, pn_ShadedPoint r, vec3 q) {
  vec2 aside = abs(q.xy - r.m.xy), texel = pn_texel_size(light);
  float rise = min(max(aside.x, aside.y), max(texel.x, texel.y));
  return pn_blocks(r, q) && pn_plane_front(r.n, r.k, q, r.m) > rise;
}

// Receivers that no part of the light shines on: facing away, or behind a rectangle.
bool pn_unlit(int light, pn_ShadedPoint r) {
  return (!pn_is_parallel(light) && r.p.z <= 0.0) || dot(abs(r.n.xy), pn_extent(light)) - r.k <= 0.0;
}

// Receivers nearer to the light than every caster see all of it.
bool pn_above_casters(int light, pn_ShadedPoint r) { return r.m.z >= pn_w_near(light); }
