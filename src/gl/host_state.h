/* The host's GL state, as it was read: every piece that the library may set. */
#ifndef PNI_GL_HOST_STATE_H
#define PNI_GL_HOST_STATE_H

#include "gl/functions.h"
#include "gl/limits.h"

/* Of compatibility contexts (gl/fixed.h). */
typedef struct {
  GLint clamp_fragment;
  GLfloat transfer[PNI_TRANSFER_NAMES], bias[PNI_UNITS];
} pni_fixed_state;

typedef struct {
  GLint program, vertex_array, array_buffer, draw_framebuffer, read_framebuffer, uniform_buffer, pixel_pack,
      pixel_unpack, draw_indirect;
  GLint block_buffer; /* the indexed uniform buffer binding the library uses */
  GLint64 block_start, block_size;
  GLint active_texture, texture_2d[PNI_UNITS], texture_array[PNI_UNITS], texture_multisample[PNI_UNITS],
      sampler[PNI_UNITS];
  GLint viewport[4], scissor[4], clamp_read;
  GLboolean color_mask[PNI_DRAW_BUFFERS_SAVED][4], depth_mask, blend[PNI_DRAW_BUFFERS_SAVED];
  GLint blend_equation[2], blend_function[4]; /* of draw buffer 0: colour, alpha; source and destination of each */
  GLint depth_func, cull_face, front_face, polygon_mode[2], provoking_vertex;
  GLdouble depth_range[2], clear_depth;
  GLint clip_origin, clip_depth;
  GLint pack[5]; /* alignment, row length, skip rows, skip pixels, swap bytes */
  GLint unpack[5];
  GLboolean clip[PNI_CLIP_DISTANCES_SAVED];
  GLboolean enabled[PNI_SWITCHES]; /* in the order of pni_capabilities.switches */
  pni_fixed_state fixed;
} pni_host_state;

#endif
