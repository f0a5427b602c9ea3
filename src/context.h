/* The objects of the public header, as the library sees them. */
#ifndef PN_CONTEXT_H
#define PN_CONTEXT_H

#include "gl/clock.h"
#include "gl/state.h"
#include "gl/target.h"

/* Every object is in its context's list, and knows how it is freed, so that the context can free them all. */
typedef struct pni_object {
  pn_context *context;
  void (*free)(struct pni_object *object, bool abandon); /* abandon: without GL */
  struct pni_object *previous, *next;
} pni_object;

typedef struct pni_forward_text {
  char *key, *text;
  struct pni_forward_text *next;
} pni_forward_text;

struct pn_context {
  pni_gpu gpu;
  pni_object *objects;
  bool scope;         /* between pn_state_begin and pn_state_end */
  pni_gl_state saved; /* the host's state, while the library is at work */
  struct pni_pair *pairs;
  pni_forward_text *forward_texts;
  pni_buffer forward_block;
};

/* Every public function that touches GL does so between these two. pni_leave returns result, so that a function ends
 * in one line. */
void pni_enter(pn_context *context);
pn_result pni_leave(pn_context *context, pn_result result);

/* Zeroed; NULL after a message. */
void *pni_object_create(pn_context *context, void (*release)(pni_object *, bool), size_t bytes);
void pni_object_unlink(pni_object *object);

#endif
