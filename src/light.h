/* A light: its frame, technique and maps. */
#ifndef PNI_LIGHT_H
#define PNI_LIGHT_H

#include "pair.h"
#include "techniques/registry.h"

struct pn_light {
  pni_object object;
  bool set;
  pn_light_desc desc; /* defaults filled in */
  pni_frame frame;
  pni_emission emission;
  const pni_technique_class *technique;
  double values[PNI_PARAMETERS_MAX];
  pni_maps maps;
  pni_texture trim[2]; /* maps/trim.c's, while a fit is made */
  pni_buffer block;
  pni_light_block uploaded; /* what block holds */
  pni_kept kept;            /* by the technique */
  uint64_t casters;         /* serial of those of the last update, which may be gone */
  uint32_t groups;
  pni_emission reaching; /* what a fit takes for the light's extent: see pni_maps_want.reach_turned */
  pni_region visible;
  bool has_visible;
  bool warned_angle;
  pni_clock clock;
};

static inline pni_gpu *pni_light_gpu(const pn_light *light) { return &light->object.context->gpu; }

/* The light's block with the technique's parameters in it. */
void pni_light_fill_block(const pn_light *light, pni_light_block *block);
/* The same, uploaded and bound for the library's own passes. */
pn_result pni_light_bind_block(pn_light *light);

/* The light's part of a job. */
pn_result pni_light_job(pn_light *light, pni_job *out);

#endif
