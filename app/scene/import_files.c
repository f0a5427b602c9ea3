#include "scene/import_files.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *name_of(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

/* -1 and errno, or refused. O_NONBLOCK: opening a FIFO would wait for somebody who writes. */
static int open_regular(const struct importer *importer, const char *path, struct stat *info) {
  int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return -1;
  if (fstat(fd, info) == 0 && S_ISREG(info->st_mode)) return fd;
  int folder = S_ISDIR(info->st_mode);
  close(fd);
  errno = EISDIR;
  if (!folder) refuse(importer, "refers to %.200s, which is not a regular file", name_of(path));
  return -1;
}

static int hex_digit(char c) {
  static const char digits[] = "0123456789abcdef";
  const char *at = c ? strchr(digits, tolower((unsigned char)c)) : NULL;
  return at ? (int)(at - digits) : -1;
}

void decode_uri(char *text) {
  char *out = text;
  for (const char *in = text; *in; in++) {
    int high = *in == '%' ? hex_digit(in[1]) : -1, low = high >= 0 ? hex_digit(in[2]) : -1;
    if (low >= 0 && high + low > 0) { /* never an end of the text */
      *out++ = (char)(16 * high + low);
      in += 2;
    } else {
      *out++ = *in == '\\' ? '/' : *in;
    }
  }
  *out = 0;
}

/* Fewer than size where the file is shorter. */
static size_t read_up_to(int fd, char *out, size_t size) {
  size_t done = 0;
  while (done < size) {
    ssize_t n = read(fd, out + done, size - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    done += (size_t)n;
  }
  close(fd);
  return done;
}

void *read_file(const struct importer *importer, const char *path, size_t *size) {
  struct stat info;
  int fd = open_regular(importer, path, &info);
  if (fd < 0) return NULL;
  char *bytes = import_memory((size_t)info.st_size, 1);
  *size = read_up_to(fd, bytes, (size_t)info.st_size);
  return bytes;
}

size_t read_head(const struct importer *importer, const char *path, char *out, size_t room) {
  struct stat info;
  int fd = open_regular(importer, path, &info);
  size_t size = fd < 0 ? 0 : read_up_to(fd, out, room);
  out[size] = 0;
  return size;
}

void *read_beside(const struct importer *importer, const char *name, size_t *size) {
  const char *slash = strrchr(importer->path, '/');
  int folder = slash && name[0] != '/' ? (int)(slash - importer->path) + 1 : 0;
  char path[PATH_MAX];
  if (snprintf(path, sizeof path, "%.*s%s", folder, importer->path, name) >= (int)sizeof path) {
    errno = ENAMETOOLONG;
    return NULL;
  }
  void *bytes = read_file(importer, path, size);
  if (bytes) return bytes;
  decode_uri(path + folder);
  return read_file(importer, path, size);
}

/* ---- for Assimp -------------------------------------------------------------------------------------------------- */

struct opened {
  struct aiFile file;
  FILE *stream;
  size_t start, size; /* the mark before the text; what follows */
  int to_small;
};

static char missing_library[128];

const char *import_files_missing(void) { return missing_library; }

static size_t read_opened(struct aiFile *file, char *out, size_t element, size_t count) {
  struct opened *o = (struct opened *)file->UserData;
  size_t got = fread(out, element, count, o->stream);
  for (size_t i = 0; o->to_small && i < got * element; i++) out[i] = (char)tolower((unsigned char)out[i]);
  return got;
}

static size_t write_opened(struct aiFile *file, const char *bytes, size_t element, size_t count) {
  (void)file, (void)bytes, (void)element, (void)count;
  return 0;
}

static size_t tell_opened(struct aiFile *file) {
  struct opened *o = (struct opened *)file->UserData;
  return (size_t)ftell(o->stream) - o->start;
}

static size_t size_opened(struct aiFile *file) { return ((struct opened *)file->UserData)->size; }

static void flush_opened(struct aiFile *file) { (void)file; }

static enum aiReturn seek_opened(struct aiFile *file, size_t offset, enum aiOrigin origin) {
  struct opened *o = (struct opened *)file->UserData;
  int whence = origin == aiOrigin_SET ? SEEK_SET : origin == aiOrigin_CUR ? SEEK_CUR : SEEK_END;
  if (whence == SEEK_SET) offset += o->start;
  return fseek(o->stream, (long)offset, whence) == 0 ? aiReturn_SUCCESS : aiReturn_FAILURE;
}

/* Starts with "solid" in whatever letters, and its length is not what a binary STL of so many triangles has. */
static int is_text_stl(const unsigned char *head, size_t got, size_t size) {
  size_t at = 0;
  while (at < got && isspace(head[at])) at++;
  if (got - at < 6 || strncasecmp((const char *)head + at, "solid", 5) != 0 || !isspace(head[at + 5])) return 0;
  if (got < 84) return 1;
  uint64_t triangles = head[80] | (uint64_t)head[81] << 8 | (uint64_t)head[82] << 16 | (uint64_t)head[83] << 24;
  return size != 84 + 50 * triangles;
}

static int has_ending(const char *path, const char *ending) {
  size_t length = strlen(path), wanted = strlen(ending);
  return length >= wanted && strcasecmp(path + length - wanted, ending) == 0;
}

static void look_at_head(struct opened *o, const char *path) {
  unsigned char head[84];
  size_t got = fread(head, 1, sizeof head, o->stream);
  if (got >= 3 && memcmp(head, "\xef\xbb\xbf", 3) == 0) o->start = 3;
  o->size -= o->start;
  o->to_small = has_ending(path, ".stl") && is_text_stl(head + o->start, got - o->start, o->size);
  fseek(o->stream, (long)o->start, SEEK_SET);
}

static struct aiFile *open_for_assimp(struct aiFileIO *io, const char *path, const char *mode) {
  const struct importer *importer = (const struct importer *)io->UserData;
  struct stat info;
  if (strpbrk(mode, "wa+")) return NULL;
  int fd = open_regular(importer, path, &info);
  char decoded[PATH_MAX];
  if (fd < 0 && snprintf(decoded, sizeof decoded, "%s", path) < (int)sizeof decoded) {
    decode_uri(decoded);
    if (strcmp(decoded, path) != 0) fd = open_regular(importer, decoded, &info);
  }
  if (fd < 0) {
    if (has_ending(path, ".mtl") && !*missing_library)
      snprintf(missing_library, sizeof missing_library, "%.120s", name_of(path));
    return NULL;
  }
  if (has_ending(path, ".mtl")) missing_library[0] = 0;
  struct opened *o = import_memory(1, sizeof *o);
  o->stream = fdopen(fd, "rb");
  if (!o->stream) _exit(1);
  o->size = (size_t)info.st_size;
  look_at_head(o, path);
  o->file = (struct aiFile){.ReadProc = read_opened,
                            .WriteProc = write_opened,
                            .TellProc = tell_opened,
                            .FileSizeProc = size_opened,
                            .SeekProc = seek_opened,
                            .FlushProc = flush_opened,
                            .UserData = (char *)o};
  return &o->file;
}

static void close_for_assimp(struct aiFileIO *io, struct aiFile *file) {
  struct opened *o = (struct opened *)file->UserData;
  (void)io;
  fclose(o->stream);
  free(o);
}

struct aiFileIO import_files(struct importer *importer) {
  return (struct aiFileIO){.OpenProc = open_for_assimp, .CloseProc = close_for_assimp, .UserData = (char *)importer};
}
