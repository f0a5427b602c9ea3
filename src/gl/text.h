/* A growing string. */
#ifndef PN_GL_TEXT_H
#define PN_GL_TEXT_H

#include "gl/gpu.h"

typedef struct {
  pn_gpu *gpu;
  char *bytes; /* always terminated once something was added; pn_free frees it */
  size_t length, capacity;
  bool failed; /* out of memory: every further addition does nothing */
} pn_text;

void pn_text_add(pn_text *text, const char *bytes, size_t length);
void pn_text_format(pn_text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
