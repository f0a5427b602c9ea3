#include "gl/source.h"

#include <stdio.h>
#include <string.h>

#include "gl/embedded.h"
#include "gl/host.h"
#include "gl/text.h"

/* ---- sources: embedded, or files of the host's directory --------------------------------------------------------- */

static const char *embedded_source(const char *path) {
  for (int i = 0; i < pni_embedded_shader_count; i++)
    if (!strcmp(pni_embedded_shaders[i].path, path)) return pni_embedded_shaders[i].text;
  return NULL;
}

static bool read_file(pni_gpu *gpu, const char *path, pni_text *out) {
  char full[4096];
  if (snprintf(full, sizeof full, "%s/%s", gpu->shader_directory, path) >= (int)sizeof full) return false;
  FILE *file = fopen(full, "rb");
  if (!file) return false;
  char block[4096];
  size_t length;
  while ((length = fread(block, 1, sizeof block, file)) > 0) pni_text_add(out, block, length);
  bool whole = !ferror(file);
  fclose(file);
  return whole && out->bytes;
}

/* A file missing from the directory is taken from the embedded ones, so that a directory may hold just the files
 * being edited. */
static const char *source(pni_gpu *gpu, const char *path, pni_text *storage) {
  if (gpu->shader_directory && read_file(gpu, path, storage)) return storage->bytes;
  return embedded_source(path);
}

/* ---- includes ---------------------------------------------------------------------------------------------------- */

enum { INCLUDES_MAX = 64 };

typedef struct {
  pni_gpu *gpu;
  pni_text text;
  char seen[INCLUDES_MAX][96];
  int seen_count;
} assembly;

/* There is room for it: add_file saw to that. */
static bool first_time(assembly *a, const char *path) {
  for (int i = 0; i < a->seen_count; i++)
    if (!strcmp(a->seen[i], path)) return false;
  snprintf(a->seen[a->seen_count++], sizeof a->seen[0], "%s", path);
  return true;
}

/* The path of a line `#include "path"`, or false. */
static bool include_path(const char *line, size_t length, char path[96]) {
  static const char directive[] = "#include \"";
  size_t head = sizeof directive - 1;
  if (length <= head || strncmp(line, directive, head)) return false;
  const char *close = memchr(line + head, '"', length - head);
  if (!close || (size_t)(close - line) - head >= 96) return false;
  memcpy(path, line + head, (size_t)(close - line) - head);
  path[(size_t)(close - line) - head] = 0;
  return true;
}

static pn_result add_file(assembly *a, const char *path, const char *from) {
  if (a->seen_count == INCLUDES_MAX)
    return pni_fail(a->gpu, PN_ERROR_SHADER, PN_MESSAGE_SHADER_MISSING, "a shader of more than %d files", INCLUDES_MAX);
  if (!first_time(a, path)) return PN_OK;
  pni_text storage = {.gpu = a->gpu};
  const char *text = source(a->gpu, path, &storage);
  pn_result result = PN_OK;
  if (!text)
    result = pni_fail(a->gpu, PN_ERROR_SHADER, PN_MESSAGE_SHADER_MISSING, "shader %s, wanted by %s, does not exist",
                      path, from);
  for (const char *line = text; result == PN_OK && line && *line;) {
    const char *end = strchr(line, '\n');
    size_t length = end ? (size_t)(end - line) + 1 : strlen(line);
    char included[96];
    if (include_path(line, length, included)) result = add_file(a, included, path);
    else pni_text_add(&a->text, line, length);
    line += length;
  }
  pni_free(a->gpu, storage.bytes);
  return result;
}

static void add_defines(pni_text *text, const char *defines) {
  for (const char *line = defines; line && *line;) {
    const char *end = strchr(line, '\n');
    size_t length = end ? (size_t)(end - line) : strlen(line);
    pni_text_add(text, "#define ", 8);
    pni_text_add(text, line, length);
    pni_text_add(text, "\n", 1);
    line += length + (end ? 1 : 0);
  }
}

/* So that debuggers and drivers' messages tell which text this is. */
static void add_heading(pni_text *text, const char *const *paths, const char *defines) {
  pni_text_format(text, "// penumbra:");
  for (; *paths; paths++) pni_text_format(text, " %s", *paths);
  for (const char *line = defines; *line; line += strcspn(line, "\n"), line += *line == '\n')
    pni_text_format(text, "%s%.*s", line == defines ? "; " : ", ", (int)strcspn(line, "\n"), line);
  pni_text_add(text, "\n", 1);
}

pn_result pni_shader_text(pni_gpu *gpu, const char *const *paths, const char *defines, char **out) {
  assembly a = {.gpu = gpu, .text = {.gpu = gpu}};
  add_heading(&a.text, paths, defines);
  add_defines(&a.text, defines);
  pn_result result = PN_OK;
  for (; *paths && result == PN_OK; paths++) result = add_file(&a, *paths, "the library");
  if (result == PN_OK && a.text.failed) result = PN_ERROR_OUT_OF_MEMORY;
  if (result == PN_OK) *out = a.text.bytes;
  else pni_free(gpu, a.text.bytes);
  return result;
}
