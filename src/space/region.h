/* Parts of light map space: what a light's receivers occupy. */
#ifndef PN_SPACE_REGION_H
#define PN_SPACE_REGION_H

#include "space/space.h"

/* Bounds in (s, t, w); least > most where it is empty. */
typedef struct {
  double least[3], most[3];
} pn_region;

pn_region pn_region_empty(void);
void pn_region_add(pn_region *region, const double m[3]);
/* Adds what a camera's frustum covers. scene_from_clip: inverse of projection * view; depth_near: 0 or -1, the near end of its clip
 * space. */
void pn_region_add_frustum(pn_region *region, const pn_frame *frame, const pn_matrix *scene_from_clip,
                           double depth_near);

#endif
