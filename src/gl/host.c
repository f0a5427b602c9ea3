#include "gl/host.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *pni_reallocate(pni_gpu *gpu, void *old, size_t bytes) {
  void *memory = gpu->desc.allocate ? gpu->desc.allocate(gpu->desc.user, old, bytes) : realloc(old, bytes);
  if (!memory && bytes)
    pni_fail(gpu, PN_ERROR_OUT_OF_MEMORY, PN_MESSAGE_OUT_OF_MEMORY, "no memory for %zu bytes", bytes);
  return memory;
}

void *pni_allocate_zero(pni_gpu *gpu, size_t bytes) {
  void *memory = pni_reallocate(gpu, NULL, bytes ? bytes : 1);
  if (memory) memset(memory, 0, bytes);
  return memory;
}

void pni_free(pni_gpu *gpu, void *memory) {
  if (!memory) return;
  if (gpu->desc.allocate) gpu->desc.allocate(gpu->desc.user, memory, 0);
  else free(memory);
}

static void send(pni_gpu *gpu, pn_log_level level, pn_message message, const char *format, va_list arguments) {
  if (!gpu->desc.log || (gpu->only_errors && level != PN_LOG_ERROR)) return;
  char text[1024];
  vsnprintf(text, sizeof text, format, arguments);
  for (char *c = text; *c; c++)
    if (*c == '\n' || *c == '\r') *c = ' '; /* one line, whatever a driver wrote */
  gpu->desc.log(gpu->desc.user, level, (int)message, text);
}

pn_result pni_fail(pni_gpu *gpu, pn_result result, pn_message message, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  send(gpu, PN_LOG_ERROR, message, format, arguments);
  va_end(arguments);
  return result;
}

void pni_note(pni_gpu *gpu, pn_log_level level, pn_message message, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  send(gpu, level, message, format, arguments);
  va_end(arguments);
}
