#include "maps/texels.h"

#include <math.h>
#include <stdbool.h>

/* Sizes to the octave. */
static const double sizes = 4;
/* Maps begin at a multiple of the largest power of two of texels that is at most this part of them: then the blocks of
 * a range pyramid stay where they are too, up to that size. */
static const int begin_share = 32;

double pni_texel_size(double least) {
  double k = ceil(sizes * log2(least)), size = exp2(k / sizes);
  return size < least ? exp2((k + 1) / sizes) : size; /* rounded */
}

static double next_size(double size) { return pni_texel_size(size * 1.09); /* between two sizes */ }

void pni_steps_around(double *low, double *high, int steps) {
  if (!(*high > *low)) return;
  double step = pni_texel_size((*high - *low) / steps);
  while (ceil(*high / step) - floor(*low / step) > steps) step = next_size(step);
  *low = floor(*low / step) * step;
  *high = ceil(*high / step) * step;
}

static int border_of(int texels) { return texels > 2 ? 1 : 0; }

/* Maps of so few texels that whole ones are coarse begin at parts of one. */
static double begin_step(int texels) { return texels < 8 ? 0.125 : fmax(1, exp2(floor(log2(texels / begin_share)))); }

/* In texels of that size, from the range's own place on their grid. */
typedef struct {
  double low, high, begin;
} place;

static place place_at(double low, double high, double size, int texels) {
  double step = begin_step(texels), part = fmin(step, 1);
  place p = {floor(low / size / part) * part, ceil(high / size / part) * part, 0};
  p.begin = floor((p.low - border_of(texels)) / step) * step;
  return p;
}

pni_axis pni_texels_around(double low, double high, int texels) {
  int border = border_of(texels);
  double size = pni_texel_size((high - low) / (texels - 2 * border));
  place p = place_at(low, high, size, texels);
  while (p.high + border > p.begin + texels) {
    size = next_size(size);
    p = place_at(low, high, size, texels);
  }
  return (pni_axis){p.low * size, p.high * size, p.begin * size, (p.begin + texels) * size};
}

pni_axis pni_texels_from(double anchor, double low, double high, int texels) {
  int border = border_of(texels);
  double size = pni_texel_size((high - low) / (texels - 2 * border)), count = ceil((high - low) / size);
  bool upwards = anchor == low;
  double far = anchor + (upwards ? count : -count) * size;
  double begin = anchor - (upwards ? border : texels - border) * size;
  return (pni_axis){upwards ? anchor : far, upwards ? far : anchor, begin, begin + texels * size};
}

double pni_texels_half(double most, int texels) {
  int inner = texels - 2 * border_of(texels);
  double above = pni_texel_size(2 * most / inner);
  double size = above * inner > 2 * most ? above * exp2(-1 / sizes) : above;
  return 0.5 * inner * size;
}
