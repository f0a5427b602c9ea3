/* What a light and a receiver have together: the visibility buffer, and its times. */
#ifndef PN_PAIR_H
#define PN_PAIR_H

#include "context.h"
#include "maps/receiver_map.h"

enum { PNI_WORK_MAX = 10 };

typedef struct pni_pair {
  pni_object *light, *receiver;
  const void *technique;          /* of the last draw: whose work there is */
  pni_texture image;              /* the result */
  pni_texture low;                /* at reduced resolution, before it is brought up */
  pni_texture work[PNI_WORK_MAX]; /* a technique's own */
  pni_receiver_map seen;          /* for techniques that scatter */
  pni_buffer arguments;           /* of draws that the GPU counts */
  pn_soft_shadow_map soft;        /* of the last draw; no texture: none */
  bool warned;                    /* a technique's warning was given */
  pni_texture search;             /* what a search did, when debugging */
  pni_texture covered;            /* how often a scattering technique came by each texel, when debugging */
  pni_texture bound;              /* of the error, when debugging, where the technique has one */
  bool drawn;
  pni_clock clock;
  struct pni_pair *next;
} pni_pair;

/* NULL when there is none. */
pni_pair *pni_pair_find(const pni_object *light, const pni_object *receiver);
/* Finds or makes it; NULL when out of memory. */
pni_pair *pni_pair_get(pni_object *light, pni_object *receiver);
/* Before a technique draws: what another one left is freed. */
void pni_pair_begin(pni_gpu *gpu, pni_pair *pair, const void *technique);
/* Frees every pair that the object is part of. */
void pni_pairs_drop(const pni_object *object, bool abandon);

#endif
