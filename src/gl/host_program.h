/* Programs of the host's that contain the library's forward text: their samplers, block and textures. */
#ifndef PNI_GL_HOST_PROGRAM_H
#define PNI_GL_HOST_PROGRAM_H

#include "gl/buffer.h"
#include "gl/texture.h"

/* Texture units and uniform block bindings that this device has. */
void pni_host_limits(pni_gpu *gpu, int *units, int *bindings);

/* One sampler array element: the uniform's name, its unit, what is bound there. */
typedef struct {
  char name[24];
  int unit;
  const pni_texture *texture; /* NULL: the sampler gets its unit, nothing is bound */
} pni_host_sampler;

/* Whether there is such a program, linked, with a block pn_block. */
bool pni_host_program_fits(pni_gpu *gpu, pn_gl program);
/* Sets samplers and block of one that fits, and binds them; the program and the active unit stay the host's. */
void pni_host_program_bind(pni_gpu *gpu, pn_gl program, const pni_buffer *block, int binding,
                           const pni_host_sampler *samplers, int count);

#endif
