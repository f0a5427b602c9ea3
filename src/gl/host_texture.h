/* Textures of the host's, read texel by texel whatever their parameters say: base level, swizzle and which half of
 * depth-stencil texels is read are the texture's own, and no sampler object stands over them. */
#ifndef PNI_GL_HOST_TEXTURE_H
#define PNI_GL_HOST_TEXTURE_H

#include "gl/gpu.h"

typedef struct {
  pn_gl texture; /* 0: none */
  GLenum target;
  int width, height; /* of level 0 */
  int depth_bits;
  GLint base, swizzle[4], stencil_mode; /* as the host left them */
} pni_host_texture;

bool pni_texture_exists(pni_gpu *gpu, pn_gl texture);
/* Whether there is such a texture, of that kind: found out without an error. */
bool pni_texture_is(pni_gpu *gpu, pn_gl texture, GLenum target);

/* Looks at the texture and makes its parameters neutral. False: there is no such texture, or it is of another kind;
 * nothing was changed then. */
bool pni_host_texture_open(pni_gpu *gpu, pn_gl texture, bool multisample, pni_host_texture *out);
/* Sets back what was not neutral. Several that may be the same texture are closed in the opposite order. */
void pni_host_texture_close(pni_gpu *gpu, pni_host_texture *texture);

/* Whether a 2D texture has all the levels that its own minifying filter asks for. */
bool pni_host_texture_complete(pni_gpu *gpu, pn_gl texture);

#endif
