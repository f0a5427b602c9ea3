// A smoothie's texel. A point of it at (kappa, w) gives a receiver at w_R the visibility kappa / (w - w_R). Its
// reciprocal is a line over w_R. Where smoothies overlap the least visibility counts, and so does the greatest
// reciprocal; it is stored negative, and the minimum is kept. Values at two close w_R tell the whole line of the one
// that wins there: at the farthest receiver, and half way up to the nearest caster.
#include "shaders/precision.glsl"
#include "techniques/smoothies/shape.glsl"
#include "techniques/smoothies/samples.glsl"

layout(location = 0) out vec4 pn_out;

void main() {
  float w = pn_linear.z, kappa = pn_kappa();
  if (pn_width.x > 0.0 && !pn_is_parallel(0)) kappa *= w;
  pn_out = (pn_samples(0) - w) / max(kappa, 1e-9 * pn_sample_step(0));
}
