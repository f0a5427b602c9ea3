/* A light: its frame, technique and maps. */
#ifndef PN_LIGHT_H
#define PN_LIGHT_H

#include "techniques/technique.h"

struct pn_light {
  pn_object object;
  bool set;
  pn_light_desc desc; /* defaults filled in */
  pn_frame frame;
  const pn_technique_class *technique;
  double values[PN_PARAMETERS_MAX];
  pn_maps maps;
  pn_buffer block;
  pn_casters *casters; /* of the last update; looked up before it is used, since it may be gone */
  uint32_t groups;
  pn_region visible;
  bool has_visible;
  bool warned_angle;
  pn_clock clock;
};

static inline pn_gpu *pn_light_gpu(const pn_light *light) { return &light->object.context->gpu; }

/* The light's block with the technique's parameters in it. */
void pn_light_fill_block(const pn_light *light, pn_light_block *block);
/* The same, uploaded and bound for the library's own passes. */
pn_result pn_light_bind_block(pn_light *light);

#endif
