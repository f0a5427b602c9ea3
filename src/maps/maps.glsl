// A light and its list of maps: tiles of a wide light, each with its layers of depth. Techniques read maps only
// through these functions, so they never know how a map is laid out.
#include "space/space.glsl"

#ifndef PN_LIGHTS
#define PN_LIGHTS 1
#endif
#define PN_MAPS_MAX 16
#define PN_NOTHING -1e30 // the w of an empty texel: behind every receiver

struct pn_LightData {
  vec4 scene_u, scene_v, scene_z;  // light frame from scene, by rows; forward shading only
  // A_u, A_v, 1 for a sun, w that no receiver lies below (maps that reach as far as shadows do)
  vec4 extent;
  vec4 maps;                       // number of tiles, layers of each, width, height
  // w of the nearest caster's plane, w_far, error of a stored depth in w, raster error in texels
  vec4 range;
  vec4 parameters[3];              // the technique's, in the order of its table
  vec4 map_bounds[PN_MAPS_MAX];    // s0, t0, texels per unit of s, of t
  vec4 map_depth[PN_MAPS_MAX];     // w at depth 0, w per depth, shear
};

layout(std140) uniform pn_block { pn_LightData pn_lights[PN_LIGHTS]; };

bool pn_is_sun(int light) { return pn_lights[light].extent.z > 0.5; }
vec2 pn_extent(int light) { return pn_lights[light].extent.xy; }
int pn_map_count(int light) { return int(pn_lights[light].maps.x); }
int pn_map_layers(int light) { return int(pn_lights[light].maps.y); }
ivec2 pn_map_size(int light) { return ivec2(pn_lights[light].maps.zw); }
float pn_parameter(int light, int index) { return pn_lights[light].parameters[index / 4][index % 4]; }

// Where a point of the space lies in a map seen from a point beside the light's centre (zero shear: unchanged).
vec3 pn_map_shear(int light, int map, vec3 m) { return vec3(m.xy - pn_lights[light].map_depth[map].zw * m.z, m.z); }

// Continuous texel coordinates: texel (i, j) is the square from (i, j) to (i + 1, j + 1).
vec2 pn_map_texel(int light, int map, vec2 st) {
  vec4 bounds = pn_lights[light].map_bounds[map];
  return (st - bounds.xy) * bounds.zw;
}

vec2 pn_map_st(int light, int map, vec2 texel) {
  vec4 bounds = pn_lights[light].map_bounds[map];
  return bounds.xy + texel / bounds.zw;
}

bool pn_map_inside(int light, ivec2 texel) {
  return all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, pn_map_size(light)));
}

// Stored depth to w. Exactly 0 and 1 mean that nothing is there (0 in maps of the farthest surface).
float pn_map_w(int light, int map, float depth) {
  vec4 scale = pn_lights[light].map_depth[map];
  return depth <= 0.0 || depth >= 1.0 ? PN_NOTHING : scale.x + scale.y * depth;
}

// The w of a texel; nothing outside the map.
float pn_map_fetch(int light, sampler2DArray maps, int map, int layer, ivec2 texel) {
  if (!pn_map_inside(light, texel)) return PN_NOTHING;
  return pn_map_w(light, map, texelFetch(maps, ivec3(texel, map * pn_map_layers(light) + layer), 0).r);
}

// The tile that a position lies in: the last one whose lower edges are not beyond it. Positions outside every tile
// get the nearest.
int pn_map_at(int light, vec2 st) {
  int count = pn_map_count(light);
  int best = 0;
  float best_distance = 1e30;
  for (int map = 0; map < count; map++) {
    vec2 size = vec2(pn_map_size(light));
    vec2 texel = pn_map_texel(light, map, st);
    vec2 outside = max(abs(texel - 0.5 * size) / size - 0.5, vec2(-0.5));
    float distance = max(outside.x, outside.y); // most inside: tiles overlap by their borders
    if (distance < best_distance) {
      best_distance = distance;
      best = map;
    }
    if (count == 1) break;
  }
  return best;
}
