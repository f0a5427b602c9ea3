#include "space/matrix.h"

#include <math.h>
#include <string.h>

pni_matrix pni_matrix_identity(void) { return (pni_matrix){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}; }

pni_matrix pni_matrix_from_floats(const float m[16]) {
  pni_matrix a;
  for (int i = 0; i < 16; i++) a.m[i] = m[i];
  return a;
}

void pni_matrix_to_floats(const pni_matrix *a, float out[16]) {
  for (int i = 0; i < 16; i++) out[i] = (float)a->m[i];
}

pni_matrix pni_matrix_multiply(const pni_matrix *a, const pni_matrix *b) {
  pni_matrix out;
  for (int column = 0; column < 4; column++) pni_matrix_apply(a, b->m + 4 * column, out.m + 4 * column);
  return out;
}

void pni_matrix_apply(const pni_matrix *a, const double in[4], double out[4]) {
  double result[4];
  for (int row = 0; row < 4; row++)
    result[row] = a->m[row] * in[0] + a->m[4 + row] * in[1] + a->m[8 + row] * in[2] + a->m[12 + row] * in[3];
  memcpy(out, result, sizeof result);
}

void pni_matrix_point(const pni_matrix *a, const double in[3], double out[3]) {
  double point[4] = {in[0], in[1], in[2], 1}, result[4];
  pni_matrix_apply(a, point, result);
  memcpy(out, result, 3 * sizeof *out);
}

/* An inverse this large, of a matrix whose rows and columns have a largest entry of 1, is made of rounding. */
static const double no_inverse = 0x1p46;

/* Scales rows, then columns, to a largest entry of 1, so that units do not decide what singular means. */
static bool equilibrate(double rows[4][8], double scales[8]) {
  for (int k = 0; k < 8; k++) {
    double largest = 0;
    for (int i = 0; i < 4; i++) {
      double value = k < 4 ? rows[k][i] : rows[i][k - 4];
      if (!isfinite(value)) return false;
      largest = fmax(largest, fabs(value));
    }
    if (largest == 0) return false;
    scales[k] = 1 / largest;
    for (int i = 0; i < 4; i++) *(k < 4 ? &rows[k][i] : &rows[i][k - 4]) *= scales[k];
  }
  return true;
}

/* Gauss-Jordan with row pivoting on [a | 1]. */
bool pni_matrix_invert(const pni_matrix *a, pni_matrix *out) {
  double rows[4][8] = {{0}}, scales[8];
  for (int r = 0; r < 4; r++) {
    for (int c = 0; c < 4; c++) rows[r][c] = a->m[4 * c + r];
    rows[r][4 + r] = 1;
  }
  if (!equilibrate(rows, scales)) return false;
  for (int c = 0; c < 4; c++) {
    int pivot = c;
    for (int r = c + 1; r < 4; r++)
      if (fabs(rows[r][c]) > fabs(rows[pivot][c])) pivot = r;
    if (fabs(rows[pivot][c]) < 1e-300) return false;
    double swap[8];
    memcpy(swap, rows[c], sizeof swap);
    memcpy(rows[c], rows[pivot], sizeof swap);
    memcpy(rows[pivot], swap, sizeof swap);
    double scale = 1 / rows[c][c];
    for (int k = 0; k < 8; k++) rows[c][k] *= scale;
    for (int r = 0; r < 4; r++) {
      double factor = r == c ? 0 : rows[r][c];
      for (int k = 0; k < 8 && factor != 0; k++) rows[r][k] -= factor * rows[c][k];
    }
  }
  for (int r = 0; r < 4; r++)
    for (int c = 0; c < 4; c++) {
      if (!(fabs(rows[r][4 + c]) < no_inverse)) return false;
      out->m[4 * c + r] = scales[4 + r] * rows[r][4 + c] * scales[c];
      if (!isfinite(out->m[4 * c + r])) return false;
    }
  return true;
}

bool pni_floats_finite(const float *values, int count) {
  for (int i = 0; i < count; i++)
    if (!isfinite(values[i])) return false;
  return true;
}
