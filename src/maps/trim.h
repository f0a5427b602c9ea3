/* Of what a fit covers, the part whose casters can shadow something that is seen: what lies in front of no visible
 * receiver, such as a ground that nothing is below, must not stretch the map. */
#ifndef PNI_MAPS_TRIM_H
#define PNI_MAPS_TRIM_H

#include "maps/list.h"
#include "receiver/grid.h"

/* An image of casters seen from the light, size x size samples of the nearest w at texel centres. */
typedef struct {
  const float *w; /* PNI_NOTHING where there is none */
  int size;
  double bounds[4]; /* s0, t0, s1, t1 */
  pni_caster_error error;
  const double *floor; /* a plane that nothing seen lies below, as of pni_fit_kept; NULL: none */
} pni_trim_image;

/* Bounds of the samples that can shadow what the grid holds, outwards to the next ones. False: there are none. */
bool pni_trim_bounds(const pni_trim_image *image, const pni_grid *grid, double out[4]);

typedef struct {
  const pni_frame *frame;
  pn_casters *casters;
  uint32_t groups;
  double range; /* as of pni_map_draw */
  const pni_fit_result *fit;
  const pni_grid *grid;
  /* Where casters lie close to the plane that most of what is seen lies in: makes of it one that nothing seen lies
   * below. *found false: there is none. */
  pn_result (*lower)(void *user, double plane[3], bool *found);
  void *user;
} pni_trim_request;

/* Draws the casters within the fit's bounds into images, which are kept from time to time, and finds which of them
 * count; anew over what is left, where that is much less. Bounds are inverted where nothing casts on what is seen.
 * has_floor: casters lie on the floor or below. */
pn_result pni_trim(pni_gpu *gpu, pni_texture images[2], const pni_trim_request *request, pni_fit_kept *out);

#endif
