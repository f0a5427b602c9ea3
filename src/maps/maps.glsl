// A light and its list of maps, each with its layers of depth: tiles of a wide light, views from points of it.
// Techniques read maps only through these functions, so they never know how a map is laid out.
#include "space/limits.glsl"
#include "space/space.glsl"

#ifndef PN_LIGHTS
#define PN_LIGHTS 1
#endif

// As maps/block.h, member for member.
struct pn_MapData {
  vec2 origin;      // s0, t0
  vec2 density;     // texels per unit of s, of t
  vec2 w_of_depth;  // w at depth 0, w per depth
  vec2 light_point; // that it is seen from, beside the light's centre
  vec2 size;        // texels
  float first_layer; // in the array of depth images
  float layers;
};

struct pn_LightData {
  vec4 scene_u, scene_v, scene_z; // light frame from scene, by rows; forward shading only
  vec4 scene_error;               // by what far object coordinates lose: light frame, and along z per z; the same
  vec2 extent;                    // A_u, A_v
  float parallel;                 // 1 for a sun
  float w_reach;                  // no receiver lies below (maps that reach as far as shadows do)
  float map_count;
  float w_near, w_far; // planes: no caster lies beyond
  float w_error;       // of a stored depth, in w
  float raster_error;  // texels
  float layers;        // the most that a map has
  vec2 texel;          // width and height of the largest texel of all maps, in s and t
  vec4 parameters[8];  // the technique's, in the order of its table
  pn_MapData maps[16];
};

layout(std140) uniform pn_block { pn_LightData pn_lights[PN_LIGHTS]; };

bool pn_is_parallel(int light) { return pn_lights[light].parallel > 0.5; }
vec2 pn_extent(int light) { return pn_lights[light].extent; }
float pn_w_near(int light) { return pn_lights[light].w_near; }
int pn_map_count(int light) { return int(pn_lights[light].map_count); }
int pn_layers(int light) { return int(pn_lights[light].layers); }
int pn_map_layers(int light, int map) { return int(pn_lights[light].maps[map].layers); }
ivec2 pn_map_size(int light, int map) { return ivec2(pn_lights[light].maps[map].size); }
vec2 pn_map_texel_size(int light, int map) { return 1.0 / pn_lights[light].maps[map].density; }
// Of the light's coarsest map, for what is asked of all maps at once.
vec2 pn_texel_size(int light) { return pn_lights[light].texel; }
// index: PN_PARAMETER_NAME, defined from the technique's table.
float pn_parameter(int light, int index) { return pn_lights[light].parameters[index / 4][index % 4]; }

// Where a layer of a map lies in the array of images.
int pn_array_layer(int light, int map, int layer) { return int(pn_lights[light].maps[map].first_layer) + layer; }

// Where a point of the space lies in a map seen from a point beside the light's centre (zero shear: unchanged).
vec3 pn_map_shear(int light, int map, vec3 m) { return vec3(m.xy - pn_lights[light].maps[map].light_point * m.z, m.z); }

// Continuous texel coordinates: texel (i, j) is the square from (i, j) to (i + 1, j + 1).
vec2 pn_map_texel(int light, int map, vec2 st) {
  return (st - pn_lights[light].maps[map].origin) * pn_lights[light].maps[map].density;
}

vec2 pn_map_st(int light, int map, vec2 texel) {
  return pn_lights[light].maps[map].origin + texel / pn_lights[light].maps[map].density;
}

bool pn_map_inside(int light, int map, ivec2 texel) {
  return all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, pn_map_size(light, map)));
}

// Stored depth to w. Exactly 0 and 1 mean that nothing is there (0 in maps of the farthest surface).
float pn_map_w(int light, int map, float depth) {
  vec2 scale = pn_lights[light].maps[map].w_of_depth;
  return depth <= 0.0 || depth >= 1.0 ? PN_NOTHING : scale.x + scale.y * depth;
}

// The w of a texel; nothing outside the map.
float pn_map_fetch(int light, sampler2DArray maps, int map, int layer, ivec2 texel) {
  if (!pn_map_inside(light, map, texel)) return PN_NOTHING;
  return pn_map_w(light, map, texelFetch(maps, ivec3(texel, pn_array_layer(light, map, layer)), 0).r);
}

// How many levels up a depth-first walk over a pyramid goes past a node: it may be the last of its four, they may be of
// the last, and so on. Its coordinates share as many ones at the low end; counted without a loop, whose turns would
// count too (software GL ends a shader's loops after 65535 in all).
int pn_levels_past(ivec2 node) {
  int both = node.x & node.y, lowest_zero = ~both & (both + 1);
  return (floatBitsToInt(float(lowest_zero)) >> 23) - 127;
}

// The map that a position lies in: the one of which it is most inside, since tiles overlap by their borders. Positions
// outside every map get the nearest.
int pn_map_at(int light, vec2 st) {
  int count = pn_map_count(light);
  int best = 0;
  float best_distance = PN_EVERYTHING;
  for (int map = 0; map < count; map++) {
    vec2 size = vec2(pn_map_size(light, map));
    vec2 texel = pn_map_texel(light, map, st);
    vec2 outside = max(abs(texel - 0.5 * size) / size - 0.5, vec2(-0.5));
    float distance = max(outside.x, outside.y);
    if (distance < best_distance) {
      best_distance = distance;
      best = map;
    }
    if (count == 1) break;
  }
  return best;
}
