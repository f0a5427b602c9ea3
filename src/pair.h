/* What a light and a receiver have together: the visibility buffer, and its times. */
#ifndef PNI_PAIR_H
#define PNI_PAIR_H

#include "context.h"
#include "gl/clock.h"
#include "kept.h"

typedef struct {
  pni_object object; /* needs the light and the receiver */
  pni_texture image; /* the result */
  bool drawn;
  bool asked;                 /* the last draw was the technique's: something cast */
  pni_texture low;            /* at reduced resolution, before it is brought up */
  pni_texture search, levels; /* what a search did, when debugging */
  pni_kept kept;              /* by the technique of the last draw */
  pni_clock clock;
} pni_pair;

/* NULL when there is none. */
pni_pair *pni_pair_find(const pni_object *light, const pni_object *receiver);
/* Finds or makes it; NULL when out of memory. */
pni_pair *pni_pair_get(pni_object *light, pni_object *receiver);
/* The pair that an object is; NULL: it is none of that light's. */
pni_pair *pni_pair_of(pni_object *object, const pni_object *light);

#endif
