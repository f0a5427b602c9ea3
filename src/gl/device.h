/* The GL context looked over at first, and closed at last. */
#ifndef PNI_GL_DEVICE_H
#define PNI_GL_DEVICE_H

#include "gl/gpu.h"

/* Finds functions and capabilities and makes the shared objects. On failure everything is undone. */
pn_result pni_gpu_open(pni_gpu *gpu, const pn_context_desc *desc);
/* abandon: free memory without a GL call. */
void pni_gpu_close(pni_gpu *gpu, bool abandon);

/* PN_ERROR_CONTEXT_LOST, with a message, when the GL context was reset, as far as the device tells. */
pn_result pni_gpu_check_lost(pni_gpu *gpu);

/* GL's own strings, valid as long as the context. */
void pni_gpu_names(pni_gpu *gpu, const char **vendor, const char **renderer, const char **version);

#endif
