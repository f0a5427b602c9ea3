/* Vectors in double, and random numbers that are the same everywhere: what tests compute their truth with. */
#ifndef TEST_VECTOR_H
#define TEST_VECTOR_H

#include <math.h>
#include <stdint.h>

typedef struct { double x, y, z; } vec;

static inline vec v3(double x, double y, double z) { return (vec){x, y, z}; }
static inline vec add(vec a, vec b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline vec sub(vec a, vec b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline vec mul(double k, vec a) { return v3(k * a.x, k * a.y, k * a.z); }
static inline double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline vec cross(vec a, vec b) {
  return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double length(vec a) { return sqrt(dot(a, a)); }
static inline vec unit(vec a) { return mul(1 / length(a), a); }

/* splitmix64 */
static inline uint64_t random_bits(uint64_t *seed) {
  uint64_t z = (*seed += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}
static inline double random_in(uint64_t *seed, double low, double high) {
  return low + (high - low) * (double)(random_bits(seed) >> 11) * 0x1p-53;
}
static inline vec random_point(uint64_t *seed, double size) {
  return v3(random_in(seed, -size, size), random_in(seed, -size, size), random_in(seed, -size, size));
}
static inline vec random_direction(uint64_t *seed) {
  for (;;) {
    vec p = random_point(seed, 1);
    double l = length(p);
    if (l > 0.1 && l < 1) return unit(p);
  }
}

#endif
