/* Images seen from the light: the list of maps, drawn and described. */
#ifndef PNI_MAPS_MAPS_H
#define PNI_MAPS_MAPS_H

#include "maps/list.h"

/* Shapes the textures for what is wanted. */
pn_result pni_maps_shape(pni_gpu *gpu, pni_maps *maps, const pni_maps_want *want, int count, int width, int height);
void pni_maps_free(pni_gpu *gpu, pni_maps *maps, bool abandon);

/* The block as it begins: light and frame, no map. */
void pni_maps_describe(pni_gpu *gpu, pni_maps *maps, const pni_frame *frame, const pni_emission *emission);

/* Draws a map into its layers and adds it to the block. */
typedef struct {
  const pni_frame *frame;
  pn_casters *casters;
  uint32_t groups;
  double bounds[4], w_near, w_far, shear[2];
  double range;        /* of the light; 0: no limit */
  const double *floor; /* casters on it or below are left out (pni_fit_kept); NULL: none */
  pni_part later;      /* with want.focus: the texels that layers past the first are drawn over */
  bool without_host;   /* callbacks are not called: their time is pn_maps_update */
} pni_map_draw;
pn_result pni_maps_add(pni_gpu *gpu, pni_maps *maps, const pni_map_draw *draw);

#endif
