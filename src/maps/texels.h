/* Where along an axis a map's texels lie: on grids that do not depend on what moves. docs/space.md explains why. */
#ifndef PNI_MAPS_TEXELS_H
#define PNI_MAPS_TEXELS_H

typedef struct {
  double low, high; /* the range asked for, put outwards to whole texels */
  double from, to;  /* the map: as many texels as it has, an empty one beside low and beside high at least */
} pni_axis;

/* The least of the sizes 2^(k/4), k whole, that is not below the given one. */
double pni_texel_size(double least);

/* A range to whole steps of such a size, at most so many steps: what moves inside it does not move it. */
void pni_steps_around(double *low, double *high, int steps);

/* A map that covers the range: its texels are as small as that allows, and lie at multiples of their size. low <
 * high. */
pni_axis pni_texels_around(double low, double high, int texels);
/* The same, but the range ends in anchor, low or high, and texels are counted from there: for neighbours that meet. */
pni_axis pni_texels_from(double anchor, double low, double high, int texels);

/* Half the width of the largest map around 0 that is at most so wide, borders left out, and has such texels. */
double pni_texels_half(double most, int texels);

#endif
