// Micro-primitives: what a depth map's texels stand for. PN_PRIMITIVE, of the technique's own parameters:
#define PN_PATCH 0      // a texel is a rectangle parallel to the light
#define PN_QUAD 1       // four neighbouring texel centres are a quad's corners
#define PN_QUAD_EXACT 2 // the same, covered exactly
#include "gather/shaded_point.glsl"

// To coordinates from 0 to 1 over the light: d = (s, t) - (s_R, t_R), dw = w - w_R.
vec2 pn_on_light(int light, vec2 d, float dw) { return 0.5 + 0.5 * d / (dw * pn_extent(light)); }

// A quad, or a block of quads taken as one, seen from the receiver: its corners in the order (0, 0), (1, 0), (0, 1),
// (1, 1), and the rectangle through the middles of its edges (section 4). Corners keep their own w, so that
// neighbours meet.
struct pn_Quad {
  vec4 x, y;      // corners on the light
  vec2 low, high; // the rectangle
  bool whole;     // all four corners hide light: the paper's condition
  bool some;      // with PN_EDGES: those that do have their parts of the rectangle
};
