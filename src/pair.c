#include "pair.h"

static void release_pair(pni_object *object, bool abandon) {
  pni_pair *pair = (pni_pair *)object;
  pni_gpu *gpu = &object->context->gpu;
  pni_kept_free(gpu, &pair->kept, abandon);
  pni_texture_free(gpu, &pair->image, abandon);
  pni_texture_free(gpu, &pair->low, abandon);
  pni_texture_free(gpu, &pair->search, abandon);
  pni_texture_free(gpu, &pair->levels, abandon);
  pni_clock_free(gpu, &pair->clock, abandon);
}

pni_pair *pni_pair_of(pni_object *object, const pni_object *light) {
  return object->release == release_pair && object->needs[0] == light ? (pni_pair *)object : NULL;
}

pni_pair *pni_pair_find(const pni_object *light, const pni_object *receiver) {
  for (pni_object *o = light->context->objects; o; o = o->next) {
    pni_pair *pair = pni_pair_of(o, light);
    if (pair && o->needs[1] == receiver) return pair;
  }
  return NULL;
}

pni_pair *pni_pair_get(pni_object *light, pni_object *receiver) {
  pni_pair *pair = pni_pair_find(light, receiver);
  if (pair) return pair;
  pair = pni_object_create(light->context, release_pair, sizeof *pair);
  if (!pair) return NULL;
  pair->object.needs[0] = light;
  pair->object.needs[1] = receiver;
  return pair;
}
