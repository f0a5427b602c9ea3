// Casters from the light: positions only, and texture coordinates where a texture makes holes.
layout(location = 0) in vec3 pn_position_in;
uniform mat4 pn_clip_from_vertex;
#if PN_ALPHA
layout(location = 1) in vec2 pn_texcoord_in;
out highp vec2 pn_texcoord;
#endif

void main() {
  gl_Position = pn_clip_from_vertex * vec4(pn_position_in, 1.0);
#if PN_ALPHA
  pn_texcoord = pn_texcoord_in;
#endif
}
