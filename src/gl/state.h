/* The host's GL state: saved, restored, or put at GL's defaults. */
#ifndef PN_GL_STATE_H
#define PN_GL_STATE_H

#include "gl/gpu.h"

enum { PN_DRAW_BUFFERS_SAVED = 8, PN_CLIP_DISTANCES_SAVED = 8, PN_SWITCHES = 17 };

typedef struct {
  GLint program, vertex_array, array_buffer, draw_framebuffer, read_framebuffer, uniform_buffer, pixel_pack,
      pixel_unpack, draw_indirect;
  GLint block_buffer; /* the indexed uniform buffer binding the library uses */
  GLint64 block_start, block_size;
  GLint active_texture, texture_2d[PN_UNIT_COUNT], texture_array[PN_UNIT_COUNT], texture_multisample[PN_UNIT_COUNT],
      sampler[PN_UNIT_COUNT];
  GLint viewport[4], scissor[4], clamp_read;
  GLboolean color_mask[PN_DRAW_BUFFERS_SAVED][4], depth_mask, blend[PN_DRAW_BUFFERS_SAVED];
  GLint blend_equation[2], blend_function[4]; /* of draw buffer 0: colour, alpha; source and destination of each */
  GLint depth_func, cull_face, front_face, polygon_mode[2], provoking_vertex;
  GLdouble depth_range[2], clear_depth;
  GLint clip_origin, clip_depth;
  GLint pack[5]; /* alignment, row length, skip rows, skip pixels, swap bytes */
  GLint unpack[5];
  GLboolean clip[PN_CLIP_DISTANCES_SAVED];
  GLboolean enabled[PN_SWITCHES];
} pn_gl_state;

/* Viewport, depth range and switches of index 0 only: the host may use the others, and no shader of ours does. */
void pn_set_viewport(pn_gpu *gpu, int x, int y, int width, int height);
void pn_set_depth_range(pn_gpu *gpu, double near, double far);
void pn_set_scissor(pn_gpu *gpu, int x, int y, int width, int height);
void pn_set_switch(pn_gpu *gpu, GLenum name, bool on);
/* What a pass does with what its first colour image holds; the other images are never blended. */
typedef enum { PN_BLEND_NONE = 0, PN_BLEND_ADD, PN_BLEND_MIN } pn_blend;
void pn_set_blend(pn_gpu *gpu, pn_blend blend);

void pn_state_save(pn_gpu *gpu, pn_gl_state *state);
void pn_state_restore(pn_gpu *gpu, const pn_gl_state *state);
/* GL's defaults for everything the library touches, except the viewport, which has none. */
void pn_state_reset(pn_gpu *gpu);

/* Switches off everything that could change what a pass of the library draws: whatever the host, or its draw
 * callback, left on. */
void pn_state_neutral(pn_gpu *gpu);

/* The indexed binding of the uniform block that the library's own passes use. */
enum { PN_BLOCK_BINDING = 0 };

#endif
