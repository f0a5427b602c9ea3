/* Passes: targets, program, textures and numbers by name, draws. A pass sets everything that it depends on and leaves
 * nothing to what was there before. */
#ifndef PNI_GL_PASS_H
#define PNI_GL_PASS_H

#include "gl/buffer.h"
#include "gl/program.h"
#include "gl/texture.h"

typedef enum {
  PNI_DEPTH_NONE = 0,
  PNI_DEPTH_NEAREST,
  PNI_DEPTH_FARTHEST,
  PNI_DEPTH_WRITE,
  PNI_DEPTH_TEST
} pni_depth_use;

/* Texels, from (x, y) on. */
typedef struct {
  int x, y, width, height;
} pni_part;

typedef struct {
  const char *name;        /* for debuggers */
  pni_program_key program; /* no fragment: none yet (pni_pass_program), or the pass only clears */
  pni_image color[PNI_COLORS], depth;
  int width, height;
  int channels;         /* of color[0], that are written: bit 0 red .. bit 3 alpha; 0: all */
  const float *clear;   /* four numbers that color[0] has at first; NULL: what it holds stays */
  bool clear_integer;   /* color[0] holds integers, and has 0 at first */
  const pni_part *part; /* what is drawn stays inside; clearing does not. NULL: all */
  /* with depth: which surface stays; the image is cleared to 'nothing there' first. TEST: it stays as it is, and what
   * lies nearer is drawn */
  pni_depth_use depth_use;
  pn_faces faces;        /* 0 = any */
  double depth_range[2]; /* both 0: 0 to 1 */
  bool depth_clamp;
  pni_blend blend; /* of color[0] */
  bool points;     /* the vertex shader sets their size */
} pni_pass;

/* Compiles the program where it is new, sets all of it, clears. */
pn_result pni_pass_begin(pni_gpu *gpu, const pni_pass *pass);
/* The same pass after the host was called in the middle of it: nothing is cleared. */
pn_result pni_pass_resume(pni_gpu *gpu, const pni_pass *pass);
/* Another program for the draws that follow. */
pn_result pni_pass_program(pni_gpu *gpu, const pni_program_key *key);

/* Which way front faces wind; counter-clockwise at first. */
void pni_pass_clockwise(pni_gpu *gpu, bool clockwise);

/* For the pass's program, by the names of its uniforms; what the compiler found no use for is passed over. */
void pni_set_int(pni_gpu *gpu, const char *name, int value);
void pni_set_ints(pni_gpu *gpu, const char *name, int x, int y, int z, int w);
void pni_set_float(pni_gpu *gpu, const char *name, float value);
void pni_set_floats(pni_gpu *gpu, const char *name, const float values[4]);
void pni_set_matrix3(pni_gpu *gpu, const char *name, const float values[9]);
void pni_set_matrix4(pni_gpu *gpu, const char *name, const float values[16]);
void pni_set_texture(pni_gpu *gpu, const char *name, const pni_texture *texture);
/* A texture of the host's: read texel by texel, with its own sampling parameters, or linearly and repeated. */
typedef enum { PNI_SAMPLE_NEAREST, PNI_SAMPLE_OWN, PNI_SAMPLE_LINEAR } pni_sampling;
void pni_set_host_texture(pni_gpu *gpu, const char *name, pn_gl texture, pni_sampling sampling);

/* A triangle that covers the target. */
void pni_draw_screen(pni_gpu *gpu);
/* From gl_VertexID alone. */
void pni_draw_points(pni_gpu *gpu, int count);
void pni_draw_triangles(pni_gpu *gpu, int vertices);
/* Triangles of a mesh, from element first on. index_bytes 0: no indices; offset: of the first index in its buffer. */
void pni_draw_vertices(pni_gpu *gpu, const pni_vertices *vertices, int index_bytes, size_t offset, size_t first,
                       size_t count);

/* One value in an image: the host's own texture may be larger than the view, only that is written. */
pn_result pni_fill(pni_gpu *gpu, const char *name, const pni_pass *where, float value);

/* As many vertices as a texel says that the GPU itself wrote: arguments is an RGBA32UI texture one texel high, each
 * of its texels (count, 1, 0, 0). pni_counts_take copies them into a buffer, and pni_draw_counted draws as texel
 * index says, from gl_VertexID alone. Nothing is read back. Where the device has no indirect draws, most vertices are
 * drawn, and the shaders have to put what is past the count out of sight. */
pn_result pni_counts_take(pni_gpu *gpu, const pni_texture *arguments, pni_buffer *buffer);
void pni_draw_counted(pni_gpu *gpu, const pni_buffer *buffer, int index, int most);

/* For the host's draw callback: the texture on the unit that it is told of. Whatever it leaves is forgotten: the pass
 * has to be resumed. */
void pni_host_begin(pni_gpu *gpu, const pni_texture *peel);
void pni_host_end(pni_gpu *gpu);

#endif
