/* What a technique is asked to do, whole: the same description in pn_maps_update and in pn_visibility, for every
 * technique. */
#ifndef PNI_JOB_H
#define PNI_JOB_H

#include "gl/clock.h"
#include "maps/list.h"
#include "receiver/receiver.h"

struct pni_gathering; /* gather/gather.h */

/* Where visibility goes. */
typedef struct {
  pni_image image;
  int channels; /* that are written, all with the same: bit 0 red .. bit 3 alpha; 0: all that there are */
} pni_target;

typedef struct {
  pni_gpu *gpu;
  const pn_technique *table;
  const struct pni_gathering *gathering; /* of techniques that gather */
  const double *values;                  /* parameters, in the order of the table */

  /* the light */
  const pn_light_desc *desc;
  const pni_frame *frame;
  const pni_emission *emission;
  pni_maps *maps; /* drawn as the technique wanted them; the block that describes them is bound */
  void *light_state;
  pn_casters *casters; /* of the last pn_maps_update; NULL when they are gone */
  uint32_t groups;
  const pni_region *visible; /* what that update was fitted to, or NULL */
  pni_clock *clock;

  /* in pn_visibility only */
  pn_receiver *receiver; /* NULL in pn_maps_update */
  void *pair_state;
  /* for what gathers: visibility at reduced resolution; what a search did, and at which levels */
  pni_texture *low, *search, *levels;
  pni_target target;
} pni_job;

/* What was drawn since the last mark was this stage. */
static inline void pni_job_mark(const pni_job *job, const char *name) { pni_clock_mark(job->gpu, job->clock, name); }

/* A pass over the receiver's view into the target. */
static inline pni_pass pni_job_pass(const pni_job *job, const char *name, pni_program_key program) {
  return (pni_pass){.name = name,
                    .program = program,
                    .color = {job->target.image},
                    .channels = job->target.channels,
                    .width = job->receiver->desc.width,
                    .height = job->receiver->desc.height};
}

#endif
