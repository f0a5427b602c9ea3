#include "scene/import_send.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
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

void send_text(int fd, enum record_tag tag, const char *format, ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  struct record r = {.tag = tag, .text_size = (uint32_t)strlen(text)};
  send_bytes(fd, &r, sizeof r);
  send_bytes(fd, text, r.text_size);
}
