/* What objects of the host's are, found out without an error whatever they are. */
#ifndef PNI_GL_INSPECT_H
#define PNI_GL_INSPECT_H

#include "gl/host_texture.h"
#include "gl/texture.h"

/* Depth of a texture or a framebuffer. */
typedef struct {
  int depth_bits, stencil_bits, samples;
  int width, height; /* of a framebuffer's depth, or more where that cannot be found out */
  bool is_float;
  float at[2]; /* where in a pixel its depth was taken: sample 0 lies beside the pixel's centre */
} pni_depth_source;

bool pni_texture_is_2d(pni_gpu *gpu, pn_gl texture);
bool pni_framebuffer_exists(pni_gpu *gpu, pn_gl framebuffer);
/* False where it is no 2D or 2D multisample texture with depth. */
bool pni_inspect_depth(pni_gpu *gpu, pn_gl texture, pni_depth_source *out);
/* False where it is incomplete or has no depth. */
bool pni_inspect_framebuffer(pni_gpu *gpu, pn_gl framebuffer, pni_depth_source *out);
/* The sized format that has these bits: a depth blit wants the same on both sides. */
pni_format pni_depth_format(const pni_depth_source *source);
/* Copies a part of a framebuffer's depth to the origin of a texture of that format. */
pn_result pni_copy_depth(pni_gpu *gpu, pn_gl framebuffer, int x, int y, const pni_texture *to);

/* Size of a 2D texture, or of a multisample one. */
void pni_inspect_size(pni_gpu *gpu, pn_gl texture, bool multisample, int *width, int *height);
/* Colours that a sampler reads as floats. */
typedef struct {
  int bits, channels; /* of red, 0 where there is none or they are integers; that it has, from red on */
  bool is_float;
} pni_color_source;
/* Of a 2D texture. */
pni_color_source pni_inspect_color(pni_gpu *gpu, pn_gl texture);

/* A texture that can be drawn to. */
typedef struct {
  bool array;
  int width, height, layers;
  int channels; /* that it has: bit 0 red .. bit 3 alpha */
} pni_target_kind;
bool pni_inspect_target(pni_gpu *gpu, pn_gl texture, pni_target_kind *out);

#endif
