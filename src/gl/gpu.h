/* The GL context as the library sees it: functions, capabilities, memory, messages. Everything above holds a pn_gpu. */
#ifndef PN_GL_GPU_H
#define PN_GL_GPU_H

#include <stdbool.h>
#include <penumbra/penumbra.h>
#include "gl/functions.h"

/* Texture units the library uses, from 0. State saving covers exactly these. */
enum {
  PN_UNIT_MAPS = 0, /* the light's depth maps */
  PN_UNIT_RANGE,    /* the light's range pyramid */
  PN_UNIT_DEPTH,    /* the receiver's depth */
  PN_UNIT_NORMAL,
  PN_UNIT_MASK,
  PN_UNIT_WORK, /* whatever a technique keeps between its passes */
  PN_UNIT_PEEL,
  PN_UNIT_ALPHA,
  PN_UNIT_SEEN,       /* the receiver map */
  PN_UNIT_SEEN_RANGE, /* its range pyramid */
  PN_UNIT_COUNT
};

typedef struct {
  int version; /* 33, 45, 46 */
  bool software;
  bool compatibility; /* a compatibility profile: some state exists only there */
  bool viewports;     /* 4.1: one viewport, depth range and scissor test for each index */
  bool clip_control;  /* 4.5 or ARB_clip_control */
  bool robustness;    /* GetGraphicsResetStatus works */
  bool float_blend;   /* 32-bit float images can be blended: all desktop GL can; OpenGL ES 3 needs an extension */
  bool blend_buffers; /* 4.0: each draw buffer has its own blend function */
  bool indirect;      /* 4.0 or ARB_draw_indirect: draws whose counts lie in a buffer */
  bool fixed_restart; /* GL_PRIMITIVE_RESTART_FIXED_INDEX, 4.3 */
  int texture_size_max, layers_max, draw_buffers, subpixel_bits, clip_distances, sample_mask_words;
} pn_capabilities;

typedef struct pn_program pn_program;

typedef struct pn_gpu {
  pn_gl_table gl;
  pn_gl_storage storage;
  pn_capabilities can;
  pn_context_desc desc; /* the host's callbacks */
  char *shader_directory;

  size_t memory; /* bytes in textures and buffers */
  bool timing;
  int debug; /* PN_DEBUG_...: what techniques tell of what they did */

  pn_gl vertex_array; /* without attributes: full-screen triangles */
  pn_gl framebuffer;  /* the one the passes draw to */
  pn_gl read_framebuffer;
  pn_gl sampler_nearest; /* no filtering, clamped, no comparison */
  pn_program *programs;
} pn_gpu;

/* Finds functions and capabilities and makes the shared objects. On failure everything is undone. */
pn_result pn_gpu_open(pn_gpu *gpu, const pn_context_desc *desc);
/* abandon: free memory without a GL call. */
void pn_gpu_close(pn_gpu *gpu, bool abandon);

/* PN_ERROR_CONTEXT_LOST, with a message, when the GL context was reset, as far as the device tells. */
pn_result pn_gpu_check_lost(pn_gpu *gpu);

/* Memory from the host's allocator. */
void *pn_reallocate(pn_gpu *gpu, void *old, size_t bytes); /* NULL when out of memory, after a message */
void *pn_allocate_zero(pn_gpu *gpu, size_t bytes);
void pn_free(pn_gpu *gpu, void *memory);

/* Sends a message to the host. Returns result, so that a failure is one line: return pn_fail(...). */
pn_result pn_fail(pn_gpu *gpu, pn_result result, pn_message message, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
void pn_note(pn_gpu *gpu, pn_log_level level, pn_message message, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
