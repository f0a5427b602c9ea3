#include "gl/fixed.h"

static const GLenum transfer_names[PNI_TRANSFER_NAMES] = {
    GL_RED_SCALE,  GL_GREEN_SCALE, GL_BLUE_SCALE, GL_ALPHA_SCALE, GL_DEPTH_SCALE, GL_RED_BIAS,
    GL_GREEN_BIAS, GL_BLUE_BIAS,   GL_ALPHA_BIAS, GL_DEPTH_BIAS,  GL_MAP_COLOR,   GL_MAP_STENCIL,
};
enum { SCALES = 5 }; /* which are 1, and the others 0 */

static GLfloat transfer_default(int i) { return i < SCALES ? 1 : 0; }

void pni_fixed_save(pni_gpu *gpu, pni_fixed_state *state) {
  GLint active = 0;
  if (!gpu->can.fixed) return;
  GL(gpu, GetIntegerv)(GL_CLAMP_FRAGMENT_COLOR, &state->clamp_fragment);
  for (int i = 0; i < PNI_TRANSFER_NAMES; i++) GL(gpu, GetFloatv)(transfer_names[i], &state->transfer[i]);
  GL(gpu, GetIntegerv)(GL_ACTIVE_TEXTURE, &active);
  for (int unit = 0; unit < PNI_UNITS; unit++) {
    GL(gpu, ActiveTexture)(GL_TEXTURE0 + (GLenum)unit);
    GL(gpu, GetTexEnvfv)(GL_TEXTURE_FILTER_CONTROL, GL_TEXTURE_LOD_BIAS, &state->bias[unit]);
  }
  GL(gpu, ActiveTexture)((GLenum)active);
}

/* Without a host to go back to, the active unit is left anywhere. */
static void set_bias(pni_gpu *gpu, const pni_host_state *host, int unit, GLfloat bias) {
  GL(gpu, ActiveTexture)(GL_TEXTURE0 + (GLenum)unit);
  GL(gpu, TexEnvf)(GL_TEXTURE_FILTER_CONTROL, GL_TEXTURE_LOD_BIAS, bias);
  if (host) GL(gpu, ActiveTexture)((GLenum)host->active_texture);
}

void pni_fixed_neutral(pni_gpu *gpu, const pni_host_state *host) {
  if (!gpu->can.fixed) return;
  if (!host || host->fixed.clamp_fragment != GL_FIXED_ONLY) GL(gpu, ClampColor)(GL_CLAMP_FRAGMENT_COLOR, GL_FIXED_ONLY);
  for (int i = 0; i < PNI_TRANSFER_NAMES; i++)
    if (!host || host->fixed.transfer[i] != transfer_default(i))
      GL(gpu, PixelTransferf)(transfer_names[i], transfer_default(i));
  for (int unit = 0; unit < PNI_UNITS; unit++)
    if (!host || host->fixed.bias[unit] != 0) set_bias(gpu, host, unit, 0);
}

void pni_fixed_restore(pni_gpu *gpu, const pni_host_state *host, bool whole) {
  const pni_fixed_state *state = &host->fixed;
  if (!gpu->can.fixed) return;
  if (whole || state->clamp_fragment != GL_FIXED_ONLY)
    GL(gpu, ClampColor)(GL_CLAMP_FRAGMENT_COLOR, (GLenum)state->clamp_fragment);
  for (int i = 0; i < PNI_TRANSFER_NAMES; i++)
    if (whole || state->transfer[i] != transfer_default(i))
      GL(gpu, PixelTransferf)(transfer_names[i], state->transfer[i]);
  for (int unit = 0; unit < PNI_UNITS; unit++)
    if (whole || state->bias[unit] != 0) set_bias(gpu, host, unit, state->bias[unit]);
}
