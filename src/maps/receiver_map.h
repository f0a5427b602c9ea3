/* Receivers as the light sees them: the host's camera depth, scattered into light map space. Scattering techniques
 * compute shadows where receivers are, so they need them there; the camera's depth is all the library is given, and
 * all it needs: a shadow that no pixel shows does not have to be computed. docs/space.md. */
#ifndef PN_MAPS_RECEIVER_MAP_H
#define PN_MAPS_RECEIVER_MAP_H

#include "maps/maps.h"
#include "receiver/receiver.h"

typedef struct {
  double bounds[4]; /* s0, t0, s1, t1 */
  double w_least, w_most;
  int width, height;
  int layers; /* surfaces that are told apart behind one another, from the light; at least 1 */
} pni_receiver_map_want;

typedef struct {
  /* RGBA32F array, a layer for each surface, nearest to the light first. A texel: w of the receiver at its centre, and
   * the receiver's tangent plane (maps/receiver_map.glsl); w is PN_NOTHING where no pixel shows one. */
  pni_texture layers;
  pni_texture range; /* pyramid over layers: largest and smallest w of 2^i x 2^i texels, padded to powers of two */
  pni_texture aside, depth; /* while a layer is drawn */
  pni_receiver_map_want want;
} pni_receiver_map;

/* Draws the map; the light's block must be bound. */
pn_result pni_receiver_map_draw(pn_receiver *receiver, const pni_frame *frame, const pni_receiver_map_want *want,
                                pni_receiver_map *map);
/* Layers and range to their units and the bounds, for a program in use that includes maps/receiver_map.glsl. */
void pni_receiver_map_bind(pni_gpu *gpu, const pni_receiver_map *map, const pni_program *program);
pn_result pni_receiver_map_prepare(pni_gpu *gpu, int layers);
void pni_receiver_map_free(pni_gpu *gpu, pni_receiver_map *map, bool abandon);

#endif
