/* The frame around gathering techniques: one full-screen pass, or two at reduced resolution. */
#ifndef PNI_GATHER_GATHER_H
#define PNI_GATHER_GATHER_H

#include "job.h"

enum { PNI_TECHNIQUE_DEFINES = 2048 };

/* What a gathering technique consists of. */
typedef struct pni_gathering {
  const char *shader; /* with pn_technique(); NULL: the technique does not gather */
  /* #defines that the shader depends on, as lines; what may change without compiling is read from the block. NULL:
   * none. */
  void (*defines)(const double *values, char *out, size_t size);
  /* What the shader reads beside the depth maps, in place of the range; state: what the technique keeps for the light.
   * NULL: the range. */
  const pni_texture *(*beside)(const void *light_state);
  bool searches; /* it includes search/search.glsl and tells what it did */
} pni_gathering;

/* pni_technique_class.draw of all of them. */
pn_result pni_gather(const pni_job *job);

/* The post-filter (Bitmask Soft Shadows, section 3.1). */
typedef struct {
  int passes;     /* at least one */
  float way;      /* that a pass goes of it: at less than 1 every other pixel cannot drift from the ones between */
  float most;     /* that all of them together may change visibility by */
  float steepest; /* that visibility may change by between a pixel's neighbours: past that nothing is done */
  bool within_surfaces; /* between pixels of one surface only */
} pni_smoothing;
/* As pni_gather, for a technique whose shader knows PN_AREA: its visibility smoothed by what its accumulated area does.
 * both: scratch that the technique keeps with a pair. */
pn_result pni_gather_smoothed(const pni_job *job, const pni_smoothing *smoothing, pni_texture both[2]);

/* The texture beside the depth maps. */
const pni_texture *pni_gather_beside(const pni_gathering *gathering, const pni_maps *maps, const void *light_state);
/* The shader's defines: its parameters' places by name, PN_PARAMETER_NAME, then what depends on these values. */
void pni_gather_defines(const pni_gathering *gathering, const pn_technique *table, const double *values,
                        char out[PNI_TECHNIQUE_DEFINES]);

#endif
