// The rows of the list that are in use, each as two triangles over its texels.
#include "shaders/precision.glsl"
uniform ivec4 pn_place; // first entry of this list, its width, its height

void main() {
  int row = gl_VertexID / 6, corner = gl_VertexID % 6;
  bvec2 upper = bvec2(corner == 1 || corner > 3, corner == 2 || corner == 3 || corner == 5);
  float y = float(row + (upper.y ? 1 : 0)) / float(pn_place.z);
  gl_Position = vec4(upper.x ? 1.0 : -1.0, 2.0 * y - 1.0, 0.0, 1.0);
}
