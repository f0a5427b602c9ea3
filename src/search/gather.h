/* The frame around gathering techniques: one full-screen pass, or two at reduced resolution. */
#ifndef PN_SEARCH_GATHER_H
#define PN_SEARCH_GATHER_H

#include "maps/maps.h"
#include "pair.h"
#include "receiver/receiver.h"

typedef struct {
  pni_gpu *gpu;
  const char *shader;  /* the technique's, with pn_technique() */
  const char *defines; /* and what it depends on */
  bool searches;       /* it tells what its search did, when debugging */
  const pni_frame *frame;
  pni_maps *maps;
  pn_receiver *receiver;
  pni_pair *pair;
  pni_attachment target;
} pni_gathering;

pn_result pni_gather(const pni_gathering *gathering);
/* Compiles for receivers as most hosts set them: with and without normals, full resolution. */
pn_result pni_gather_prepare(pni_gpu *gpu, const char *shader, const char *defines);

#endif
