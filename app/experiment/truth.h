/* truth.h: a scene's view, ray-traced: from the program's own structures to the reference and its cache. */
#ifndef PENUMBRA_APP_EXPERIMENT_TRUTH_H
#define PENUMBRA_APP_EXPERIMENT_TRUTH_H

#include "host/view.h"

struct truth {
  float *visibility; /* one a pixel, top row first; free it */
  double seconds;    /* what tracing took, when it was traced */
  double rays;
  int from_cache;
};

/* Traces from the points of view, which gbuffer was read into, with a progress bar. The GL context of gbuffer must be
 * current. A cache that cannot be used costs one warning. Exit status. */
int truth_trace(const struct scene *scene, const struct gbuffer *gbuffer, const struct view *view, int samples,
                int use_cache, struct truth *out);

#endif
