#include "linear.h"

#include <math.h>
#include <stddef.h>

vec3 v3(double x, double y, double z) { return (vec3){x, y, z}; }

vec3 v3_of(const float p[3]) { return v3(p[0], p[1], p[2]); }

vec3 add(vec3 a, vec3 b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }

vec3 sub(vec3 a, vec3 b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }

vec3 scaled(vec3 a, double s) { return v3(a.x * s, a.y * s, a.z * s); }

double dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

vec3 cross(vec3 a, vec3 b) { return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }

vec3 normalized(vec3 a) {
  double length = sqrt(dot(a, a));
  return length > 0 ? scaled(a, 1 / length) : a;
}

mat4 identity(void) { return (mat4){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}; }

mat4 multiply(const mat4 *a, const mat4 *b) {
  mat4 out;
  for (int column = 0; column < 4; column++) {
    for (int row = 0; row < 4; row++) {
      double sum = 0;
      for (int k = 0; k < 4; k++) sum += a->m[4 * k + row] * b->m[4 * column + k];
      out.m[4 * column + row] = sum;
    }
  }
  return out;
}

mat4 look_at(vec3 eye, vec3 target, vec3 up) {
  vec3 z = normalized(sub(eye, target)), x = normalized(cross(up, z)), y = cross(z, x);
  return (mat4){{x.x, y.x, z.x, 0, x.y, y.y, z.y, 0, x.z, y.z, z.z, 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1}};
}

mat4 translation(double x, double y, double z) {
  mat4 out = identity();
  out.m[12] = x, out.m[13] = y, out.m[14] = z;
  return out;
}

mat4 frustum(double left, double right, double bottom, double top, double near, double far) {
  mat4 out = {{0}};
  out.m[0] = 2 * near / (right - left);
  out.m[5] = 2 * near / (top - bottom);
  out.m[8] = (right + left) / (right - left);
  out.m[9] = (top + bottom) / (top - bottom);
  out.m[10] = -(far + near) / (far - near);
  out.m[11] = -1;
  out.m[14] = -2 * far * near / (far - near);
  return out;
}

mat4 orthographic(double left, double right, double bottom, double top, double near, double far) {
  mat4 out = identity();
  out.m[0] = 2 / (right - left);
  out.m[5] = 2 / (top - bottom);
  out.m[10] = -2 / (far - near);
  out.m[12] = -(right + left) / (right - left);
  out.m[13] = -(top + bottom) / (top - bottom);
  out.m[14] = -(far + near) / (far - near);
  return out;
}

vec3 project(const mat4 *m, vec3 p, double *w) {
  const double *a = m->m;
  double h = a[3] * p.x + a[7] * p.y + a[11] * p.z + a[15];
  if (w) *w = h;
  return v3((a[0] * p.x + a[4] * p.y + a[8] * p.z + a[12]) / h, (a[1] * p.x + a[5] * p.y + a[9] * p.z + a[13]) / h,
            (a[2] * p.x + a[6] * p.y + a[10] * p.z + a[14]) / h);
}

void to_float(const mat4 *m, float out[16]) {
  for (int i = 0; i < 16; i++) out[i] = (float)m->m[i];
}

mat4 from_float(const float m[16]) {
  mat4 out;
  for (int i = 0; i < 16; i++) out.m[i] = m[i];
  return out;
}
