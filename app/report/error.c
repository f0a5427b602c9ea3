#include "report/error.h"

#include <math.h>
#include <stdlib.h>

/* A value that is no number counts as shadow: a broken result must not look like a lit one. */
static int is_shadow(float reference, float result) {
  return !((double)reference >= ERROR_SHADOW_BELOW && (double)result >= ERROR_SHADOW_BELOW);
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static int measure(const float *reference, const float *result, const uint8_t *mask, size_t count, int lit_too,
                   struct error_statistics *out) {
  *out = (struct error_statistics){NAN, NAN, NAN, NAN, NAN, 0, 0};
  double *sizes = malloc((count ? count : 1) * sizeof *sizes);
  if (!sizes) return 0;
  double sum = 0, squares = 0, signed_sum = 0;
  for (size_t i = 0; i < count; i++) {
    if (!mask[i] || !(lit_too || is_shadow(reference[i], result[i]))) continue;
    double error = (double)result[i] - (double)reference[i];
    out->not_finite += !isfinite(error);
    sizes[out->pixels++] = fabs(error);
    sum += fabs(error);
    squares += error * error;
    signed_sum += error;
  }
  if (out->pixels > 0 && out->not_finite == 0) {
    double n = (double)out->pixels;
    qsort(sizes, out->pixels, sizeof *sizes, ascending);
    out->mae = sum / n;
    out->rmse = sqrt(squares / n);
    out->p95 = sizes[(out->pixels * 19 + 19) / 20 - 1];
    out->max = sizes[out->pixels - 1];
    out->bias = signed_sum / n;
  }
  free(sizes);
  return 1;
}

int error_measure(const float *reference, const float *result, const uint8_t *mask, size_t count,
                  struct error_statistics *out) {
  return measure(reference, result, mask, count, 0, out);
}

int error_measure_all(const float *reference, const float *result, const uint8_t *mask, size_t count,
                      struct error_statistics *out) {
  return measure(reference, result, mask, count, 1, out);
}

double error_picture(const float *reference, const float *result, const uint8_t *mask, size_t count) {
  double sum = 0;
  size_t values = 0;
  for (size_t i = 0; i < count; i++) {
    if (!mask[i]) continue;
    for (size_t k = 3 * i; k < 3 * i + 3; k++) sum += fabs((double)result[k] - (double)reference[k]);
    values += 3;
  }
  return values && isfinite(sum) ? sum / (double)values : NAN;
}

void error_bound(const float *reference, const float *result, const uint8_t *mask, size_t count, const float *bound,
                 struct error_bound *out) {
  *out = (struct error_bound){0};
  size_t held = 0;
  for (size_t i = 0; bound && i < count; i++) {
    if (!mask[i] || !is_shadow(reference[i], result[i])) continue;
    out->pixels++;
    out->mean += bound[i];
    out->max = fmax(out->max, bound[i]);
    held += fabs((double)result[i] - (double)reference[i]) <= bound[i];
  }
  if (!out->pixels) return;
  out->mean /= (double)out->pixels;
  out->held = (double)held / (double)out->pixels;
}
