#include "space/rounding.h"

#include <math.h>

double pni_far_middle(float low, float high) {
  bool away = (double)high - low <= 0.5 * fmax(fabs(low), fabs(high));
  return away ? (float)(0.5 * ((double)low + high)) : 0;
}

/* Where a box lies around its middle, terms are as large as what comes out of their sum, and the tolerances of depth
 * and map hold what that loses. By as much as they are larger, more is lost. */
void pni_box_rounding(const pni_matrix *matrix, const float min[3], const float max[3], double out[3]) {
  for (int row = 0; row < 3; row++) {
    const double *m = matrix->m + row;
    double terms = fabs(m[12]), around = 0, middle = m[12];
    for (int i = 0; i < 3; i++) {
      double low = min[i], high = max[i], far = pni_far_middle(min[i], max[i]);
      terms += fabs(m[4 * i]) * fmax(fabs(low), fabs(high));
      around += fabs(m[4 * i]) * fmax(fabs(low - far), fabs(high - far));
      middle += m[4 * i] * far;
    }
    out[row] = PNI_MATRIX_ROUNDING * fmax(terms - around - fabs(middle), 0);
  }
}

/* A sun's rows are scaled, no more. A rectangle's divide by z: s = x / z is then off by (e_x + abs(s) e_z) / z, and
 * depth, which mixes 1 and z so that it spans w_near to w_far, by what moves w by e_z w w_near. */
void pni_map_rounding(pni_rounding *rounding, pni_projection projection, const double bounds[4], double w_near) {
  if (projection == PNI_PARALLEL) return;
  for (int i = 0; i < 2; i++) rounding->map[i] += fmax(fabs(bounds[i]), fabs(bounds[i + 2])) * rounding->map[2];
  rounding->map_per_z = rounding->map[2] * w_near;
  rounding->map[2] = 0;
}

/* The camera is at the eye's origin: every term of that product cancels. What surfaces lie away from it is as large as
 * the view itself. */
double pni_view_rounding(const pni_matrix *eye_from_scene) {
  pni_matrix scene_from_eye;
  if (!pni_matrix_invert(eye_from_scene, &scene_from_eye)) return 0;
  const double *camera = scene_from_eye.m + 12;
  double squares = 0, longest = 0;
  for (int row = 0; row < 3; row++) {
    const double *m = eye_from_scene->m + row, *axis = scene_from_eye.m + 4 * row;
    double terms = fabs(m[12]);
    for (int i = 0; i < 3; i++) terms += fabs(m[4 * i] * camera[i]);
    squares += terms * terms;
    longest = fmax(longest, axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  }
  return PNI_MATRIX_ROUNDING * sqrt(squares * longest);
}
