/* What a camera sees, in patches of 16 x 16 pixels in light map space: for each its bounds, and a plane below all of
 * it. Found on the GPU, read back. docs/space.md says what a plane below tells of casters. */
#ifndef PNI_RECEIVER_PATCHES_H
#define PNI_RECEIVER_PATCHES_H

#include "receiver/receiver.h"

typedef struct {
  double least[3], most[3]; /* s, t, w */
  /* No point of it lies below w = offset + slope_s s + slope_t t, but for its own error. abs(slope_s) A_u +
   * abs(slope_t) A_v is less than 1. */
  double slope[2], offset;
  double error; /* how far w may be off that plane, for the precision of the host's depth */
} pni_patch;

typedef struct {
  pni_patch *patches;
  int count, capacity;
} pni_patch_list;

/* Adds the patches of a view to the list. */
pn_result pni_receiver_patches(pn_receiver *receiver, const pni_frame *frame, const pni_emission *emission,
                               pni_patch_list *list);
/* The offset of the highest plane with these slopes that nothing seen lies below, each pixel taken as high as it may be
 * off; the smaller of that and *offset. After pni_receiver_patches in the same frame. */
pn_result pni_receiver_offset(pn_receiver *receiver, const pni_frame *frame, const double slope[2], double *offset);
void pni_patches_free(pni_gpu *gpu, pni_patch_list *list);

#endif
