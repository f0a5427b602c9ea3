#include "context.h"

#include <stdlib.h>
#include <string.h>

#include "gl/bound.h"
#include "gl/device.h"
#include "gl/host.h"
#include "gl/label.h"
#include "gl/program.h"

/* ---- creation ---------------------------------------------------------------------------------------------------- */

pn_result pn_context_create(const pn_context_desc *desc, pn_context **out) {
  if (!out) {
    if (desc && desc->log)
      desc->log(desc->user, PN_LOG_ERROR, PN_MESSAGE_NULL_ARGUMENT, "pn_context_create: out is NULL");
    return PN_ERROR_ARGUMENT;
  }
  *out = NULL;
  void *(*allocate)(void *, void *, size_t) = desc ? desc->allocate : NULL;
  pn_context *context = allocate ? allocate(desc->user, NULL, sizeof *context) : malloc(sizeof *context);
  if (!context) {
    if (desc && desc->log) desc->log(desc->user, PN_LOG_ERROR, PN_MESSAGE_OUT_OF_MEMORY, "no memory for a context");
    return PN_ERROR_OUT_OF_MEMORY;
  }
  memset(context, 0, sizeof *context);
  pn_result result = pni_gpu_open(&context->gpu, desc);
  if (result != PN_OK) {
    pni_gpu gpu = context->gpu;
    pni_free(&gpu, context);
    return result;
  }
  *out = context;
  return PN_OK;
}

static void free_forward_texts(pn_context *context) {
  while (context->forward_texts) {
    pni_forward_text *text = context->forward_texts;
    context->forward_texts = text->next;
    pni_free(&context->gpu, text->key);
    pni_free(&context->gpu, text->text);
    pni_free(&context->gpu, text);
  }
}

static void close_context(pn_context **handle, bool abandon) {
  if (!handle || !*handle) return;
  pn_context *context = *handle;
  *handle = NULL;
  while (context->objects) pni_object_free(context->objects, abandon);
  free_forward_texts(context);
  pni_buffer_free(&context->gpu, &context->forward_block, abandon);
  pni_gpu_close(&context->gpu, abandon);
  pni_gpu gpu = context->gpu; /* the allocator outlives the memory it frees */
  pni_free(&gpu, context);
}

void pn_context_destroy(pn_context **context) { close_context(context, false); }

void pn_context_abandon(pn_context **context) { close_context(context, true); }

/* ---- objects ----------------------------------------------------------------------------------------------------- */

void *pni_object_create(pn_context *context, void (*release)(pni_object *, bool), size_t bytes) {
  pni_object *object = pni_allocate_zero(&context->gpu, bytes);
  if (!object) return NULL;
  object->release = release;
  object->context = context;
  object->serial = ++context->serial;
  object->next = context->objects;
  if (object->next) object->next->previous = object;
  context->objects = object;
  return object;
}

static void unlink_object(pni_object *object) {
  if (object->next) object->next->previous = object->previous;
  if (object->previous) object->previous->next = object->next;
  else object->context->objects = object->next;
}

/* What needs the object needs nothing else's help to go, so that one step down is enough. */
static void free_dependants(pni_object *object, bool abandon) {
  for (pni_object *o = object->context->objects, *next; o; o = next) {
    next = o->next;
    if (o->needs[0] == object || o->needs[1] == object) pni_object_free(o, abandon);
  }
}

void pni_object_free(pni_object *object, bool abandon) {
  if (!object->needs[0]) free_dependants(object, abandon);
  object->release(object, abandon);
  unlink_object(object);
  pni_free(&object->context->gpu, object);
}

void pni_object_destroy(pni_object *object) {
  if (!object) return;
  pn_context *context = object->context;
  pni_enter(context);
  pni_object_free(object, false);
  pni_leave(context, PN_OK);
}

pni_object *pni_object_find(const pn_context *context, uint64_t serial) {
  pni_object *object = context->objects;
  while (object && object->serial != serial) object = object->next;
  return object;
}

/* ---- the host's GL state ----------------------------------------------------------------------------------------- */

