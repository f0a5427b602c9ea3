/* The host's callbacks: memory and messages. */
#ifndef PNI_GL_HOST_H
#define PNI_GL_HOST_H

#include "gl/gpu.h"

/* Memory from the host's allocator. */
void *pni_reallocate(pni_gpu *gpu, void *old, size_t bytes); /* NULL when out of memory, after a message */
void *pni_allocate_zero(pni_gpu *gpu, size_t bytes);
void pni_free(pni_gpu *gpu, void *memory);

/* Sends a message to the host. Returns result, so that a failure is one line: return pni_fail(...). */
pn_result pni_fail(pni_gpu *gpu, pn_result result, pn_message message, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
void pni_note(pni_gpu *gpu, pn_log_level level, pn_message message, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
