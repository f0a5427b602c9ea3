// A micropatch's penumbra extent as two triangles in the soft shadow map.
#include "shaders/precision.glsl"
#include "techniques/ssm/patches.glsl"

uniform highp sampler2D pn_list; // the list
uniform highp sampler2D pn_limits; // its limits
#if PN_SUM != 2
uniform highp sampler2DArray pn_range; // of the occluder maps
uniform ivec4 pn_layer;
#endif
#if PN_SUM == 0
flat out ivec3 pn_patch_node;           // in the pyramid over the occluder map: texel, level
flat out vec4 pn_grid;             // (s, t) of the map's texel (0, 0), a texel's size
flat out vec2 pn_depths;           // its largest and smallest w
#elif PN_SUM == 1
flat out vec2 pn_neighbours;       // w of the right and the upper texel
#endif
uniform ivec4 pn_order;          // first entry, step to the next
uniform ivec4 pn_place;          // list's width, map, width and height of the soft shadow map
flat out vec4 pn_rectangle;      // s0, t0, s1, t1
flat out vec3 pn_served;         // w, serves receivers up to, above

void main() {
  int k = pn_order.x + pn_order.y * (gl_VertexID / 6), corner = gl_VertexID % 6;
  ivec2 entry = ivec2(k % pn_place.x, k / pn_place.x);
  vec4 patch_texels = texelFetch(pn_list, entry, 0), limits = texelFetch(pn_limits, entry, 0);
  vec2 low = pn_map_st(0, pn_place.y, patch_texels.xy);
  vec2 high = pn_map_st(0, pn_place.y, patch_texels.xy + patch_texels.z);
  float w = patch_texels.w;
  pn_rectangle = vec4(low, high);
  pn_served = vec3(w, limits.xy);
#if PN_SUM == 0
  int level = (floatBitsToInt(patch_texels.z) >> 23) - 127; // it is 2^level wide
  pn_patch_node = ivec3(ivec2(patch_texels.xy) >> level, level);
  pn_grid = vec4(pn_map_st(0, pn_place.y, vec2(0.0)), pn_map_texel_size(0, pn_place.y));
  pn_depths = texelFetch(pn_range, ivec3(pn_patch_node.xy, pn_layer.y), level).rg;
#elif PN_SUM == 1
  ivec2 texel = ivec2(patch_texels.xy), last = textureSize(pn_range, 0).xy - 1;
  pn_neighbours = vec2(texelFetch(pn_range, ivec3(min(texel + ivec2(1, 0), last), pn_layer.y), 0).r,
                       texelFetch(pn_range, ivec3(min(texel + ivec2(0, 1), last), pn_layer.y), 0).r);
  w = max(w, max(pn_neighbours.x, pn_neighbours.y));
#endif
  // Soft Shadow Maps, section 3.3: up to where the farthest receiver in reach sees the patch before the light's edge.
  vec2 reach = pn_penumbra_extent(pn_extent(0), w, limits.z);
  bvec2 upper = bvec2(corner == 1 || corner > 3, corner == 2 || corner == 3 || corner == 5);
  low -= reach;
  high += reach;
  vec2 at = pn_seen_texel(vec2(upper.x ? high.x : low.x, upper.y ? high.y : low.y));
  // A hundredth of a texel more: centres on the border belong to it, whatever way its numbers were rounded.
  at += vec2(upper.x ? 0.01 : -0.01, upper.y ? 0.01 : -0.01);
  gl_Position = vec4(clamp(2.0 * at / vec2(pn_place.zw) - 1.0, -1.0, 1.0), 0.0, 1.0);
  if (limits.w == 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // past the end
}
