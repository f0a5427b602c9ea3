/* Functions of the library's GLSL, run by GL on a list of inputs. */
#ifndef TEST_GLSL_CALL_H
#define TEST_GLSL_CALL_H

#include "stage.h"

enum { CALL_RESULTS = 8 };

/* text defines void call(): it reads taken(0) .. taken(vectors - 1), four floats each, and writes results[0] ..
 * results[7], four uints each (floats through floatBitsToUint). The library's files come before it. For each of count
 * inputs 32 uints, freed by the caller. Samplers named pni_maps and pn_range are the library's units, as they are
 * bound. */
typedef struct {
  const char *const *paths; /* below src/, ends with NULL */
  const char *defines;      /* lines "NAME VALUE\n" */
  const char *text;
} glsl_function;

uint32_t *glsl_call(stage *s, const glsl_function *function, const float *inputs, int vectors, int count);

static inline float as_float(uint32_t bits) {
  union {
    uint32_t u;
    float f;
  } both = {bits};
  return both.f;
}

#endif
