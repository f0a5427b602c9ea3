/* One camera view: the host's depth, as the shaders read it. */
#ifndef PN_RECEIVER_RECEIVER_H
#define PN_RECEIVER_RECEIVER_H

#include "context.h"
#include "space/region.h"

struct pn_receiver {
  pni_object object;
  bool set;
  pn_receiver_desc desc; /* width and height filled in */
  pni_texture copy;      /* of a framebuffer, or of sample 0 of a multisample texture */
  bool copied;           /* the copy is what is read, and its origin is the view's */
  pni_matrix scene_from_clip;
  pni_matrix scene_from_pixel; /* (x + 1/2, y + 1/2, stored depth, 1) in the view */
  pni_texture bounds[4];       /* what bounds.c reduces into: two pairs, in turn */
  float quantum[4];            /* error of a depth: absolute, relative; background; angle error of given normals */
};

/* Size of the image that visibility is computed at: 1/scale, rounded up. */
void pni_receiver_low_size(const pn_receiver *receiver, int *width, int *height);

/* Lines for a program that includes receiver/surface.glsl. */
enum { PNI_RECEIVER_DEFINES = 64 };
void pni_receiver_defines(const pn_receiver *receiver, char out[PNI_RECEIVER_DEFINES]);
/* Textures and uniforms for such a program, which is in use. scale 1: every pixel itself. */
void pni_receiver_bind(pn_receiver *receiver, const pni_program *program, const pni_frame *frame, int scale);

/* Adds what the camera sees to the region: reads a few numbers back. */
pn_result pni_receiver_bounds(pn_receiver *receiver, const pni_frame *frame, pni_region *region);
/* Adds what its frustum contains. */
void pni_receiver_frustum(const pn_receiver *receiver, const pni_frame *frame, pni_region *region);

#endif
