#include "gl/program.h"

#include <stdio.h>
#include <string.h>

#include "gl/bound.h"
#include "gl/host.h"
#include "gl/label.h"
#include "gl/source.h"

/* Gathers of four texels where there are any: shaders ask for PN_GATHER. */
static const char *const gathers = "#ifdef GL_ARB_texture_gather\n"
                                   "#extension GL_ARB_texture_gather : enable\n"
                                   "#define PN_GATHER 1\n"
                                   "#endif\n";
static const char *const screen_vertices = "shaders/screen.vert.glsl";

/* ---- compiling --------------------------------------------------------------------------------------------------- */

static pn_result compile(pni_gpu *gpu, GLenum stage, const char *path, const char *more, const char *defines,
                         pn_gl *out) {
  char *text = NULL;
  const char *paths[] = {path, more, NULL};
  pn_result result = pni_shader_text(gpu, paths, defines, &text);
  if (result != PN_OK) return result;
  char *end = strchr(text, '\n'); /* the first line says in tools what this is */
  *end = 0;
  const char *parts[] = {"#version 330 core\n", text, "\n", gathers, end + 1};
  pn_gl shader = GL(gpu, CreateShader)(stage);
  GL(gpu, ShaderSource)(shader, 5, parts, NULL);
  GL(gpu, CompileShader)(shader);
  pni_free(gpu, text);
  pni_label(gpu, GL_SHADER, shader, more ? more : path);
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

/* ---- uniforms ---------------------------------------------------------------------------------------------------- */

/* What is bound for a sampler of that type; 0: it is none. */
static GLenum sampler_target(GLenum type) {
  switch (type) {
  case GL_SAMPLER_2D:
  case GL_UNSIGNED_INT_SAMPLER_2D: return GL_TEXTURE_2D;
  case GL_SAMPLER_2D_ARRAY:
  case GL_UNSIGNED_INT_SAMPLER_2D_ARRAY: return GL_TEXTURE_2D_ARRAY;
  case GL_SAMPLER_2D_MULTISAMPLE: return GL_TEXTURE_2D_MULTISAMPLE;
  default: return 0;
  }
}

/* Samplers have their units for good; the program is in use. */
static void add_uniform(pni_gpu *gpu, pni_program *program, GLuint index) {
  pni_uniform *uniform = &program->uniforms[program->uniform_count];
  GLint size = 0;
  GLenum type = 0;
  GL(gpu, GetActiveUniform)(program->id, index, sizeof uniform->name, NULL, &size, &type, uniform->name);
  uniform->location = GL(gpu, GetUniformLocation)(program->id, uniform->name);
  if (uniform->location < 0) return; /* a member of the uniform block */
  uniform->target = sampler_target(type);
  if (uniform->target) {
    uniform->unit = program->sampler_count++;
    GL(gpu, Uniform1i)(uniform->location, uniform->unit);
  }
  program->uniform_count++;
}

static pn_result find_uniforms(pni_gpu *gpu, pni_program *program, const char *name) {
  GLint count = 0;
  GL(gpu, GetProgramiv)(program->id, GL_ACTIVE_UNIFORMS, &count);
  pni_bind_program(gpu, program->id);
  for (GLint i = 0; i < count && program->uniform_count < PNI_UNIFORMS_MAX; i++) add_uniform(gpu, program, (GLuint)i);
  GLuint block = GL(gpu, GetUniformBlockIndex)(program->id, "pn_block");
  if (block != GL_INVALID_INDEX) GL(gpu, UniformBlockBinding)(program->id, block, PNI_BLOCK_BINDING);
  if (program->sampler_count <= PNI_UNIT_SCRATCH && program->uniform_count < PNI_UNIFORMS_MAX) return PN_OK;
  return pni_fail(gpu, PN_ERROR_SHADER, PN_MESSAGE_SHADER_LINK, "program %s: more than %d samplers or %d uniforms",
                  name, PNI_UNIT_SCRATCH, PNI_UNIFORMS_MAX - 1);
}

const pni_uniform *pni_find_uniform(const pni_program *program, const char *name) {
  for (int i = 0; program && i < program->uniform_count; i++)
    if (!strcmp(program->uniforms[i].name, name)) return &program->uniforms[i];
  return NULL;
}

/* ---- keys -------------------------------------------------------------------------------------------------------- */

static pni_program_key completed(const pni_program_key *key) {
  return (pni_program_key){key->vertex ? key->vertex : screen_vertices, key->fragment, key->more,
                           key->defines ? key->defines : ""};
}

static uint64_t hash_text(uint64_t hash, const char *text) { /* FNV-1a */
  for (; text && *text; text++) hash = (hash ^ (unsigned char)*text) * 0x100000001b3u;
  return (hash ^ 0xff) * 0x100000001b3u;
}

static uint64_t hash_key(const pni_program_key *key) {
  return hash_text(hash_text(hash_text(hash_text(0xcbf29ce484222325u, key->vertex), key->fragment), key->more),
                   key->defines);
}

/* Whether text begins with part, which it is then moved past, with the space after it. */
static bool take(const char **text, const char *part) {
  size_t length = part ? strlen(part) : 0;
  if (length && strncmp(*text, part, length)) return false;
  *text += length;
  if (**text == ' ') ++*text;
  return true;
}

/* Programs are asked for in every pass: their keys are compared without being put together. */
static bool has_key(const pni_program *program, const pni_program_key *key) {
  const char *text = program->key;
  return take(&text, key->vertex) && take(&text, key->fragment) && take(&text, key->more) &&
         !strcmp(text, key->defines);
}

static char *join_key(pni_gpu *gpu, const pni_program_key *key) {
  const char *more = key->more ? key->more : "";
  size_t bytes = strlen(key->vertex) + strlen(key->fragment) + strlen(more) + strlen(key->defines) + 4;
  char *text = pni_reallocate(gpu, NULL, bytes);
  if (text) snprintf(text, bytes, "%s %s %s%s%s", key->vertex, key->fragment, more, *more ? " " : "", key->defines);
  return text;
}

/* ---- the list of them -------------------------------------------------------------------------------------------- */

static pn_result build(pni_gpu *gpu, const pni_program_key *key, pni_program *program) {
  pn_gl vertex = 0, fragment = 0;
  pni_ready(gpu);
  pn_result result = compile(gpu, GL_VERTEX_SHADER, key->vertex, NULL, key->defines, &vertex);
  if (result == PN_OK) result = compile(gpu, GL_FRAGMENT_SHADER, key->fragment, key->more, key->defines, &fragment);
  if (result == PN_OK) result = link(gpu, key, vertex, fragment, &program->id);
  if (vertex) GL(gpu, DeleteShader)(vertex);
  if (fragment) GL(gpu, DeleteShader)(fragment);
  if (result == PN_OK) result = find_uniforms(gpu, program, program->key);
  if (result == PN_OK) pni_label(gpu, GL_PROGRAM, program->id, program->key);
  return result;
}

static void free_program(pni_gpu *gpu, pni_program *program, bool abandon) {
  if (program->id && !abandon) {
    if (gpu->bound.known && gpu->bound.program == program->id) pni_bind_program(gpu, 0);
    GL(gpu, DeleteProgram)(program->id);
  }
  if (gpu->program == program) gpu->program = NULL;
  pni_free(gpu, program->key);
  pni_free(gpu, program);
}

pn_result pni_program_get(pni_gpu *gpu, const pni_program_key *wanted, const pni_program **out) {
  pni_program_key key = completed(wanted);
  uint64_t hash = hash_key(&key);
  for (const pni_program *p = gpu->programs; p; p = p->next)
    if (p->hash == hash && has_key(p, &key)) {
      *out = p;
      return PN_OK;
    }
  pni_program *program = pni_allocate_zero(gpu, sizeof *program);
  if (!program) return PN_ERROR_OUT_OF_MEMORY;
  program->hash = hash;
  program->key = join_key(gpu, &key);
  pn_result result = program->key ? build(gpu, &key, program) : PN_ERROR_OUT_OF_MEMORY;
  if (result != PN_OK) {
    free_program(gpu, program, false);
    return result;
  }
  program->next = gpu->programs;
  gpu->programs = program;
  *out = program;
  return PN_OK;
}

void pni_programs_free(pni_gpu *gpu, bool abandon) {
  while (gpu->programs) {
    pni_program *program = gpu->programs;
    gpu->programs = program->next;
    free_program(gpu, program, abandon);
  }
}
