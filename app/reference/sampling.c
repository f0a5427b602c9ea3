#include "reference/sampling.h"

#include <stdlib.h>

#include "reference/reference.h"

/* ---- integers ---------------------------------------------------------------------------------------------------- */

static inline uint32_t reverse_bits(uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

/* A bijective mixing of all bits (the finalizer of MurmurHash3). */
static inline uint32_t mix(uint32_t x) {
  x ^= x >> 16;
  x *= 0x85ebca6bu;
  x ^= x >> 13;
  x *= 0xc2b2ae35u;
  return x ^ (x >> 16);
}

/* Owen's nested scrambling as a hash (Laine and Karras 2011): each bit is flipped depending on the bits below it,
 * which, the number being bit-reversed, are the more significant ones. Therefore elementary intervals map to
 * elementary intervals. */
static inline uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/* The top 24 bits, which a float holds exactly, to [-1, 1). */
static inline float signed_unit(uint32_t bits) { return (float)(int32_t)(bits >> 8) * 0x1p-23f - 1; }

/* ---- the order of points ----------------------------------------------------------------------------------------- */

struct ordered {
  uint64_t key;
  uint32_t first, second;
};

static int by_key(const void *a, const void *b) {
  uint64_t x = ((const struct ordered *)a)->key, y = ((const struct ordered *)b)->key;
  return (x > y) - (x < y);
}

static uint64_t spread_bits(uint32_t x) {
  uint64_t result = 0;
  for (int bit = 0; bit < 32; bit++) result |= (uint64_t)(x >> bit & 1) << (2 * bit);
  return result;
}

/* The second coordinate of Sobol's sequence: Pascal's triangle modulo 2. */
static uint32_t sobol_second(uint32_t i) {
  uint32_t result = 0;
  for (uint32_t v = 1u << 31; i; i >>= 1, v ^= v >> 1)
    if (i & 1) result ^= v;
  return result;
}

/* Sorted along a Morton curve: any 16 points in a row lie in one piece of the light. Scrambling keeps that, since it
 * maps the piece to another one of its size. */
static void order_net(struct ordered *points, int count) {
  for (int i = 0; i < count; i++) {
    uint32_t x = reverse_bits((uint32_t)i), y = sobol_second((uint32_t)i);
    points[i].key = spread_bits(x) | spread_bits(y) << 1;
    points[i].first = (uint32_t)i;
    points[i].second = reverse_bits(y);
  }
}

/* Cells in blocks of 4 x 4. */
static void order_grid(struct ordered *points, int side) {
  for (int i = 0; i < side * side; i++) {
    uint32_t column = (uint32_t)(i % side), row = (uint32_t)(i / side);
    points[i].key = (uint64_t)(row / 4) << 32 | (column / 4) << 8 | (row % 4) << 4 | column % 4;
    points[i].first = column;
    points[i].second = row;
  }
}

static int square_root(int count) {
  int side = 0;
  while (side < SAMPLING_SIDE_MAX && side * side < count) side++;
  return side;
}

int reference_samples_valid(int samples) {
  return samples >= 1 && samples <= REFERENCE_SAMPLES_MAX && square_root(samples) * square_root(samples) == samples;
}

int sampling_create(struct sampling *sampling, int count) {
  *sampling = (struct sampling){0};
  if (!reference_samples_valid(count)) return 0;
  int side = square_root(count), is_net = (count & (count - 1)) == 0;
  struct ordered *points = malloc((size_t)count * sizeof *points);
  sampling->first = malloc((size_t)count * sizeof(uint32_t));
  sampling->second = malloc((size_t)count * sizeof(uint32_t));
  if (!points || !sampling->first || !sampling->second) {
    free(points);
    sampling_free(sampling);
    return 0;
  }
  if (is_net) order_net(points, count);
  else order_grid(points, side);
  qsort(points, (size_t)count, sizeof *points, by_key);
  for (int i = 0; i < count; i++) {
    sampling->first[i] = points[i].first;
    sampling->second[i] = points[i].second;
  }
  free(points);
  sampling->count = count;
  sampling->side = is_net ? 0 : side;
  sampling->packets = (count + SAMPLING_LANES - 1) / SAMPLING_LANES;
  return 1;
}

void sampling_free(struct sampling *sampling) {
  free(sampling->first);
  free(sampling->second);
  *sampling = (struct sampling){0};
}

/* ---- one pixel --------------------------------------------------------------------------------------------------- */

static void shuffle(uint16_t *order, int count, uint32_t seed) {
  for (int i = 0; i < count; i++) order[i] = (uint16_t)i;
  for (int i = count - 1; i > 0; i--) {
    seed = mix(seed + 0x9e3779b9u);
    int j = (int)((uint64_t)seed * (uint32_t)(i + 1) >> 32);
    uint16_t swapped = order[i];
    order[i] = order[j];
    order[j] = swapped;
  }
}

void sampling_begin(const struct sampling *sampling, uint32_t pixel, struct sampling_pixel *state) {
  state->seed[0] = mix(pixel * 2 + 0x68bc21ebu);
  state->seed[1] = mix(pixel * 2 + 0x02e5be93u);
  if (sampling->side) {
    shuffle(state->column, sampling->side, state->seed[0]);
    shuffle(state->row, sampling->side, state->seed[1]);
  }
}

WIDE_VECTORS static void net_packet(const uint32_t *first, const uint32_t *second, const uint32_t seed[2], float *x,
                                    float *y) {
  for (int i = 0; i < SAMPLING_LANES; i++) x[i] = signed_unit(reverse_bits(scramble_reversed(first[i], seed[0])));
  for (int i = 0; i < SAMPLING_LANES; i++) y[i] = signed_unit(reverse_bits(scramble_reversed(second[i], seed[1])));
}

/* In (0, 1), so far from the ends that rounding cannot carry a point into the next sub-cell. */
static inline float jitter(uint32_t bits) { return (float)(bits >> 8) * (0x1p-24f * (1 - 0x1p-6f)) + 0x1p-7f; }

/* Kensler 2013: in its cell (column, row) a point takes the sub-column that the row has drawn and the sub-row that
 * the column has. */
static void grid_point(const struct sampling *sampling, const struct sampling_pixel *state, int index, float *x,
                       float *y) {
  uint32_t column = sampling->first[index], row = sampling->second[index];
  float side = (float)sampling->side;
  float jitter_x = jitter(mix(state->seed[0] ^ (uint32_t)index)),
        jitter_y = jitter(mix(state->seed[1] ^ (uint32_t)index));
  *x = 2 * (((float)(column * (uint32_t)sampling->side + state->column[row]) + jitter_x) / (side * side)) - 1;
  *y = 2 * (((float)(row * (uint32_t)sampling->side + state->row[column]) + jitter_y) / (side * side)) - 1;
}

int sampling_packet(const struct sampling *sampling, const struct sampling_pixel *state, int packet,
                    float x[SAMPLING_LANES], float y[SAMPLING_LANES]) {
  int first = packet * SAMPLING_LANES, left = sampling->count - first;
  if (left >= SAMPLING_LANES && !sampling->side) {
    net_packet(sampling->first + first, sampling->second + first, state->seed, x, y);
    return SAMPLING_LANES;
  }
  int active = left < SAMPLING_LANES ? left : SAMPLING_LANES;
  uint32_t points[2][SAMPLING_LANES];
  for (int i = 0; i < SAMPLING_LANES; i++) {
    int index = first + (i < active ? i : active - 1);
    if (sampling->side) grid_point(sampling, state, index, &x[i], &y[i]);
    points[0][i] = sampling->first[index];
    points[1][i] = sampling->second[index];
  }
  if (!sampling->side) net_packet(points[0], points[1], state->seed, x, y);
  return active;
}
