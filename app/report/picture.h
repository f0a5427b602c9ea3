/* picture.h: small pictures in memory, RGB, 8 bits, sRGB. */
#ifndef PENUMBRA_APP_REPORT_PICTURE_H
#define PENUMBRA_APP_REPORT_PICTURE_H

#include <stddef.h>
#include <stdint.h>

#include "report/report.h"

/* Errors are shown from -PICTURE_ERROR_FULL (too dark, blue) over 0 (white) to +PICTURE_ERROR_FULL (too light, red),
 * always. */
#define PICTURE_ERROR_FULL 0.25

/* The colour of one error; beyond the scale: its end. NaN: magenta. */
void picture_error_colour(double error, uint8_t rgb[3]);

extern const uint8_t picture_background[3]; /* no surface */
extern const uint8_t picture_uncounted[3];  /* a surface that does not receive, or does not face the whole light */

/* result - reference as colours, malloc'ed; NULL: out of memory. */
uint8_t *picture_error_map(const struct report *report, const float *result);

/* Shrinks by averaging light (not codes) over each target pixel's exact area; malloc'ed, NULL: out of memory. */
uint8_t *picture_shrink(const uint8_t *rgb, int width, int height, int to_width, int to_height);

/* PNG in memory, malloc'ed. Returns 0 when memory ran out. */
int picture_png(const uint8_t *rgb, int width, int height, uint8_t **png, size_t *size);

/* For drawing on: copies the picture to (x, y) of an RGB24 surface, which it must fit into; and the surface as PNG. */
typedef struct _cairo_surface cairo_surface_t;
void picture_copy(cairo_surface_t *surface, int x, int y, const uint8_t *rgb, int width, int height);
int picture_surface_png(cairo_surface_t *surface, uint8_t **png, size_t *size);

#endif
