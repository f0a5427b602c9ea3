/* shade.h: from visibility to a picture, on the CPU, so that truth and techniques are shaded by the very same code. */
#ifndef PENUMBRA_APP_HOST_SHADE_H
#define PENUMBRA_APP_HOST_SHADE_H

#include "host/view.h"

/* The light's exact diffuse form factor at a surface point: the share of the point's cosine-weighted hemisphere
 * that the rectangle above the horizon covers; for a sun the cosine. 0 behind a rectangle. */
double light_form_factor(const struct light *light, const double position[3], const double normal[3]);

/* Linear radiance, three floats a pixel: a grey surface of albedo 0.8 under the light, times visibility (one float
 * a pixel), plus a little ambient; scaled so that a lit surface under the light, where its axis meets the target,
 * has 0.8. */
void shade(const struct view *view, const struct light *light, const float *visibility, float *rgb);

/* The same for one pixel's geometry, without visibility: form factor times exposure. Background: -1. Compare uses
 * it for every picture of a view. */
void shade_unoccluded(const struct view *view, const struct light *light, float *out);

/* rgb = what unoccluded light and visibility give; background gets its own grey. */
void shade_with(const float *unoccluded, const float *visibility, size_t count, float *rgb);
#endif
