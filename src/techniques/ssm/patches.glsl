// Micropatches: which texels and blocks of texels of an occluder map stand for themselves, and for which receivers.
// ssm.h has the same functions in C under the same names. docs/techniques/ssm.md derives them.
#include "maps/maps.glsl"
#include "techniques/ssm/seen.glsl"

// A block is one micropatch at the middle of its depths where that moves no edge, as the receiver sees it on the
// light, by more than a share of the light's width. An edge within the light moves by A (hi - lo) / 2 / (lo - w_R) at
// most, so for receivers at or below this w. A single texel serves every receiver below it.
float pn_patch_limit(vec2 range, float share) {
  float depth = range.x - range.y;
  return depth > 0.0 ? range.y - depth / (4.0 * share) : range.y;
}

// Whether a block lies in front of a receiver's tangent plane with all of its texels' centres, at both ends of its
// range. Of what it is asked for, nested blocks answer alike: if the larger one does, so do those in it.
//   inset: half a texel
bool pn_patch_in_front(vec4 seen, vec2 st, vec4 rectangle, vec2 inset, vec2 range) {
  vec2 middle = 0.5 * (rectangle.xy + rectangle.zw) - st, aside = 0.5 * (rectangle.zw - rectangle.xy) - inset;
  vec2 rise = seen.w * (range - seen.x);
  return dot(seen.yz, middle) - dot(abs(seen.yz), aside) - max(rise.x, rise.y) > 1.0;
}

bool pn_patch_full(vec2 range) { return !pn_is_nothing(range.y); }

struct pn_Patch {
  vec4 rectangle; // s0, t0, s1, t1
  float w;        // the middle of its depths
  float most;     // serves receivers up to this w ...
  float above;    // ... and above this one: farther ones are the larger block's, where that is in front of them
  float least;    // the farthest receiver in reach
  float reach;    // the w by which it reaches: its own, or where the bound of errors is summed up its neighbours'
  bool drawn;     // whether there is one that it serves
};

// What the pyramid over the receiver map holds of a rectangle of light map space and somewhat around: of the four
// texels, at most, that cover it.
vec4 pn_seen_between(highp sampler2DArray seen_range, int layer, vec2 low, vec2 high, ivec2 size, int levels) {
  ivec2 a = clamp(ivec2(floor(pn_seen_texel(low))), ivec2(0), size - 1);
  ivec2 b = clamp(ivec2(floor(pn_seen_texel(high))), ivec2(0), size - 1);
  // As many bits as the extent has: one more than the float's exponent; none for 0, whose exponent is below all.
  int level = clamp((floatBitsToInt(float(max(b.x - a.x, b.y - a.y))) >> 23) - 126, 0, levels - 1);
  a >>= level;
  b >>= level;
  vec4 r = texelFetch(seen_range, ivec3(a, layer), level);
  vec4 x = texelFetch(seen_range, ivec3(b.x, a.y, layer), level);
  vec4 y = texelFetch(seen_range, ivec3(a.x, b.y, layer), level);
  vec4 z = texelFetch(seen_range, ivec3(b, layer), level);
  return vec4(max(max(r.x, x.x), max(y.x, z.x)), min(min(r.yzw, x.yzw), min(y.yzw, z.yzw)));
}
