/* What a light and a receiver have together: the visibility buffer, and its times. */
#ifndef PN_PAIR_H
#define PN_PAIR_H

#include "context.h"
#include "maps/receiver_map.h"

enum { PN_WORK_MAX = 10 };

typedef struct pn_pair {
  pn_object *light, *receiver;
  const void *technique;        /* of the last draw: whose work there is */
  pn_texture image;             /* the result */
  pn_texture low;               /* at reduced resolution, before it is brought up */
  pn_texture work[PN_WORK_MAX]; /* a technique's own */
  pn_receiver_map seen;         /* for techniques that scatter */
  pn_buffer arguments;          /* of draws that the GPU counts */
  pn_soft_shadow_map soft;      /* of the last draw; no texture: none */
  bool warned;                  /* a technique's warning was given */
  pn_texture search;            /* what a search did, when debugging */
  pn_texture covered;           /* how often a scattering technique came by each texel, when debugging */
  pn_texture bound;             /* of the error, when debugging, where the technique has one */
  bool drawn;
  pn_clock clock;
  struct pn_pair *next;
} pn_pair;

/* NULL when there is none. */
pn_pair *pn_pair_find(const pn_object *light, const pn_object *receiver);
/* Finds or makes it; NULL when out of memory. */
pn_pair *pn_pair_get(pn_object *light, pn_object *receiver);
/* Before a technique draws: what another one left is freed. */
void pn_pair_begin(pn_gpu *gpu, pn_pair *pair, const void *technique);
/* Frees every pair that the object is part of. */
void pn_pairs_drop(const pn_object *object, bool abandon);

#endif
