#include "space/space.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static bool normalize(double a[3]) {
  double length = sqrt(dot(a, a));
  if (!(length > 0) || !isfinite(length)) return false;
  for (int i = 0; i < 3; i++) a[i] /= length;
  return true;
}

static void widen(const float in[3], double out[3]) {
  for (int i = 0; i < 3; i++) out[i] = in[i];
}

/* Closer than this to parallel, an axis says nothing about the rotation. */
static const double parallel = 1e-6;

bool pni_frame_axes(const float direction[3], const float axis_u[3], pni_frame *frame) {
  double z[3], u[3];
  widen(direction, z);
  widen(axis_u, u);
  if (!normalize(z) || !normalize(u)) return false;
  double along = dot(u, z);
  for (int i = 0; i < 3; i++) u[i] -= along * z[i];
  if (dot(u, u) < parallel * parallel || !normalize(u)) return false;
  memcpy(frame->z, z, sizeof z);
  memcpy(frame->u, u, sizeof u);
  cross(u, z, frame->v);
  return true;
}

static bool frame_from_up(const double z[3], const float up[3], double u[3]) {
  double axis[3];
  widen(up, axis);
  if (!normalize(axis)) return false;
  cross(z, axis, u);
  if (dot(u, u) < parallel * parallel) return false;
  return normalize(u);
}

static void narrow(const double in[3], float out[3]) {
  for (int i = 0; i < 3 && out; i++) out[i] = (float)in[i];
}

pn_result pn_light_frame(const float direction[3], const float up[3], float direction_out[3], float u_out[3],
                         float v_out[3]) {
  static const float others[2][3] = {{0, 0, -1}, {1, 0, 0}};
  if (!direction || !pni_floats_finite(direction, 3)) return PN_ERROR_ARGUMENT;
  double z[3], u[3], v[3];
  widen(direction, z);
  if (!normalize(z)) return PN_ERROR_ARGUMENT;
  bool found = up && pni_floats_finite(up, 3) && frame_from_up(z, up, u);
  for (int i = 0; i < 2 && !found; i++) found = frame_from_up(z, others[i], u);
  cross(u, z, v);
  narrow(z, direction_out);
  narrow(u, u_out);
  narrow(v, v_out);
  return PN_OK;
}

pni_matrix pni_light_from_scene(const pni_frame *frame) {
  const double *axes[3] = {frame->u, frame->v, frame->z};
  pni_matrix out = pni_matrix_identity();
  for (int row = 0; row < 3; row++) {
    for (int column = 0; column < 3; column++) out.m[4 * column + row] = axes[row][column];
    out.m[12 + row] = -dot(axes[row], frame->origin);
  }
  return out;
}

void pni_frame_offset(const pni_frame *frame, double m[3]) {
  const double *axes[3] = {frame->u, frame->v, frame->z};
  for (int i = 0; i < 3; i++) m[i] = frame->projection == PNI_PARALLEL ? dot(axes[i], frame->origin) : 0;
  m[2] = -m[2];
}

void pni_map_point(const double p[3], pni_projection projection, double m[3]) {
  bool sun = projection == PNI_PARALLEL;
  double w = sun ? -p[2] : 1 / p[2];
  double scale = sun ? 1 : w;
  m[0] = p[0] * scale;
  m[1] = p[1] * scale;
  m[2] = w;
}

void pni_light_point(const double m[3], pni_projection projection, double p[3]) {
  bool sun = projection == PNI_PARALLEL;
  double z = sun ? -m[2] : 1 / m[2];
  double scale = sun ? 1 : z;
  p[0] = m[0] * scale;
  p[1] = m[1] * scale;
  p[2] = z;
}

void pni_back_project(const double q[3], const double r[3], double light_point[2]) {
  light_point[0] = (q[0] - r[0]) / (q[2] - r[2]);
  light_point[1] = (q[1] - r[1]) / (q[2] - r[2]);
}

double pni_plane_offset(const double n[3], const double p[3], pni_projection projection) {
  return projection == PNI_PARALLEL ? n[2] : dot(n, p);
}

double pni_plane_front(const double n[3], double k, const double q[3], const double r[3]) {
  return n[0] * (q[0] - r[0]) + n[1] * (q[1] - r[1]) - k * (q[2] - r[2]);
}

double pni_horizon(const double n[3], double k, const double light_point[2]) {
  return n[0] * light_point[0] + n[1] * light_point[1] - k;
}

double pni_search_window(double extent, double w_max, double w_r) { return extent * fmax(w_max - w_r, 0); }

double pni_penumbra_extent(double extent, double w, double w_min) { return extent * fmax(w - w_min, 0); }

void pni_depth_scale(double w_near, double w_far, double w_of_depth[2]) {
  double scale = (w_far - w_near) / (1 - 2 * PNI_DEPTH_MARGIN);
  w_of_depth[0] = w_near - PNI_DEPTH_MARGIN * scale;
  w_of_depth[1] = scale;
}

/* Rows, with a = 2 / (s1 - s0):  x_clip / w_clip = a (s' - s0) - 1,  z_clip / w_clip = 2 (w - w_near) / (w_far -
 * w_near) - 1, where w_clip = z for a rectangle (s' = (x - shear) / z, w = 1 / z) and 1 for a sun (s' = x + shear z,
 * w = -z). */
pni_matrix pni_clip_from_light(pni_projection projection, const double bounds[4], double w_near, double w_far,
                               const double shear[2]) {
  bool sun = projection == PNI_PARALLEL;
  pni_matrix out = {{0}};
  double depth = 2 / (w_far - w_near);
  for (int axis = 0; axis < 2; axis++) {
    double low = bounds[axis], a = 2 / (bounds[axis + 2] - low);
    out.m[4 * axis + axis] = a;
    out.m[8 + axis] = sun ? a * shear[axis] : -a * low - 1;
    out.m[12 + axis] = sun ? -a * low - 1 : -a * shear[axis];
  }
  out.m[8 + 2] = sun ? -depth : -depth * w_near - 1;
  out.m[12 + 2] = sun ? -depth * w_near - 1 : depth;
  out.m[8 + 3] = sun ? 0 : 1;
  out.m[12 + 3] = sun ? 1 : 0;
  return out;
}
