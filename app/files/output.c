#define _GNU_SOURCE
#include "files/output.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/interrupt.h"
#include "base/message.h"

int output_is_standard(const char *path) { return path && strcmp(path, "-") == 0; }

static void forget(struct output *output) {
  if (output->temporary) interrupt_forget_file(output->temporary);
  free(output->temporary);
  free(output->target);
  free(output->path);
  memset(output, 0, sizeof *output);
}

/* The name beside target under which it is written. */
static char *temporary_name(const char *target) {
  const char *slash = strrchr(target, '/');
  int folder = slash ? (int)(slash - target) + 1 : 0;
  char *name = NULL;
  if (asprintf(&name, "%.*s.%.200s.XXXXXX", folder, target, target + folder) < 0) return NULL;
  return name;
}

/* The absolute name of a folder, of which the last parts need not exist. NULL and errno where the working directory was
 * deleted. */
static char *resolve_folder(const char *folder) {
  char *whole = realpath(folder, NULL);
  if (whole || errno == ENOMEM || strcmp(folder, ".") == 0) return whole;
  size_t length = strlen(folder);
  while (length > 1 && folder[length - 1] == '/') length--;
  size_t stem = length;
  while (stem && folder[stem - 1] != '/') stem--;
  char *parent = stem ? strndup(folder, stem) : strdup("."), *above = NULL;
  if (parent && stem < length) above = resolve_folder(parent);
  if (above && asprintf(&whole, "%s/%.*s", above, (int)(length - stem), folder + stem) < 0) whole = NULL;
  free(parent);
  free(above);
  return whole;
}

/* What a symbolic link says, seen from where the link is; NULL: path is no link. */
static char *read_link(const char *path) {
  char text[4096], *whole = NULL;
  ssize_t length = readlink(path, text, sizeof text - 1);
  if (length <= 0) return NULL;
  text[length] = 0;
  const char *slash = strrchr(path, '/');
  int folder = slash && *text != '/' ? (int)(slash - path) + 1 : 0;
  return asprintf(&whole, "%.*s%s", folder, path, text) < 0 ? NULL : whole;
}

char *output_target(const char *path) {
  enum { LINKS_MAX = 40 };
  char *at = strdup(path), *whole = NULL;
  for (int i = 0; at; i++) {
    char *next = read_link(at);
    if (!next) break;
    free(at);
    at = i < LINKS_MAX ? next : NULL;
    if (!at) free(next);
    if (!at) errno = ELOOP;
  }
  if (!at) return NULL;
  char *slash = strrchr(at, '/'), *folder = slash ? strndup(at, (size_t)(slash - at) + 1) : strdup(".");
  char *above = folder ? resolve_folder(folder) : NULL;
  if (above && asprintf(&whole, "%s/%s", above, slash ? slash + 1 : at) < 0) whole = NULL;
  free(folder);
  free(above);
  free(at);
  return whole;
}

static int open_temporary(struct output *output) {
  int fd = mkstemp(output->temporary);
  if (fd < 0) return -1;
  interrupt_watch_file(output->temporary);
  mode_t mask = umask(0);
  umask(mask);
  fchmod(fd, 0666 & ~mask);
  output->file = fdopen(fd, "wb");
  if (output->file) return 0;
  close(fd);
  unlink(output->temporary);
  return -1;
}

/* A device or a FIFO, written to as it is. A FIFO that nobody reads would wait for ever. */
static FILE *open_special(const char *path) {
  int fd = open(path, O_WRONLY | O_NONBLOCK | O_CLOEXEC);
  FILE *file = fd < 0 ? NULL : fdopen(fd, "wb");
  if (file) fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) & ~O_NONBLOCK);
  else if (fd >= 0) close(fd);
  return file;
}

int output_open(struct output *output, const char *path) {
  memset(output, 0, sizeof *output);
  output->path = strdup(path);
  if (!output->path) return memory_error();
  struct stat info;
  int exists = !output_is_standard(path) && stat(path, &info) == 0;
  if (output_is_standard(path)) {
    output->file = stdout;
    return STATUS_OK;
  }
  if (exists && S_ISDIR(info.st_mode)) {
    errno = EISDIR;
  } else if (exists && !S_ISREG(info.st_mode)) {
    output->file = open_special(path);
    if (output->file) return STATUS_OK;
  } else {
    output->target = output_target(path);
    output->temporary = output->target ? temporary_name(output->target) : NULL;
    if (output->temporary && open_temporary(output) == 0) return STATUS_OK;
  }
  const char *reason = errno == ENXIO ? "nobody reads from it" : strerror(errno);
  int status = work_error("cannot write %s: %s", path, reason);
  forget(output);
  return status;
}

void output_abort(struct output *output) {
  if (output->file && output->file != stdout) fclose(output->file);
  if (output->temporary) unlink(output->temporary);
  forget(output);
}

int output_fail(struct output *output, const char *reason) {
  int status = work_error("cannot write %s: %s", output->path, reason ? reason : strerror(errno));
  output_abort(output);
  return status;
}

int output_commit(struct output *output) {
  if (fflush(output->file) != 0 || ferror(output->file)) return output_fail(output, NULL);
  if (output->temporary && fsync(fileno(output->file)) != 0) return output_fail(output, NULL);
  if (output->file != stdout) {
    FILE *file = output->file;
    output->file = NULL;
    if (fclose(file) != 0) return output_fail(output, NULL);
  }
  if (output->temporary && rename(output->temporary, output->target) != 0) return output_fail(output, NULL);
  forget(output);
  return STATUS_OK;
}

int output_write_file(const char *path, const void *bytes, size_t size) {
  struct output output;
  int status = output_open(&output, path);
  if (status) return status;
  if (fwrite(bytes, 1, size, output.file) != size) return output_fail(&output, NULL);
  return output_commit(&output);
}

int output_check(const char *path) {
  if (output_is_standard(path)) return STATUS_OK;
  struct stat info;
  if (stat(path, &info) == 0) {
    if (S_ISDIR(info.st_mode)) return work_error("cannot write %s: it is a directory", path);
    if (!S_ISREG(info.st_mode)) return STATUS_OK;
  }
  const char *slash = strrchr(path, '/');
  char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
  if (!folder) return memory_error();
  int status = STATUS_OK;
  if (slash && !slash[1]) status = work_error("cannot write %s: it names a directory", path);
  else if (access(folder, W_OK | X_OK) != 0) status = work_error("cannot write %s: %s", path, strerror(errno));
  free(folder);
  return status;
}
