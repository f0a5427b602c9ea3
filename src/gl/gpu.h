/* The GL context as the library sees it: functions, capabilities, what is bound. Everything above holds a pni_gpu. */
#ifndef PNI_GL_GPU_H
#define PNI_GL_GPU_H

#include <stdbool.h>
#include <penumbra/penumbra.h>
#include "gl/functions.h"
#include "gl/host_state.h"

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
  bool fixed;         /* a compatibility context with the functions of its own state (gl/fixed.h) */
  GLenum switches[PNI_SWITCHES]; /* that there are, of those that change what is drawn (gl/device.c) */
  int switch_count;
  bool stencil_texturing; /* 4.3 or ARB_stencil_texturing: depth-stencil textures can be read as stencil */
  bool by_name;           /* 4.5 or ARB_direct_state_access: textures are asked without being bound */
  bool targets;           /* and tell what kind they are */
  bool labels;            /* 4.3 or KHR_debug: objects and passes have names */
  int texture_size_max, layers_max, draw_buffers, subpixel_bits, clip_distances, sample_mask_words, debug_groups;
} pni_capabilities;

typedef struct pni_program pni_program;

/* What a pass does with what its first colour image holds; the other images are never blended. */
typedef enum { PNI_BLEND_NONE = 0, PNI_BLEND_ADD, PNI_BLEND_MIN } pni_blend;

/* One image to draw into: level 0.. of a texture, and a layer when it is an array. */
typedef struct {
  pn_gl texture; /* 0: none */
  bool array;
  int level, layer;
} pni_image;

/* GL's state as far as the library sets it, so that nothing is set twice (gl/bound.c). */
typedef struct {
  bool known; /* false: the host was here, nothing below can be relied on */
  pn_gl program, vertex_array, framebuffer, read_framebuffer, block;
  int active_unit;
  pn_gl texture[PNI_UNITS], sampler[PNI_UNITS];
  GLenum target[PNI_UNITS];
  pni_image color[PNI_COLORS], depth;
  bool attached;                            /* color and depth are what the framebuffer has */
  int viewport[4], scissor[4], channels[2]; /* channels: bits of the colour mask, for each image */
  bool depth_test, depth_write, depth_clamp, scissor_test, cull, clockwise, point_size;
  pn_faces culled;
  GLenum depth_func;
  double depth_range[2];
  pni_blend blend;
  bool group;       /* a debug group of the library's is open */
  uint32_t touched; /* units that something was bound to */
  bool blended;     /* blend functions were set */
} pni_bound;

/* A call that is planned before it draws (gl/plan.h). */
typedef struct {
  bool on;         /* nothing is drawn, everything is made */
  bool keep;       /* textures that are replaced come back if the plan fails */
  bool made;       /* a texture is new: that it can be drawn into is not known */
  unsigned number; /* of plans begun */
  struct pni_replaced *replaced;
  int count, capacity;
} pni_plan;

typedef struct pni_gpu {
  pni_gl_table gl;
  pni_gl_storage storage;
  size_t calls; /* of GL, so far; counted in builds with assertions */
  pni_capabilities can;
  pn_context_desc desc; /* the host's callbacks */
  char *shader_directory;

  size_t memory; /* bytes in textures and buffers */
  bool timing;
  bool only_errors; /* other messages are kept back */
  int debug;        /* PN_DEBUG_...: what techniques tell of what they did */

  pn_gl vertex_array; /* without attributes: full-screen triangles */
  pn_gl framebuffer;  /* the one the passes draw to */
  pn_gl read_framebuffer;
  pn_gl sampler_nearest; /* no filtering, clamped, no comparison */
  pn_gl sampler_linear;  /* linear, repeated */
  bool labelled;         /* these five are */
  bool group_room;       /* for a debug group beside the host's */
  pni_program *programs;

  pni_plan plan;
  pni_bound bound;
  const pni_host_state *host; /* what the host left, at entry; NULL: not read, or no longer so */
  const pni_program *program; /* of the pass that has begun */
  uint32_t textures_set;      /* its samplers that were given a texture */
} pni_gpu;

#ifndef NDEBUG
/* What GL() counts with; a function, because calls stand in one another's arguments. */
static inline void pni_count_call(pni_gpu *gpu) { gpu->calls++; }
#endif

#endif
