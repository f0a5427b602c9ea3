/* How much of GL the library takes for itself, and so saves. */
#ifndef PNI_GL_LIMITS_H
#define PNI_GL_LIMITS_H

enum {
  /* Texture units, from 0. A program's samplers take them in the order in which the compiler lists them. */
  PNI_UNITS = 12,
  PNI_UNIT_SCRATCH = PNI_UNITS - 1, /* for looking at textures and filling them: no sampler's */
  PNI_UNIT_PEEL = 6,                /* what a host's draw callback finds the previous layer on */
  PNI_DRAW_BUFFERS_SAVED = 8,
  PNI_CLIP_DISTANCES_SAVED = 8,
  PNI_SWITCHES = 22,      /* capabilities that are switched off, at most */
  PNI_TRANSFER_NAMES = 12 /* of pixel transfer in compatibility contexts */
};

enum { PNI_COLORS = 3 }; /* colour targets of a pass */

#endif
