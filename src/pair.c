#include "pair.h"

#include <string.h>

pni_pair *pni_pair_find(const pni_object *light, const pni_object *receiver) {
  for (pni_pair *pair = light->context->pairs; pair; pair = pair->next)
    if (pair->light == light && pair->receiver == receiver) return pair;
  return NULL;
}

pni_pair *pni_pair_get(pni_object *light, pni_object *receiver) {
  pni_pair *pair = pni_pair_find(light, receiver);
  if (pair) return pair;
  pn_context *context = light->context;
  pair = pni_allocate_zero(&context->gpu, sizeof *pair);
  if (!pair) return NULL;
  pair->light = light;
  pair->receiver = receiver;
  pair->next = context->pairs;
  context->pairs = pair;
  return pair;
}

static void free_work(pni_gpu *gpu, pni_pair *pair, bool abandon) {
  pni_texture_free(gpu, &pair->search, abandon);
  pni_texture_free(gpu, &pair->covered, abandon);
  pni_texture_free(gpu, &pair->bound, abandon);
  for (int i = 0; i < PNI_WORK_MAX; i++) pni_texture_free(gpu, &pair->work[i], abandon);
  pni_receiver_map_free(gpu, &pair->seen, abandon);
  pni_buffer_free(gpu, &pair->arguments, abandon);
}

void pni_pair_begin(pni_gpu *gpu, pni_pair *pair, const void *technique) {
  if (pair->technique != technique) {
    free_work(gpu, pair, false);
    pair->warned = false;
    pair->technique = technique;
  }
  memset(&pair->soft, 0, sizeof pair->soft);
}

static void free_pair(pni_gpu *gpu, pni_pair *pair, bool abandon) {
  free_work(gpu, pair, abandon);
  pni_texture_free(gpu, &pair->image, abandon);
  pni_texture_free(gpu, &pair->low, abandon);
  pni_clock_free(gpu, &pair->clock, abandon);
  pni_free(gpu, pair);
}

void pni_pairs_drop(const pni_object *object, bool abandon) {
  for (pni_pair **link = &object->context->pairs; *link;) {
    pni_pair *pair = *link;
    if (pair->light != object && pair->receiver != object) {
      link = &pair->next;
      continue;
    }
    *link = pair->next;
    free_pair(&object->context->gpu, pair, abandon);
  }
}
