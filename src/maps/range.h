/* Largest and smallest w of neighbourhoods of every layer: the range pyramid and the range stack. */
#ifndef PNI_MAPS_RANGE_H
#define PNI_MAPS_RANGE_H

#include "maps/list.h"

pn_result pni_range_shape(pni_gpu *gpu, pni_texture *texture, const pni_range_kind *kind, int layers, int width,
                          int height);
/* Fills pyramid or stack from what was drawn; the block must be bound. */
pn_result pni_range_build(pni_gpu *gpu, pni_maps *maps);
/* The levels of a pyramid above its first one, for every layer. */
pn_result pni_range_reduce(pni_gpu *gpu, const pni_texture *range);

#endif
