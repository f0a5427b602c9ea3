/* What float arithmetic loses of casters that lie far from their own origin, or are taken far and back. */
#ifndef PNI_CASTERS_ROUNDING_H
#define PNI_CASTERS_ROUNDING_H

#include "casters/casters.h"
#include "space/rounding.h"

/* map: of the matrix that takes them to the light's frame. */
pni_rounding pni_casters_rounding(const pn_casters *casters, uint32_t groups, const pni_frame *frame);

#endif
