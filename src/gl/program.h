/* Programs: compiled once from the sources and kept. */
#ifndef PNI_GL_PROGRAM_H
#define PNI_GL_PROGRAM_H

#include "gl/gpu.h"

/* What a program is made of; together they are its key. */
typedef struct {
  const char *vertex;   /* path below src/; NULL: a triangle that covers the target */
  const char *fragment; /* path below src/ */
  const char *more;     /* a second file for the fragment stage, after the first: a technique; or NULL */
  const char *defines;  /* lines "NAME VALUE\n", each becomes a #define; NULL: none */
} pni_program_key;

enum { PNI_UNIFORMS_MAX = 32, PNI_UNIFORM_NAME = 32 };

typedef struct {
  char name[PNI_UNIFORM_NAME];
  GLint location;
  GLenum target; /* samplers: what is bound to their unit; else 0 */
  int unit;
} pni_uniform;

struct pni_program {
  pn_gl id;
  int uniform_count, sampler_count;
  pni_uniform uniforms[PNI_UNIFORMS_MAX];
  uint64_t hash;
  char *key;
  pni_program *next;
};

/* The program of that key, compiled now or earlier. */
pn_result pni_program_get(pni_gpu *gpu, const pni_program_key *key, const pni_program **out);
/* NULL where the compiler found no use for it. */
const pni_uniform *pni_find_uniform(const pni_program *program, const char *name);
void pni_programs_free(pni_gpu *gpu, bool abandon);

#endif
