/* What the camera sees, as the light sees it: the host's depth, scattered into light map space. Scattering computes
 * shadows where surfaces receive them, so it needs them there; the camera's depth is all the library is given, and
 * all it needs: a shadow that no pixel shows does not have to be computed. docs/space.md. */
#ifndef PNI_TECHNIQUES_SSM_SEEN_H
#define PNI_TECHNIQUES_SSM_SEEN_H

#include "job.h"

typedef struct {
  double bounds[4]; /* s0, t0, s1, t1 */
  double w_least, w_most;
  int width, height;
  int layers; /* surfaces that are told apart behind one another, from the light; at least 1 */
} pni_seen_want;

typedef struct {
  /* RGBA32F array, a layer for each surface, nearest to the light first. A texel: w of the surface at its centre, and
   * its tangent plane (seen.glsl); w is PN_NOTHING where no pixel shows one. */
  pni_texture layers;
  pni_texture range; /* pyramid over layers: largest and smallest w of 2^i x 2^i texels, padded to powers of two */
  pni_texture aside, depth; /* while a layer is drawn */
  pni_seen_want want;
} pni_seen;

/* Draws the map; the light's block must be bound. */
pn_result pni_seen_draw(const pni_job *job, const pni_seen_want *want, pni_seen *seen);
/* Layers, range and bounds, for the pass that has begun, whose program includes techniques/ssm/seen.glsl. */
void pni_seen_set(pni_gpu *gpu, const pni_seen *seen);
void pni_seen_free(pni_gpu *gpu, pni_seen *seen, bool abandon);

#endif
