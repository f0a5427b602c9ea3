/* The context, and what all objects of the public header have in common. */
#ifndef PNI_CONTEXT_H
#define PNI_CONTEXT_H

#include "gl/buffer.h"
#include "gl/state.h"

/* Every object is in its context's list, and knows how it is freed, so that the context can free them all. */
typedef struct pni_object {
  pn_context *context;
  uint64_t serial; /* no other object of the context ever has the same */
  /* Frees what the object holds, not itself; abandon: without GL. */
  void (*release)(struct pni_object *object, bool abandon);
  struct pni_object *needs[2]; /* objects that it is freed before */
  struct pni_object *previous, *next;
} pni_object;

typedef struct pni_forward_text {
  char *key, *text;
  struct pni_forward_text *next;
} pni_forward_text;

struct pn_context {
  pni_gpu gpu;
  pni_object *objects;
  uint64_t serial;    /* the last one given */
  bool scope;         /* between pn_state_begin and pn_state_end */
  pni_host_state saved; /* the host's state, while the library is at work */
  pni_forward_text *forward_texts;
  pni_buffer forward_block;
};

/* Every public function that touches GL does so between these two. pni_leave returns result, so that a function ends
 * in one line. */
void pni_enter(pn_context *context);
pn_result pni_leave(pn_context *context, pn_result result);

/* Zeroed; NULL after a message. */
void *pni_object_create(pn_context *context, void (*release)(pni_object *, bool), size_t bytes);
/* The object and what needs it. */
void pni_object_free(pni_object *object, bool abandon);
/* What pn_..._destroy does: the object and what needs it, with the host's GL state kept. NULL is fine. */
void pni_object_destroy(pni_object *object);
/* NULL: it has been freed. */
pni_object *pni_object_find(const pn_context *context, uint64_t serial);

#endif
