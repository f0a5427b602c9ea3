/* The objects of the public header, as the library sees them. */
#ifndef PN_CONTEXT_H
#define PN_CONTEXT_H

#include "gl/clock.h"
#include "gl/state.h"
#include "gl/target.h"

/* Every object is in its context's list, and knows how it is freed, so that the context can free them all. */
typedef struct pn_object {
  pn_context *context;
  void (*free)(struct pn_object *object, bool abandon); /* abandon: without GL */
  struct pn_object *previous, *next;
} pn_object;

typedef struct pn_forward_text {
  char *key, *text;
  struct pn_forward_text *next;
} pn_forward_text;

struct pn_context {
  pn_gpu gpu;
  pn_object *objects;
  bool scope;        /* between pn_state_begin and pn_state_end */
  pn_gl_state saved; /* the host's state, while the library is at work */
  struct pn_pair *pairs;
  pn_forward_text *forward_texts;
  pn_buffer forward_block;
};

/* Every public function that touches GL does so between these two. pn_leave returns result, so that a function ends
 * in one line. */
void pn_enter(pn_context *context);
pn_result pn_leave(pn_context *context, pn_result result);

/* Zeroed; NULL after a message. */
void *pn_object_create(pn_context *context, void (*release)(pn_object *, bool), size_t bytes);
void pn_object_unlink(pn_object *object);

#endif
