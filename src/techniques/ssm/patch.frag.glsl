// What a micropatch hides of the light at one texel of the soft shadow map (Soft Shadow Maps, section 3.4): its
// projection from the receiver onto the light, cut with the light.
#include "shaders/precision.glsl"
#include "techniques/ssm/patches.glsl"

uniform highp sampler2DArray pn_seen; // the receiver map
uniform ivec4 pn_layer; // of the receiver map; of the occluder maps' array
flat in vec4 pn_rectangle;
flat in vec3 pn_served;
layout(location = 0) out vec4 pn_out;

#if PN_SUM == 0
flat in ivec3 pn_patch_node; // in that pyramid: texel, level
flat in vec2 pn_depths; // largest and smallest w
uniform highp sampler2DArray pn_range; // of the occluder maps
flat in vec4 pn_grid;   // (s, t) of the map's texel (0, 0), a texel's size
#endif

// What a rectangle at w covers of the light, in either direction.
vec2 pn_covered(vec4 rectangle, vec2 st, float nearer) {
  vec2 scale = 0.5 / (pn_extent(0) * max(nearer, PN_TINY));
  vec2 low = clamp((rectangle.xy - st) * scale, -0.5, 0.5), high = clamp((rectangle.zw - st) * scale, -0.5, 0.5);
  return high - low;
}

#if PN_SUM == 0
// Least and greatest value of the tangent plane's test over a block: over the centres of its texels, at both ends of
// its range.
vec2 pn_front_of(vec4 seen, vec2 st, vec4 rectangle, vec2 inset, vec2 range) {
  vec2 middle = 0.5 * (rectangle.xy + rectangle.zw) - st, aside = 0.5 * (rectangle.zw - rectangle.xy) - inset;
  vec2 fall = seen.w * (range - seen.x);
  float centre = dot(seen.yz, middle), slope = dot(abs(seen.yz), aside);
  return vec2(centre - slope - max(fall.x, fall.y), centre + slope - min(fall.x, fall.y));
}

// What the micropatch hides: all that it covers where all of it lies in front of the receiver's tangent plane, else
// what the smaller blocks in it do, down to single texels. A loop, not a condition: software GL runs through both sides
// of a condition, but not through a loop of no turns.
float pn_hidden_by_patch(vec4 seen, vec2 st, float area) {
  vec2 inset = 0.5 * pn_grid.zw, front = pn_front_of(seen, st, pn_rectangle, inset, pn_depths);
  bool whole = front.x > 1.0, cut = area > 0.0 && !whole && front.y > 1.0;
  float hidden = whole ? area : 0.0;
  ivec2 node = pn_patch_node.xy << 1;
  int level = cut ? pn_patch_node.z - 1 : pn_patch_node.z;
  while (level < pn_patch_node.z && level >= 0) {
    vec4 rectangle = pn_grid.xyxy + vec4(node << level, (node + 1) << level) * pn_grid.zwzw;
    vec2 range = texelFetch(pn_range, ivec3(node, pn_layer.y), level).rg;
    front = pn_front_of(seen, st, rectangle, inset, range);
    vec2 covered = pn_covered(rectangle, st, 0.5 * (range.x + range.y) - seen.x);
    float part = covered.x * covered.y;
    hidden += front.x > 1.0 ? part : 0.0;
    // To the first child, or to the next block that does not lie in this one, until the micropatch is left.
    bool down = level > 0 && part > 0.0 && front.x <= 1.0 && front.y > 1.0;
    int up = down ? -1 : pn_levels_past(node);
    level += up;
    node = down ? node << 1 : node >> up;
    if (!down) node += (node.x & 1) == 0 ? ivec2(1, 0) : ivec2(-1, 1);
  }
  return hidden;
}
#elif PN_SUM == 1
flat in vec2 pn_neighbours;

// Soft Shadow Maps, Eq. 3: how far a micropatch and its neighbour beyond the edge at position at overlap, or part, at
// most, where that edge falls onto the light; as a share of the light, over the edge's length.
float pn_overlap(float w, float neighbour, float w_r, float at, float extent, float edge) {
  float lower = min(w, neighbour) - w_r;
  if (pn_is_nothing(neighbour) || lower <= 0.0) return 0.0;
  float nearest = abs(at) / (max(w, neighbour) - w_r); // the farther one projects farther out
  return nearest <= extent ? min(0.5 * abs(w - neighbour) / lower, 1.0) * edge : 0.0;
}

float pn_error_bound(vec2 st, float w_r, vec2 covered) {
  vec2 at = pn_rectangle.zw - st;
  return pn_overlap(pn_served.x, pn_neighbours.x, w_r, at.x, pn_extent(0).x, covered.y) +
         pn_overlap(pn_served.x, pn_neighbours.y, w_r, at.y, pn_extent(0).y, covered.x);
}
#endif

void main() {
  vec4 seen = texelFetch(pn_seen, ivec3(ivec2(gl_FragCoord.xy), pn_layer.x), 0);
  vec2 st = pn_seen_st(gl_FragCoord.xy);
#if PN_SUM == 2
  pn_out = vec4(1.0, 0.0, 0.0, 1.0);
#else
  bool below = !pn_is_nothing(seen.x) && seen.x < pn_served.x;
  vec2 covered = pn_covered(pn_rectangle, st, pn_served.x - seen.x);
#if PN_SUM == 1
  pn_out = vec4(below ? pn_error_bound(st, seen.x, covered) : 0.0, 0.0, 0.0, 1.0);
#else
  bool served = below && seen.x <= pn_served.y && seen.x > pn_served.z;
  pn_out = vec4(pn_hidden_by_patch(seen, st, served ? covered.x * covered.y : 0.0), 0.0, 0.0, 1.0);
#endif
#endif
}
