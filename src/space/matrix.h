/* 4x4 matrices in double, column-major, for composing what is then handed to GL in float. */
#ifndef PN_SPACE_MATRIX_H
#define PN_SPACE_MATRIX_H

#include <stdbool.h>

typedef struct {
  double m[16];
} pn_matrix;

pn_matrix pn_matrix_identity(void);
pn_matrix pn_matrix_from_floats(const float m[16]);
void pn_matrix_to_floats(const pn_matrix *a, float out[16]);
pn_matrix pn_matrix_multiply(const pn_matrix *a, const pn_matrix *b); /* a * b: b is applied first */
bool pn_matrix_invert(const pn_matrix *a, pn_matrix *out);            /* false: singular or not finite */
void pn_matrix_apply(const pn_matrix *a, const double in[4], double out[4]);
/* A point through an affine matrix. */
void pn_matrix_point(const pn_matrix *a, const double in[3], double out[3]);
bool pn_floats_finite(const float *values, int count);

#endif
