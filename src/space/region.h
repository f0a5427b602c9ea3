/* Parts of light map space: what a light's receivers occupy. */
#ifndef PNI_SPACE_REGION_H
#define PNI_SPACE_REGION_H

#include "space/space.h"

/* Bounds in (s, t, w); least > most where it is empty. */
typedef struct {
  double least[3], most[3];
} pni_region;

pni_region pni_region_empty(void);
void pni_region_add(pni_region *region, const double m[3]);
/* Adds what a camera's frustum covers. scene_from_clip: inverse of projection * view; depth_near: 0 or -1, the near
 * end of its clip space. */
void pni_region_add_frustum(pni_region *region, const pni_frame *frame, const pni_matrix *scene_from_clip,
                            double depth_near);

#endif
