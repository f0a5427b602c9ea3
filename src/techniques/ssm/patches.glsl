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

bool pn_patch_full(vec2 range) { return !pn_is_nothing(range.y); }

struct pn_Patch {
  vec4 rectangle; // s0, t0, s1, t1
  float w;        // the middle of its depths
  float most;     // serves receivers up to this w ...
  float above;    // ... and above this one: farther ones are the larger block's
  float least;    // the farthest receiver in reach
  float reach;    // the w by which it reaches: its own, or where the bound of errors is summed up its neighbours' too
  bool drawn;     // whether there is one that it serves
};

// Smallest and largest w of receivers in a rectangle of light map space, and somewhat around: of the four texels, at
// most, that cover it in the pyramid. x is the largest, y the smallest.
vec2 pn_seen_between(highp sampler2DArray seen_range, int layer, vec2 low, vec2 high, ivec2 size, int levels) {
  ivec2 a = clamp(ivec2(floor(pn_seen_texel(low))), ivec2(0), size - 1);
  ivec2 b = clamp(ivec2(floor(pn_seen_texel(high))), ivec2(0), size - 1);
  // As many bits as the extent has: one more than the float's exponent; none for 0, whose exponent is below all.
  int level = clamp((floatBitsToInt(float(max(b.x - a.x, b.y - a.y))) >> 23) - 126, 0, levels - 1);
  a >>= level;
  b >>= level;
  vec2 r = texelFetch(seen_range, ivec3(a, layer), level).rg;
  vec2 x = texelFetch(seen_range, ivec3(b.x, a.y, layer), level).rg;
  vec2 y = texelFetch(seen_range, ivec3(a.x, b.y, layer), level).rg;
  vec2 z = texelFetch(seen_range, ivec3(b, layer), level).rg;
  return vec2(max(max(r.x, x.x), max(y.x, z.x)), min(min(r.y, x.y), min(y.y, z.y)));
}
