#include "space/region.h"

#include <math.h>

pni_region pni_region_empty(void) {
  return (pni_region){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

void pni_region_add(pni_region *region, const double m[3]) {
  for (int i = 0; i < 3; i++) {
    region->least[i] = fmin(region->least[i], m[i]);
    region->most[i] = fmax(region->most[i], m[i]);
  }
}

/* Corners stay homogeneous, so that those of an infinite frustum need no case of their own: h[3] is 0 there, or
 * rounding of either sign, and positive everywhere else before the camera. */
void pni_region_add_frustum(pni_region *region, const pni_frame *frame, const pni_matrix *scene_from_clip,
                            double depth_near) {
  pni_matrix light_from_scene = pni_light_from_scene(frame);
  pni_matrix light_from_clip = pni_matrix_multiply(&light_from_scene, scene_from_clip);
  bool parallel = frame->projection == PNI_PARALLEL, behind = false;
  for (int i = 0; i < 8; i++) {
    double clip[4] = {i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : depth_near, 1}, h[4];
    pni_matrix_apply(&light_from_clip, clip, h);
    double divisor = parallel ? h[3] : h[2];
    if (!(divisor > 1e-9 * (fabs(h[0]) + fabs(h[1]) + fabs(h[2])))) {
      behind = true; /* behind the light, or at infinity under a sun: no bound from this corner */
      continue;
    }
    double m[3] = {h[0] / divisor, h[1] / divisor, parallel ? -h[2] / divisor : h[3] / divisor};
    pni_region_add(region, m);
  }
  if (!behind) return;
  double everywhere[2][3] = {{PNI_NOTHING, PNI_NOTHING, parallel ? PNI_NOTHING : 0},
                             {PNI_EVERYTHING, PNI_EVERYTHING, PNI_EVERYTHING}};
  pni_region_add(region, everywhere[0]);
  pni_region_add(region, everywhere[1]);
}
