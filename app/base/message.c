#include "base/message.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/progress.h"

static int verbose;

void message_set_verbose(int on) { verbose = on; }

/* Prints one line whole, in one write, so that lines of a child process never interleave. */
static void say(const char *kind, const char *format, va_list arguments) {
  char line[1024];
  int prefix = snprintf(line, sizeof line, "penumbra: %s", kind);
  vsnprintf(line + prefix, sizeof line - (size_t)prefix, format, arguments);
  for (char *c = line; *c; c++)
    if ((unsigned char)*c < 32 || *c == 127) *c = '?';
  progress_hide();
  fprintf(stderr, "%s\n", line);
}

int input_error(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  say("", format, arguments);
  va_end(arguments);
  return STATUS_INPUT;
}

int work_error(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  say("", format, arguments);
  va_end(arguments);
  return STATUS_FAILED;
}

int memory_error(void) { return work_error("out of memory"); }

void warning(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  say("warning: ", format, arguments);
  va_end(arguments);
}

void note(const char *format, ...) {
  if (!verbose) return;
  va_list arguments;
  va_start(arguments, format);
  say("", format, arguments);
  va_end(arguments);
}