void pni_enter(pn_context *context) {
  pni_forget(&context->gpu);
  if (context->gpu.desc.state == PN_STATE_RESTORE) pni_state_save(&context->gpu, &context->saved);
  else pni_find_group_room(&context->gpu); /* the one thing that is read: a full stack would be an error */
}

pn_result pni_leave(pn_context *context, pn_result result) {
  pni_group(&context->gpu, NULL);
  /* After a callback of the host's nothing of what was read need be so. */
  bool strange = context->gpu.host == NULL;
  if (context->gpu.desc.state == PN_STATE_RESTORE) pni_state_restore(&context->gpu, &context->saved, strange);
  if (context->gpu.desc.state == PN_STATE_RESET) pni_state_reset(&context->gpu);
  pni_forget(&context->gpu);
  return result;
}

static pn_result scope(pn_context *context, bool begin) {
  if (!context) return PN_ERROR_ARGUMENT;
  if (context->gpu.desc.state != PN_STATE_SCOPED) return PN_OK;
  if (context->scope == begin)
    return pni_fail(&context->gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_STATE_SCOPE, "%s",
                    begin ? "pn_state_begin was called twice" : "pn_state_end without pn_state_begin");
  context->scope = begin;
  if (begin) pni_state_save(&context->gpu, &context->saved);
  else pni_state_restore(&context->gpu, &context->saved, true);
  return PN_OK;
}

pn_result pn_state_begin(pn_context *context) { return scope(context, true); }
pn_result pn_state_end(pn_context *context) { return scope(context, false); }

/* ---- questions and switches -------------------------------------------------------------------------------------- */

pn_result pn_reload_shaders(pn_context *context) {
  if (!context) return PN_ERROR_ARGUMENT;
  pni_programs_free(&context->gpu, false);
  return PN_OK;
}

pn_result pn_timing(pn_context *context, int enabled) {
  if (!context) return PN_ERROR_ARGUMENT;
  context->gpu.timing = enabled != 0;
  return PN_OK;
}

pn_result pn_debug(pn_context *context, int flags) {
  if (!context) return PN_ERROR_ARGUMENT;
  if (flags & ~(PN_DEBUG_SEARCH | PN_DEBUG_BOUND))
    return pni_fail(&context->gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_DEBUG_FLAGS, "debug flags 0x%x: only 0x%x are known",
                    (unsigned)flags, (unsigned)(PN_DEBUG_SEARCH | PN_DEBUG_BOUND));
  context->gpu.debug = flags;
  return PN_OK;
}

static int at_most(int value, int limit) { return value < limit ? value : limit; }

pn_result pn_context_info(const pn_context *context, pn_info *out) {
  if (!context || !out) return PN_ERROR_ARGUMENT;
  const pni_gpu *gpu = &context->gpu;
  *out = (pn_info){
      .gl_version = gpu->can.version,
      .software = gpu->can.software,
      .map_size_max = at_most(gpu->can.texture_size_max, PN_MAP_SIZE_MAX),
      .map_layers_max = gpu->can.layers_max,
      .gpu_memory = gpu->memory,
      .gl_calls = gpu->calls,
  };
  pni_gpu_names((pni_gpu *)gpu, &out->vendor, &out->renderer, &out->version);
  return PN_OK;
}

int pn_feature(const pn_context *context, int index, const char **name, int *in_use, const char **help) {
  static const struct {
    const char *name, *help;
  } features[] = {
      {"timestamps", "stage times from the GPU's own clock; without: glFinish and the system's clock"},
      {"clip_control", "saves and sets glClipControl; without: nothing to save"},
      {"labels", "GL objects and passes carry names for RenderDoc and apitrace; without: none"},
      {"robustness", "a lost context is noticed by its reset status; without: by failing calls"},
  };
  if (!context || index < 0 || index >= (int)(sizeof features / sizeof *features)) return 0;
  const pni_capabilities *can = &context->gpu.can;
  const int used[] = {!can->software, can->clip_control, can->labels, can->robustness};
  if (name) *name = features[index].name;
  if (in_use) *in_use = used[index];
  if (help) *help = features[index].help;
  return 1;
}
