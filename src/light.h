/* A light: its frame, technique and maps. */
#ifndef PN_LIGHT_H
#define PN_LIGHT_H

#include "techniques/technique.h"

struct pn_light {
  pni_object object;
  bool set;
  pn_light_desc desc; /* defaults filled in */
  pni_frame frame;
  const pni_technique_class *technique;
  double values[PNI_PARAMETERS_MAX];
  pni_maps maps;
  pni_buffer block;
  pn_casters *casters; /* of the last update; looked up before it is used, since it may be gone */
  uint32_t groups;
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

#endif
