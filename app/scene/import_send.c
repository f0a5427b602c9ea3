#include "scene/import_send.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void send_bytes(int fd, const void *bytes, size_t size) {
  for (size_t done = 0; done < size;) {
    ssize_t n = write(fd, (const char *)bytes + done, size - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) _exit(1);
    done += (size_t)n;
  }
}

static void send_line(int fd, enum record_tag tag, const char *format, va_list arguments) {
  char text[400];
  vsnprintf(text, sizeof text, format, arguments);
  struct record r = {.tag = tag, .text_size = (uint32_t)strlen(text)};
  send_bytes(fd, &r, sizeof r);
  send_bytes(fd, text, r.text_size);
}

void send_text(int fd, enum record_tag tag, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  send_line(fd, tag, format, arguments);
  va_end(arguments);
}

void refuse(const struct importer *importer, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  send_line(importer->fd, RECORD_ERROR, format, arguments);
  va_end(arguments);
  _exit(0);
}

void *import_memory(size_t count, size_t element) {
  void *memory = count < SIZE_MAX / element - 1 ? calloc(count + 1, element) : NULL;
  if (!memory) _exit(1);
  return memory;
}
