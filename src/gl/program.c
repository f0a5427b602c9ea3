#include "gl/program.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "gl/embedded.h"
#include "gl/state.h"
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

enum { INCLUDES_MAX = 32 };

typedef struct {
  pni_gpu *gpu;
  pni_text text;
  char seen[INCLUDES_MAX][96];
  int seen_count;
} assembly;

static bool first_time(assembly *a, const char *path) {
  for (int i = 0; i < a->seen_count; i++)
    if (!strcmp(a->seen[i], path)) return false;
  if (a->seen_count < INCLUDES_MAX) snprintf(a->seen[a->seen_count++], sizeof a->seen[0], "%s", path);
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

pn_result pni_shader_text(pni_gpu *gpu, const char *const *paths, const char *defines, char **out) {
  assembly a = {.gpu = gpu, .text = {.gpu = gpu}};
  add_defines(&a.text, defines);
  pn_result result = PN_OK;
  for (; *paths && result == PN_OK; paths++) result = add_file(&a, *paths, "the library");
  if (result == PN_OK && a.text.failed) result = PN_ERROR_OUT_OF_MEMORY;
  if (result == PN_OK) *out = a.text.bytes;
  else pni_free(gpu, a.text.bytes);
  return result;
}

/* ---- compiling --------------------------------------------------------------------------------------------------- */

static pn_result compile(pni_gpu *gpu, GLenum stage, const char *path, const char *more, const char *defines,
                         pn_gl *out) {
  char *text = NULL;
  const char *paths[] = {path, more, NULL};
  pn_result result = pni_shader_text(gpu, paths, defines, &text);
  if (result != PN_OK) return result;
  const char *parts[] = {"#version 330 core\n", text};
  pn_gl shader = GL(gpu, CreateShader)(stage);
  GL(gpu, ShaderSource)(shader, 2, parts, NULL);
  GL(gpu, CompileShader)(shader);
  pni_free(gpu, text);
  GLint done = 0;
  GL(gpu, GetShaderiv)(shader, GL_COMPILE_STATUS, &done);
  if (done) {
    *out = shader;
    return PN_OK;
  }
  char log[800] = "";
  GL(gpu, GetShaderInfoLog)(shader, sizeof log, NULL, log);
  GL(gpu, DeleteShader)(shader);
  return pni_fail(gpu, PN_ERROR_SHADER, PN_MESSAGE_SHADER_COMPILE, "shader %s: %s", more ? more : path, log);
}

static pn_result link(pni_gpu *gpu, const pni_program_key *key, pn_gl vertex, pn_gl fragment, pn_gl *out) {
  pn_gl id = GL(gpu, CreateProgram)();
  GL(gpu, AttachShader)(id, vertex);
  GL(gpu, AttachShader)(id, fragment);
  GL(gpu, LinkProgram)(id);
  GLint done = 0;
  GL(gpu, GetProgramiv)(id, GL_LINK_STATUS, &done);
  if (done) {
    *out = id;
    return PN_OK;
  }
  char log[800] = "";
  GL(gpu, GetProgramInfoLog)(id, sizeof log, NULL, log);
  GL(gpu, DeleteProgram)(id);
  return pni_fail(gpu, PN_ERROR_SHADER, PN_MESSAGE_SHADER_LINK, "program %s with %s: %s", key->vertex, key->fragment,
                  log);
}

static void find_uniforms(pni_gpu *gpu, pni_program *program) {
  GLint count = 0;
  GL(gpu, GetProgramiv)(program->id, GL_ACTIVE_UNIFORMS, &count);
  for (GLint i = 0; i < count && program->uniform_count < PNI_UNIFORMS_MAX; i++) {
    char name[PNI_UNIFORM_NAME] = "";
    GLint size = 0;
    GLenum type = 0;
    GL(gpu, GetActiveUniform)(program->id, (GLuint)i, sizeof name, NULL, &size, &type, name);
    GLint location = GL(gpu, GetUniformLocation)(program->id, name);
    if (location < 0) continue; /* a member of the uniform block */
    memcpy(program->uniforms[program->uniform_count].name, name, sizeof name);
    program->uniforms[program->uniform_count++].location = location;
  }
}

GLint pni_uniform(const pni_program *program, const char *name) {
  for (int i = 0; i < program->uniform_count; i++)
    if (!strcmp(program->uniforms[i].name, name)) return program->uniforms[i].location;
  return -1;
}

/* Samplers have fixed units all over the library, so they are set once. */
static void set_samplers(pni_gpu *gpu, const pni_program *program) {
  static const struct {
    const char *name;
    int unit;
  } samplers[] = {
      {"pn_maps", PNI_UNIT_MAPS},
      {"pn_range", PNI_UNIT_RANGE},
      {"pn_depth", PNI_UNIT_DEPTH},
      {"pn_normal", PNI_UNIT_NORMAL},
      {"pn_mask", PNI_UNIT_MASK},
      {"pn_work", PNI_UNIT_WORK},
      {"pn_peel_map", PNI_UNIT_PEEL},
      {"pn_alpha", PNI_UNIT_ALPHA},
      {"pn_seen", PNI_UNIT_SEEN},
      {"pn_seen_range", PNI_UNIT_SEEN_RANGE},
      /* the passes over a mesh's edges see no receiver */
      {"pn_edges", PNI_UNIT_DEPTH},
      {"pn_points", PNI_UNIT_NORMAL},
      {"pn_sides", PNI_UNIT_MASK},
      {"pn_rings", PNI_UNIT_WORK},
      {"pn_entries", PNI_UNIT_PEEL},
      {"pn_kept", PNI_UNIT_ALPHA},
      {"pn_sums_low", PNI_UNIT_WORK},
      {"pn_sums_middle", PNI_UNIT_PEEL},
      {"pn_sums_high", PNI_UNIT_SEEN},
      {"pn_list", PNI_UNIT_SEEN},
      {"pn_total", PNI_UNIT_RANGE},
  };
  GLint before = 0;
  GL(gpu, GetIntegerv)(GL_CURRENT_PROGRAM, &before);
  GL(gpu, UseProgram)(program->id);
  for (size_t i = 0; i < sizeof samplers / sizeof *samplers; i++)
    GL(gpu, Uniform1i)(pni_uniform(program, samplers[i].name), samplers[i].unit);
  GLuint block = GL(gpu, GetUniformBlockIndex)(program->id, "pn_block");
  if (block != GL_INVALID_INDEX) GL(gpu, UniformBlockBinding)(program->id, block, PNI_BLOCK_BINDING);
  GL(gpu, UseProgram)((GLuint)before);
}

static pn_result build(pni_gpu *gpu, const pni_program_key *key, pni_program *program) {
  pn_gl vertex = 0, fragment = 0;
  pn_result result = compile(gpu, GL_VERTEX_SHADER, key->vertex, NULL, key->defines, &vertex);
  if (result == PN_OK) result = compile(gpu, GL_FRAGMENT_SHADER, key->fragment, key->more, key->defines, &fragment);
  if (result == PN_OK) result = link(gpu, key, vertex, fragment, &program->id);
  if (vertex) GL(gpu, DeleteShader)(vertex);
  if (fragment) GL(gpu, DeleteShader)(fragment);
  if (result != PN_OK) return result;
  find_uniforms(gpu, program);
  set_samplers(gpu, program);
  return PN_OK;
}

static char *join_key(pni_gpu *gpu, const pni_program_key *key) {
  const char *more = key->more ? key->more : "";
  size_t bytes = strlen(key->vertex) + strlen(key->fragment) + strlen(more) + strlen(key->defines) + 4;
  char *text = pni_reallocate(gpu, NULL, bytes);
  if (text) snprintf(text, bytes, "%s %s %s %s", key->vertex, key->fragment, more, key->defines);
  return text;
}

pn_result pni_program_get(pni_gpu *gpu, const pni_program_key *key, const pni_program **out) {
  char *text = join_key(gpu, key);
  if (!text) return PN_ERROR_OUT_OF_MEMORY;
  for (pni_program *p = gpu->programs; p; p = p->next)
    if (!strcmp(p->key, text)) {
      pni_free(gpu, text);
      *out = p;
      return PN_OK;
    }
  pni_program *program = pni_allocate_zero(gpu, sizeof *program);
  pn_result result = program ? build(gpu, key, program) : PN_ERROR_OUT_OF_MEMORY;
  if (result != PN_OK) {
    pni_free(gpu, program);
    pni_free(gpu, text);
    return result;
  }
  program->key = text;
  program->next = gpu->programs;
  gpu->programs = program;
  *out = program;
  return PN_OK;
}

void pni_programs_free(pni_gpu *gpu, bool abandon) {
  while (gpu->programs) {
    pni_program *program = gpu->programs;
    gpu->programs = program->next;
    if (!abandon) GL(gpu, DeleteProgram)(program->id);
    pni_free(gpu, program->key);
    pni_free(gpu, program);
  }
}
