/* What a technique is. To add one: a folder with its table and shader, and a line in list.h. */
#ifndef PNI_TECHNIQUES_TECHNIQUE_H
#define PNI_TECHNIQUES_TECHNIQUE_H

#include "gather/gather.h"
#include "kept.h"

typedef struct {
  pn_technique table;
  /* The maps it needs with these values. */
  void (*want)(const double *values, pni_maps_want *out);
  /* Sets the other parameters to what that choice of `preset` stands for. NULL: the technique has no presets. */
  void (*preset)(int choice, double *values);
  /* The cheapest values that take the same programs, for pn_prepare. NULL: these. */
  void (*sketch)(double *values);

  /* From maps to visibility: pni_gather for techniques that gather, which need nothing else but what they gather by. */
  pn_result (*draw)(const pni_job *job);
  pni_gathering gathering;
  /* In each pn_maps_update, after the maps were drawn: what it makes of them for the light; stage: the name of its
   * time. NULL: nothing. */
  pn_result (*update)(const pni_job *job);
  const char *stage;

  /* What it keeps, for a light (from its first update on) and for a pair (from its first draw on), until the light
   * takes another technique. */
  pni_kind light_kind, pair_kind;
  /* The soft shadow map of the last draw, for techniques that have one; false: that draw left none. */
  bool (*soft_shadow_map)(const void *pair_state, pn_soft_shadow_map *out);
} pni_technique_class;

#endif
