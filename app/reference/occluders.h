/* occluders.h: the casters as Embree wants them, and the only place that knows Embree. */
#ifndef PENUMBRA_APP_REFERENCE_OCCLUDERS_H
#define PENUMBRA_APP_REFERENCE_OCCLUDERS_H

#include "reference/reference.h"
#include "reference/sampling.h"

struct occluders;

/* Builds the hierarchy with so many threads. stop (may be NULL) is asked now and then, on any thread: nonzero ends
 * the build with REFERENCE_STOPPED. *out is NULL unless REFERENCE_OK is returned. */
enum reference_status occluders_create(const struct reference_casters *casters, int threads, int (*stop)(void *user),
                                       void *user, struct occluders **out);
void occluders_destroy(struct occluders **occluders);

/* Nothing blocks anything. */
int occluders_empty(const struct occluders *occluders);

/* The largest magnitude of any coordinate. */
float occluders_magnitude(const struct occluders *occluders);

/* Up to 16 rays from one origin: origin + t direction, t in (0, reach). valid[i] is -1 for rays that are traced, else
 * 0. Returns how many of them are blocked. May be called by many threads at once. */
struct ray_packet {
  float origin[3], reach;
  float direction[3][SAMPLING_LANES];
  int valid[SAMPLING_LANES];
};
int occluders_blocked(const struct occluders *occluders, const struct ray_packet *packet);

#endif
