// Finds gaps in depth in a quad of a map's samples, and what is known to lie behind them (docs/space.md, "Gaps in
// depth").
#include "maps/gaps.glsl"

// Layer of the map that has what lies behind this one; -1: others have it all as surfaces of their own, -2: not known.
// And how many looks it takes to be sure that it goes on without end: a number that compilers do not know, because
// they would make one long piece of the loop, and nearly all quads leave it at once.
uniform ivec4 pn_behind;

// Slack of a step in w from one texel to the next, for a surface that turns by 45 degrees there, and for rounding.
vec2 pn_gap_slack(int light, int map, float w) {
  return pn_map_texel_size(light, map) * (pn_is_parallel(light) ? 1.0 : w) + 6.0 * pn_lights[light].w_error;
}

// Four samples in a row: is the step between the middle two one that the surface's slopes before and after do not
// predict? A plane has the same step everywhere, a crease one between both slopes.
bool pn_is_gap(vec4 w, float slack) {
  vec3 steps = w.yzw - w.xyz;
  if (min(w.y, w.z) <= PN_NOTHING) return false;
  bool before = w.x > PN_NOTHING, after = w.w > PN_NOTHING;
  float a = before ? steps.x : after ? steps.z : 0.0, b = after ? steps.z : a;
  float turn = slack + 0.25 * (abs(a) + abs(b));
  return steps.y < min(a, b) - turn || steps.y > max(a, b) + turn;
}

// From the nearer to the farther sample beside gap i of a quad: first texel, direction, w halfway.
void pn_beside_gap(int i, ivec2 at, float w[16], out ivec2 far, out ivec2 near, out float middle) {
  ivec2 first = at + (i == 1 ? ivec2(0, 1) : i == 3 ? ivec2(1, 0) : ivec2(0));
  ivec2 second = first + (i < 2 ? ivec2(1, 0) : ivec2(0, 1));
  float a = i == 1 ? w[9] : i == 3 ? w[6] : w[5], b = i == 0 ? w[6] : i == 2 ? w[9] : w[10];
  far = a < b ? first : second;
  near = a < b ? second : first;
  middle = 0.5 * (a + b);
}

// How many texels what lies behind each of the gaps goes on, towards the nearer surface and behind it: the least of
// them, so that the first look that finds nothing, of any, settles it.
float pn_hidden(int light, highp sampler2DArray maps, int map, ivec2 at, float w[16], bvec4 gap) {
  if (pn_behind.x < 0) return pn_behind.x == -1 ? 0.0 : 255.0;
  for (int look = 0; look < pn_behind.y; look++) {
    int step = 1 << (look >> 2);
    if (!gap[look & 3]) continue;
    ivec2 far, near;
    float middle;
    pn_beside_gap(look & 3, at, w, far, near, middle);
    float behind = pn_map_fetch(light, maps, map, pn_behind.x, far + step * (near - far));
    if (behind <= PN_NOTHING || behind >= middle) return float(step - 1);
  }
  return 255.0;
}

// As pn_pack_gaps has it, for the quad of samples 5, 6, 9, 10 of a block of 4 x 4 (its corners are not looked at).
float pn_find_gaps(int light, highp sampler2DArray maps, int map, ivec2 at, float w[16]) {
  vec2 slack = pn_gap_slack(light, map, max(max(w[5], w[6]), max(w[9], w[10])));
  bvec4 gap = bvec4(pn_is_gap(vec4(w[4], w[5], w[6], w[7]), slack.x),
                    pn_is_gap(vec4(w[8], w[9], w[10], w[11]), slack.x),
                    pn_is_gap(vec4(w[1], w[5], w[9], w[13]), slack.y),
                    pn_is_gap(vec4(w[2], w[6], w[10], w[14]), slack.y));
  int gaps = int(gap.x) + int(gap.y) + int(gap.z) + int(gap.w);
  // Around a quad's four sides, a single gap parts nothing.
  if (gaps < 2) return PN_NO_GAP;
  ivec4 parts = ivec4(1, 2, 4, 8);
  if (!gap.x) parts.xy |= parts.yx;
  if (!gap.y) parts.zw |= parts.wz;
  if (!gap.z) parts.xz |= parts.zx;
  if (!gap.w) parts.yw |= parts.wy;
  return pn_pack_gaps(pn_hidden(light, maps, map, at, w, gap), parts);
}
