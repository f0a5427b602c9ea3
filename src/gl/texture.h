/* Textures the library owns: made, filled, copied, read. */
#ifndef PNI_GL_TEXTURE_H
#define PNI_GL_TEXTURE_H

#include "gl/gpu.h"

/* What a texel holds. */
typedef enum {
  PNI_R8 = 0,
  PNI_R16F,
  PNI_R32F,
  PNI_RG32F,
  PNI_RGBA32F,
  PNI_R32UI,
  PNI_RG32UI,
  PNI_RGBA32UI,
  PNI_DEPTH16,
  PNI_DEPTH24,
  PNI_DEPTH32,
  PNI_DEPTH32F,
  PNI_DEPTH24_STENCIL8,
  PNI_DEPTH32F_STENCIL8,
  PNI_FORMAT_COUNT
} pni_format;

typedef struct {
  pn_gl id; /* 0: none */
  pni_format format;
  int width, height;
  int layers; /* 0: 2D, else a 2D array */
  int levels;
  size_t bytes;
} pni_texture;

/* A texture of that shape, its contents undefined; sampling is nearest, clamped, without comparison. If texture
 * already has that shape nothing happens. The old one is freed only once the new one exists. label: for debuggers. */
pn_result pni_texture_shape(pni_gpu *gpu, pni_texture *texture, const char *label, pni_format format, int width,
                            int height, int layers, int levels);
void pni_texture_free(pni_gpu *gpu, pni_texture *texture, bool abandon);
/* Frees what is no longer needed; not while a call is planned, which may fail yet. */
void pni_texture_spare(pni_gpu *gpu, pni_texture *texture);
/* The end of a plan (gl/plan.h): textures that were replaced go, or else come back. */
void pni_textures_settle(pni_gpu *gpu, bool replaced);
/* As the host is told of it. */
void pni_texture_describe(const pni_texture *texture, pn_image *out);

/* Writes count texels of a 2D texture row by row, from its origin on; texels in its format's own layout. */
void pni_texture_write(pni_gpu *gpu, const pni_texture *texture, const void *texels, size_t count);
/* Count texels of one row, from its first on. */
void pni_texture_write_row(pni_gpu *gpu, const pni_texture *texture, int row, const void *texels, int count);
/* As pni_texture_write from a buffer, offset bytes in it. */
void pni_texture_write_from(pni_gpu *gpu, const pni_texture *texture, pn_gl buffer, size_t offset, size_t count);
/* Only these levels can be read until the next call: a pass that draws one must not read it. */
void pni_texture_limit(pni_gpu *gpu, const pni_texture *texture, int first, int last);

/* A level of a texture as an image to draw into; layer: of an array. */
pni_image pni_image_of(const pni_texture *texture, int level, int layer);

/* Reads the first width x height texels of a level and layer, which waits for the GPU; channels: as many as out
 * wants. Floats from float formats, unsigned integers from integer ones. While a call is planned out stays as it is. */
void pni_texture_read(pni_gpu *gpu, const pni_texture *texture, int level, int layer, int width, int height,
                      int channels, void *out);

/* Makes level and layer of a colour texture what the next read of pixels reads. */
void pni_read_from(pni_gpu *gpu, const pni_texture *texture, int level, int layer);

/* A colour or depth texture into a layer of an array. Images of an array that are made from one another are drawn
 * aside and copied in: reading one layer while drawing another is undefined in GL 3.3. */
void pni_copy_to_layer(pni_gpu *gpu, const pni_texture *from, const pni_texture *to, int layer);
/* Texels of a colour texture, from (x, y) on, to the same place. */
void pni_copy_part_to_layer(pni_gpu *gpu, const pni_texture *from, const pni_texture *to, int layer, int x, int y,
                            int width, int height);

/* Accounts for bytes in GL against the host's limit; pni_memory_give takes them off again. */
pn_result pni_memory_take(pni_gpu *gpu, size_t bytes);
void pni_memory_give(pni_gpu *gpu, size_t bytes);
/* Looks whether the driver ran out of memory since the last look; the bytes were not taken then. */
pn_result pni_memory_check(pni_gpu *gpu, size_t bytes);

#endif
