/* sampling.h: the pattern of points on the light. In each pixel it is
 *
 *     a power of two    an Owen-scrambled (0, m, 2)-net in base 2: every elementary interval holds exactly one point
 *     other squares     correlated multi-jittered samples: one point in each cell of an n x n grid, and in each of
 *                       N columns and rows
 *
 * so that an edge parallel to the light's is found within 1/N. For a net the star discrepancy is at most (m/3 + 19/9)
 * / N (Dick and Kritzer 2006): 5.44/1024, the error at the corner of a shadow. Points come in packets of 16 that lie
 * close together on the light, because rays that run together are traced several times faster. */
#ifndef PENUMBRA_APP_REFERENCE_SAMPLING_H
#define PENUMBRA_APP_REFERENCE_SAMPLING_H

#include <stdint.h>

#define SAMPLING_LANES 16

/* Compiled for several widths of vectors, chosen when the program starts. The bits are the same: no operation is
 * fused or reordered. */
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define WIDE_VECTORS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define WIDE_VECTORS
#endif

/* Shared by all pixels and threads, never changed after sampling_create. */
struct sampling {
  int count;       /* N */
  int side;        /* sqrt(N); 0: a net */
  int packets;     /* of SAMPLING_LANES points, the last one perhaps not full */
  uint32_t *first; /* net: bit-reversed Sobol' numbers; else: column and row of the cell */
  uint32_t *second;
};

/* Returns 0 when count is not a square in 1..65536 (sampling->count is then 0) or memory ran out. */
int sampling_create(struct sampling *sampling, int count);
void sampling_free(struct sampling *sampling);

#define SAMPLING_SIDE_MAX 256

/* One pixel's scramble. */
struct sampling_pixel {
  uint32_t seed[2];
  uint16_t column[SAMPLING_SIDE_MAX], row[SAMPLING_SIDE_MAX];
};

void sampling_begin(const struct sampling *sampling, uint32_t pixel, struct sampling_pixel *state);

/* The points of one packet in [-1, 1)^2; returns how many of the 16 count, from the first. The others repeat one. */
int sampling_packet(const struct sampling *sampling, const struct sampling_pixel *state, int packet,
                    float x[SAMPLING_LANES], float y[SAMPLING_LANES]);

#endif
