/* Textures the library owns, and passes that draw into them. */
#ifndef PN_GL_TARGET_H
#define PN_GL_TARGET_H

#include "gl/program.h"
#include "gl/state.h"

typedef struct {
  pn_gl id; /* 0: none */
  GLenum target, format;
  int width, height, layers, levels;
  size_t bytes;
} pni_texture;

/* A texture of that shape, its contents undefined; sampling is nearest, clamped, without comparison. If texture
 * already has that shape nothing happens. The old one is freed only once the new one exists. layers 0: 2D; else a 2D
 * array. */
pn_result pni_texture_shape(pni_gpu *gpu, pni_texture *texture, GLenum format, int width, int height, int layers,
                            int levels);
/* Writes the first width x height texels of a 2D texture; pixels in its format's own layout and type. */
void pni_texture_write(pni_gpu *gpu, const pni_texture *texture, int width, int height, const void *pixels);
void pni_texture_free(pni_gpu *gpu, pni_texture *texture, bool abandon);
void pni_texture_image(const pni_texture *texture, pn_image *out);

/* Binds a texture for the passes that follow, with the library's nearest sampler (or none: the texture's own
 * parameters). */
void pni_bind_texture(pni_gpu *gpu, int unit, GLenum target, pn_gl texture, bool own_parameters);

/* Makes level and layer of a colour texture what the next read of pixels reads. */
void pni_read_from(pni_gpu *gpu, const pni_texture *texture, int level, int layer);

/* A colour texture into a layer of an array. Images of an array that are made from one another are drawn aside and copied
 * in: reading one layer while drawing another is undefined in GL 3.3. */
void pni_copy_to_layer(pni_gpu *gpu, const pni_texture *from, const pni_texture *to, int layer);

/* One image to draw into: level 0.. of a texture, and a layer when it is an array. */
typedef struct {
  pn_gl texture;
  GLenum target;
  int level, layer;
} pni_attachment;

typedef enum {
  PNI_DEPTH_NONE = 0,
  PNI_DEPTH_NEAREST,
  PNI_DEPTH_FARTHEST,
  PNI_DEPTH_WRITE,
  PNI_DEPTH_TEST
} pni_depth_use;

/* Everything a pass depends on; pni_pass_begin sets all of it and leaves nothing to what was there before. */
typedef struct {
  pni_attachment color[2]; /* texture 0: none */
  pni_attachment depth;
  int width, height;
  /* with depth: which surface stays; the image is cleared to 'nothing there' first. TEST: it stays as it is, and what
   * lies nearer is drawn */
  pni_depth_use depth_use;
  pn_faces faces;          /* 0 = any */
  GLdouble depth_range[2]; /* both 0: 0 to 1 */
  bool depth_clamp;
  pni_blend blend; /* of color[0] */
} pni_pass;

/* Texels, from (x, y) on. */
typedef struct {
  int x, y, width, height;
} pni_part;

pn_result pni_pass_begin(pni_gpu *gpu, const pni_pass *pass);
/* What the pass that has begun draws from here on stays inside part. */
void pni_pass_limit(pni_gpu *gpu, const pni_part *part);
/* A triangle that covers the target. The program and its uniforms are set by the caller. */
void pni_draw_screen(pni_gpu *gpu);
/* One value in an image: the host's own texture may be larger than the view, only that is written. */
pn_result pni_fill(pni_gpu *gpu, pni_attachment target, int width, int height, float value);
/* pni_pass_begin, the program in use: the usual start of a full-screen pass. */
pn_result pni_screen_begin(pni_gpu *gpu, const pni_pass *pass, const pni_program *program);

/* Draws triangles from gl_VertexID alone, as many vertices as a texel says that the GPU itself wrote: arguments is an
 * RGBA32UI texture one texel high, each of its texels (count, 1, 0, 0). pni_counts_take copies them into a buffer, and
 * pni_draw_counted draws as texel index says. Nothing is read back. Where the device has no indirect draws, most vertices
 * are drawn, and the shaders have to put what is past the count out of sight. */
typedef struct pni_buffer pni_buffer;
pn_result pni_counts_take(pni_gpu *gpu, const pni_texture *arguments, pni_buffer *buffer);
void pni_draw_counted(pni_gpu *gpu, const pni_buffer *buffer, int index, int most);

/* A uniform buffer of the library's, updated whole. */
struct pni_buffer {
  pn_gl id;
  size_t bytes;
};
pn_result pni_uniform_buffer_set(pni_gpu *gpu, pni_buffer *buffer, const void *data, size_t bytes);
void pni_buffer_free(pni_gpu *gpu, pni_buffer *buffer, bool abandon);

/* Accounts for bytes in GL against the host's limit; pni_memory_give takes them off again. */
pn_result pni_memory_take(pni_gpu *gpu, size_t bytes);
void pni_memory_give(pni_gpu *gpu, size_t bytes);
/* Looks whether the driver ran out of memory since the last look; the bytes were not taken then. */
pn_result pni_memory_check(pni_gpu *gpu, size_t bytes);

#endif
