/* The GL context as the library sees it: functions, capabilities, memory, messages. Everything above holds a pni_gpu. */
#ifndef PN_GL_GPU_H
#define PN_GL_GPU_H

#include <stdbool.h>
#include <penumbra/penumbra.h>
#include "gl/functions.h"

/* Texture units the library uses, from 0. State saving covers exactly these. */
enum {
  PNI_UNIT_MAPS = 0, /* the light's depth maps */
  PNI_UNIT_RANGE,    /* the light's range pyramid */
  PNI_UNIT_DEPTH,    /* the receiver's depth */
  PNI_UNIT_NORMAL,
  PNI_UNIT_MASK,
  PNI_UNIT_WORK, /* whatever a technique keeps between its passes */
  PNI_UNIT_PEEL,
  PNI_UNIT_ALPHA,
  PNI_UNIT_SEEN,       /* the receiver map */
  PNI_UNIT_SEEN_RANGE, /* its range pyramid */
  PNI_UNIT_COUNT
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
} pni_capabilities;

typedef struct pni_program pni_program;

typedef struct pni_gpu {
  pni_gl_table gl;
  pni_gl_storage storage;
  pni_capabilities can;
  pn_context_desc desc; /* the host's callbacks */
  char *shader_directory;

  size_t memory; /* bytes in textures and buffers */
  bool timing;
  int debug; /* PN_DEBUG_...: what techniques tell of what they did */

  pn_gl vertex_array; /* without attributes: full-screen triangles */
  pn_gl framebuffer;  /* the one the passes draw to */
  pn_gl read_framebuffer;
  pn_gl sampler_nearest; /* no filtering, clamped, no comparison */
  pni_program *programs;
} pni_gpu;

/* Finds functions and capabilities and makes the shared objects. On failure everything is undone. */
pn_result pni_gpu_open(pni_gpu *gpu, const pn_context_desc *desc);
/* abandon: free memory without a GL call. */
void pni_gpu_close(pni_gpu *gpu, bool abandon);

/* PN_ERROR_CONTEXT_LOST, with a message, when the GL context was reset, as far as the device tells. */
pn_result pni_gpu_check_lost(pni_gpu *gpu);

/* Memory from the host's allocator. */
void *pni_reallocate(pni_gpu *gpu, void *old, size_t bytes); /* NULL when out of memory, after a message */
void *pni_allocate_zero(pni_gpu *gpu, size_t bytes);
void pni_free(pni_gpu *gpu, void *memory);

/* Sends a message to the host. Returns result, so that a failure is one line: return pni_fail(...). */
pn_result pni_fail(pni_gpu *gpu, pn_result result, pn_message message, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
void pni_note(pni_gpu *gpu, pn_log_level level, pn_message message, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
