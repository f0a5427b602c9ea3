/* One camera view: the host's depth, as the shaders read it. */
#ifndef PNI_RECEIVER_RECEIVER_H
#define PNI_RECEIVER_RECEIVER_H

#include "context.h"
#include "gl/host_texture.h"
#include "gl/pass.h"
#include "space/region.h"
#include "space/rounding.h"

struct pn_receiver {
  pni_object object;
  bool set;
  pn_receiver_desc desc; /* width and height filled in */
  pni_texture copy;      /* of a framebuffer, or of sample 0 of a multisample texture */
  bool copied;           /* the copy is what is read, and its origin is the view's */
  pni_matrix scene_from_clip;
  pni_matrix scene_from_pixel; /* (x + 1/2, y + 1/2, stored depth, 1) in the view */
  float depth_error[2];        /* of a stored depth: absolute, relative to it */
  float normal_error;          /* angle by which a given normal may be off, radians */
  double view_rounding;        /* scene units: what the host's vertex shader may lose by the view's distance */
  pni_texture planes;    /* without given normals: how depth goes on around each pixel (receiver/planes.frag.glsl) */
  bool has_planes;       /* they are this frame's */
  pni_texture bounds[4]; /* what bounds.c reduces into: two pairs, in turn */
  pni_texture slopes, below; /* of patches: slopes to try; planes below */
  pni_host_texture held[3];  /* while it is open: depth, normals, mask */
  bool told_range;           /* that glDepthRange may have been another */
};

/* The stored depth that means nothing was drawn. */
float pni_receiver_background(const pn_receiver *receiver);

/* Size of the image that visibility is computed at: 1/scale, rounded up. */
void pni_receiver_low_size(const pn_receiver *receiver, int *width, int *height);

/* Before and after the host's textures are read: whether they are still what pn_receiver_set saw is looked at, and
 * their parameters are made neutral. After a failure there is nothing to close. One receiver is open at a time. */
pn_result pni_receiver_open(pn_receiver *receiver);
void pni_receiver_close(pn_receiver *receiver);

/* What all passes over the view's surfaces share, made once a frame: before the first of them, outside of any pass. */
pn_result pni_receiver_surfaces(pn_receiver *receiver);

/* Lines for a program that includes receiver/surface.glsl or receiver/depth.glsl. */
enum { PNI_RECEIVER_DEFINES = 64 };
void pni_receiver_defines(const pn_receiver *receiver, char out[PNI_RECEIVER_DEFINES]);
/* Textures and uniforms for such a program, in the pass that has begun. emission: NULL where positions alone are read.
 * rounding: of the light's casters. scale 1:
 * every pixel itself. */
void pni_receiver_uniforms(pn_receiver *receiver, const pni_frame *frame, const pni_emission *emission,
                           const pni_rounding *rounding, int scale);

/* Adds what the camera sees to the region: reads a few numbers back. (receiver/bounds.c) */
pn_result pni_receiver_bounds(pn_receiver *receiver, const pni_frame *frame, pni_region *region);
/* Adds what its frustum contains. */
void pni_receiver_frustum(const pn_receiver *receiver, const pni_frame *frame, pni_region *region);

#endif
