#include "gl/text.h"

#include "gl/host.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void pni_text_add(pni_text *text, const char *bytes, size_t length) {
  if (text->failed) return;
  if (text->length + length + 1 > text->capacity) {
    size_t capacity = text->capacity * 2 + length + 256;
    char *grown = pni_reallocate(text->gpu, text->bytes, capacity);
    if (!grown) {
      text->failed = true;
      return;
    }
    text->bytes = grown;
    text->capacity = capacity;
  }
  memcpy(text->bytes + text->length, bytes, length);
  text->length += length;
  text->bytes[text->length] = 0;
}

void pni_text_format(pni_text *text, const char *format, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, format);
  int length = vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  if (length > 0) pni_text_add(text, line, length < (int)sizeof line ? (size_t)length : sizeof line - 1);
}
