/* Programs: GLSL from the embedded sources (or a directory), with #include and #define, compiled once and kept. */
#ifndef PN_GL_PROGRAM_H
#define PN_GL_PROGRAM_H

#include "gl/gpu.h"

/* What a program is made of; together they are its key. */
typedef struct {
  const char *vertex, *fragment; /* paths below src/, for example "shaders/screen.vert.glsl" */
  const char *more;              /* a second file for the fragment stage, after the first: a technique; or NULL */
  const char *defines;           /* lines "NAME VALUE\n", each becomes a #define; may be "" */
} pn_program_key;

enum { PN_UNIFORMS_MAX = 24, PN_UNIFORM_NAME = 32 };

struct pn_program {
  pn_gl id;
  int uniform_count;
  struct {
    char name[PN_UNIFORM_NAME];
    GLint location;
  } uniforms[PN_UNIFORMS_MAX];
  char *key;
  pn_program *next;
};

/* The program of that key, compiled now or earlier. */
pn_result pn_program_get(pn_gpu *gpu, const pn_program_key *key, const pn_program **out);
/* -1, which GL ignores, where the compiler found no use for the uniform. */
GLint pn_uniform(const pn_program *program, const char *name);
void pn_programs_free(pn_gpu *gpu, bool abandon);

/* The whole text of one stage, without #version: defines, then the files with their includes in place, each once.
 * paths ends with NULL. Owned by the caller (pn_free). */
pn_result pn_shader_text(pn_gpu *gpu, const char *const *paths, const char *defines, char **out);

#endif
