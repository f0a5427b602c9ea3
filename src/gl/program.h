/* Programs: GLSL from the embedded sources (or a directory), with #include and #define, compiled once and kept. */
#ifndef PN_GL_PROGRAM_H
#define PN_GL_PROGRAM_H

#include "gl/gpu.h"

/* What a program is made of; together they are its key. */
typedef struct {
  const char *vertex, *fragment; /* paths below src/, for example "shaders/screen.vert.glsl" */
  const char *more;              /* a second file for the fragment stage, after the first: a technique; or NULL */
  const char *defines;           /* lines "NAME VALUE\n", each becomes a #define; may be "" */
} pni_program_key;

enum { PNI_UNIFORMS_MAX = 24, PNI_UNIFORM_NAME = 32 };

struct pni_program {
  pn_gl id;
  int uniform_count;
  struct {
    char name[PNI_UNIFORM_NAME];
    GLint location;
  } uniforms[PNI_UNIFORMS_MAX];
  char *key;
  pni_program *next;
};

/* The program of that key, compiled now or earlier. */
pn_result pni_program_get(pni_gpu *gpu, const pni_program_key *key, const pni_program **out);
/* -1, which GL ignores, where the compiler found no use for the uniform. */
GLint pni_uniform(const pni_program *program, const char *name);
void pni_programs_free(pni_gpu *gpu, bool abandon);

/* The whole text of one stage, without #version: defines, then the files with their includes in place, each once.
 * paths ends with NULL. Owned by the caller (pni_free). */
pn_result pni_shader_text(pni_gpu *gpu, const char *const *paths, const char *defines, char **out);

#endif
