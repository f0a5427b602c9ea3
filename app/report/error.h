/* error.h: how far a visibility buffer is from the truth, over its shadow pixels and over all that the light reaches;
 * and how far the picture is. */
#ifndef PENUMBRA_APP_REPORT_ERROR_H
#define PENUMBRA_APP_REPORT_ERROR_H

#include <stddef.h>
#include <stdint.h>

/* Visibility below this is shadow. */
#define ERROR_SHADOW_BELOW (1 - 1 / 2048.0)

/* Undefined (NaN), all of them, when no pixel counts, or when one has a result or truth that is not finite. */
struct error_statistics {
  double mae; /* mean |result - reference| */
  double rmse;
  double p95;        /* the least value that at least 95 % of |result - reference| do not exceed */
  double max;        /* of |result - reference| */
  double bias;       /* mean of result - reference */
  size_t pixels;     /* that count */
  size_t not_finite; /* of them, those without a number */
};

/* A shadow pixel: mask nonzero, and reference or result below ERROR_SHADOW_BELOW. Sums are taken in double and in the
 * order of the pixels. Returns 0 when memory ran out. */
int error_measure(const float *reference, const float *result, const uint8_t *mask, size_t count,
                  struct error_statistics *out);

/* The same over every pixel of the mask, lit ones too. */
int error_measure_all(const float *reference, const float *result, const uint8_t *mask, size_t count,
                      struct error_statistics *out);

/* Mean of |result - reference| over the channels of the mask's pixels, three linear values a pixel. NaN without a
 * pixel, or where one is not finite. */
double error_picture(const float *reference, const float *result, const uint8_t *mask, size_t count);

/* A technique's own bound of its error, over the same pixels: its mean and maximum, and the share of pixels whose
 * error it holds. bound may be NULL: no pixels. */
struct error_bound {
  double mean, max, held;
  size_t pixels;
};
void error_bound(const float *reference, const float *result, const uint8_t *mask, size_t count, const float *bound,
                 struct error_bound *out);

#endif
