// Depth peeling for a caster's fragment shader: drops what lies no farther than the layer before this one. The same
// shader draws every layer, so the same fragment has the same depth each time and the comparison is exact.
uniform highp sampler2D pn_peel_map;

void pn_peel() {
  if (gl_FragCoord.z <= texelFetch(pn_peel_map, ivec2(gl_FragCoord.xy), 0).r) discard;
}
