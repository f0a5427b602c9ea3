#include "maps/origin.h"

#include <math.h>

/* Farther than so many of the casters' extents is far. */
static const double far_extents = 16;

typedef struct {
  double low[3], high[3];
} extents;

static void look(void *user, const double corners[8][3]) {
  extents *e = user;
  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 3; k++) {
      e->low[k] = fmin(e->low[k], corners[i][k]);
      e->high[k] = fmax(e->high[k], corners[i][k]);
    }
}

/* On a grid that is coarse against the casters, so that they may move without taking the frame along: bounds of maps
 * snap to grids that begin where it does. */
void pni_frame_place(pni_frame *frame, const pn_casters *casters, uint32_t groups) {
  if (frame->projection != PNI_PARALLEL) return;
  extents e = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  pni_casters_each_box(casters, groups, look, &e);
  double size = 0, distance = 0;
  for (int k = 0; k < 3; k++) {
    size = fmax(size, e.high[k] - e.low[k]);
    distance = fmax(distance, fabs(0.5 * (e.low[k] + e.high[k])));
    frame->origin[k] = 0;
  }
  if (!(size > 0) || !isfinite(distance) || distance <= far_extents * size) return;
  double step = exp2(ceil(log2(size)) + 2);
  for (int k = 0; k < 3; k++) frame->origin[k] = step * round(0.5 * (e.low[k] + e.high[k]) / step);
}
