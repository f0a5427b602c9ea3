/* Where a sun's frame begins. */
#ifndef PNI_MAPS_ORIGIN_H
#define PNI_MAPS_ORIGIN_H

#include "casters/casters.h"
#include "space/space.h"

/* A sun has no centre: its frame may begin anywhere, and floats are finest near where it does. It begins at the scene's
 * origin; where casters lie far from that, near them. A rectangle's stays at its centre. */
void pni_frame_place(pni_frame *frame, const pn_casters *casters, uint32_t groups);

#endif
