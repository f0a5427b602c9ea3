/* How two pictures of visibility differ, and how much they may.
 *
 * The bound. Two views that see the same scene differ in where they think a pixel's point lies, by at most delta
 * pixels (depth's precision, the rasteriser's sub-pixel grid). Visibility is a function of the point, made of steps at
 * the borders of map texels. If it changes by r within a pixel's neighbourhood, moving the point by delta < 1 pixels
 * changes it by r * delta in expectation over where in the pixel the steps lie. So
 *     mean |difference| <= mean r * delta, summed over the picture,
 * and for a technique whose values are 0 and 1 the number of pixels that flip is about Poisson with that sum as its
 * mean: four standard deviations and a few pixels are allowed on top. */
#ifndef HOST_AGREEMENT_H
#define HOST_AGREEMENT_H

#include "camera.h"
#include "renderer.h"

typedef struct {
  double range; /* sum over pixels of the local range of the baseline */
  double sum;   /* of |difference| */
  double worst;
  int pixels, differing; /* by more than 1e-6 */
  int strays;            /* differing where the baseline is constant for two pixels around */
} agreement;

/* b against a; a_offset places b's first pixel in a. Rows of a have a_width pixels. Pixels where skip (b's size, may be
 * NULL) is not 0 are left out. */
agreement agree(const float *a, int a_width, int a_height, int offset_x, int offset_y, const float *b, int width,
                int height, const unsigned char *skip);

/* Largest minus smallest within r pixels. */
double local_range(const float *image, int width, int height, int x, int y, int r);

/* The most that the sum of differences may be: expected changes plus four standard deviations of their number plus
 * four. */
double allowed_changes(double expected);

/* The largest camera_depth_error over the surfaces of a view, plus one step of the rasteriser's grid. */
double view_error(const camera *view, const surfaces *seen);

/* Pixels below one half: a test that compares pictures makes sure that they show a shadow. */
int dark_pixels(const float *image, int width, int height);

/* Writes a picture of visibility as PGM when the environment names a directory in HOST_PICTURES: for looking at. */
void save_picture(const char *name, const float *image, int width, int height);

#endif
