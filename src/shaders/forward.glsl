// The techniques inside a host's own shader: the same functions as in the full-screen passes, for up to four lights.
#include "shaders/precision.glsl"
#include "gather/channels.glsl"
#include "gather/shaded_point.glsl"

uniform highp sampler2DArray pn_maps_0, pn_maps_1, pn_maps_2, pn_maps_3;
uniform highp sampler2DArray pn_range_0, pn_range_1, pn_range_2, pn_range_3;

pn_Visibility pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray range, pn_ShadedPoint r);

// Samplers cannot be indexed by a variable in GLSL ES 3.00.
pn_Visibility pn_technique_of(int light, pn_ShadedPoint r) {
  if (light == 0) return pn_technique(0, pn_maps_0, pn_range_0, r);
  if (light == 1) return pn_technique(1, pn_maps_1, pn_range_1, r);
  if (light == 2) return pn_technique(2, pn_maps_2, pn_range_2, r);
  return pn_technique(3, pn_maps_3, pn_range_3, r);
}

float pn_visibility(int light, vec3 position, vec3 geometric_normal) {
  if (pn_map_count(light) == 0) return 1.0; // nothing casts
  vec4 u = pn_lights[light].scene_u, v = pn_lights[light].scene_v, z = pn_lights[light].scene_z;
  vec3 p = vec3(dot(u.xyz, position) + u.w, dot(v.xyz, position) + v.w, dot(z.xyz, position) + z.w);
  vec3 n = normalize(vec3(dot(u.xyz, geometric_normal), dot(v.xyz, geometric_normal), dot(z.xyz, geometric_normal)));
  // An interpolated position is off by some units in the last place of the largest term.
  vec3 size = vec3(dot(abs(u.xyz), abs(position)) + abs(u.w), dot(abs(v.xyz), abs(position)) + abs(v.w),
                   dot(abs(z.xyz), abs(position)) + abs(z.w));
  vec4 lost = pn_lights[light].scene_error;
  vec3 error = 1e-6 * size + lost.xyz + vec3(0.0, 0.0, lost.w * abs(p.z));
  pn_ShadedPoint r = pn_shaded_point(light, p, error, n, 1e-4);
  if (pn_unlit(light, r) || pn_above_casters(light, r)) return 1.0;
  return clamp(pn_technique_of(light, r), 0.0, 1.0);
}
