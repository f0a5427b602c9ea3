/* 4x4 matrices in double, column-major, for composing what is then handed to GL in float. */
#ifndef PNI_SPACE_MATRIX_H
#define PNI_SPACE_MATRIX_H

#include <stdbool.h>

typedef struct {
  double m[16];
} pni_matrix;

pni_matrix pni_matrix_identity(void);
pni_matrix pni_matrix_from_floats(const float m[16]);
void pni_matrix_to_floats(const pni_matrix *a, float out[16]);
pni_matrix pni_matrix_multiply(const pni_matrix *a, const pni_matrix *b); /* a * b: b is applied first */
bool pni_matrix_invert(const pni_matrix *a, pni_matrix *out);             /* false: singular or not finite */
void pni_matrix_apply(const pni_matrix *a, const double in[4], double out[4]);
/* A point through an affine matrix. */
void pni_matrix_point(const pni_matrix *a, const double in[3], double out[3]);
bool pni_floats_finite(const float *values, int count);

#endif
