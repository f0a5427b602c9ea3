#include "pair.h"

#include <string.h>

pn_pair *pn_pair_find(const pn_object *light, const pn_object *receiver) {
  for (pn_pair *pair = light->context->pairs; pair; pair = pair->next)
    if (pair->light == light && pair->receiver == receiver) return pair;
  return NULL;
}

pn_pair *pn_pair_get(pn_object *light, pn_object *receiver) {
  pn_pair *pair = pn_pair_find(light, receiver);
  if (pair) return pair;
  pn_context *context = light->context;
  pair = pn_allocate_zero(&context->gpu, sizeof *pair);
  if (!pair) return NULL;
  pair->light = light;
  pair->receiver = receiver;
  pair->next = context->pairs;
  context->pairs = pair;
  return pair;
}

static void free_work(pn_gpu *gpu, pn_pair *pair, bool abandon) {
  pn_texture_free(gpu, &pair->search, abandon);
  pn_texture_free(gpu, &pair->covered, abandon);
  pn_texture_free(gpu, &pair->bound, abandon);
  for (int i = 0; i < PN_WORK_MAX; i++) pn_texture_free(gpu, &pair->work[i], abandon);
  pn_receiver_map_free(gpu, &pair->seen, abandon);
  pn_buffer_free(gpu, &pair->arguments, abandon);
}

void pn_pair_begin(pn_gpu *gpu, pn_pair *pair, const void *technique) {
  if (pair->technique != technique) {
    free_work(gpu, pair, false);
    pair->warned = false;
    pair->technique = technique;
  }
  memset(&pair->soft, 0, sizeof pair->soft);
}

static void free_pair(pn_gpu *gpu, pn_pair *pair, bool abandon) {
  free_work(gpu, pair, abandon);
  pn_texture_free(gpu, &pair->image, abandon);
  pn_texture_free(gpu, &pair->low, abandon);
  pn_clock_free(gpu, &pair->clock, abandon);
  pn_free(gpu, pair);
}

void pn_pairs_drop(const pn_object *object, bool abandon) {
  for (pn_pair **link = &object->context->pairs; *link;) {
    pn_pair *pair = *link;
    if (pair->light != object && pair->receiver != object) {
      link = &pair->next;
      continue;
    }
    *link = pair->next;
    free_pair(&object->context->gpu, pair, abandon);
  }
}
