/* A growing string. */
#ifndef PNI_GL_TEXT_H
#define PNI_GL_TEXT_H

#include "gl/gpu.h"

typedef struct {
  pni_gpu *gpu;
  char *bytes; /* always terminated once something was added; pni_free frees it */
  size_t length, capacity;
  bool failed; /* out of memory: every further addition does nothing */
} pni_text;

void pni_text_add(pni_text *text, const char *bytes, size_t length);
void pni_text_format(pni_text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
