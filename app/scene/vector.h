/* vector.h: three doubles. cglm is single precision only; set-ups, normals and what is measured need more. */
#ifndef PENUMBRA_APP_SCENE_VECTOR_H
#define PENUMBRA_APP_SCENE_VECTOR_H

#include <math.h>

static inline void v3_set(double out[3], double x, double y, double z) {
  out[0] = x;
  out[1] = y;
  out[2] = z;
}

static inline double v3_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline double v3_length(const double a[3]) { return sqrt(v3_dot(a, a)); }

/* out = a - b */
static inline void v3_sub(const double a[3], const double b[3], double out[3]) {
  for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

/* out = a + scale * b; out may be a or b. */
static inline void v3_add_scaled(const double a[3], double scale, const double b[3], double out[3]) {
  for (int i = 0; i < 3; i++) out[i] = a[i] + scale * b[i];
}

/* out is neither a nor b. */
static inline void v3_cross(const double a[3], const double b[3], double out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Makes a unit vector of a; returns its old length, and leaves a alone when that is 0. */
static inline double v3_normalize(double a[3]) {
  double length = v3_length(a);
  if (length > 0)
    for (int i = 0; i < 3; i++) a[i] /= length;
  return length;
}

/* out = m * (p, 1), m affine, column-major. */
static inline void m4_point(const double m[16], const double p[3], double out[3]) {
  for (int i = 0; i < 3; i++) out[i] = m[i] * p[0] + m[4 + i] * p[1] + m[8 + i] * p[2] + m[12 + i];
}

#endif
