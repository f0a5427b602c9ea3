/* Vectors and matrices of the client, in double; column-major like GL's. */
#ifndef HOST_LINEAR_H
#define HOST_LINEAR_H

typedef struct {
  double x, y, z;
} vec3;

typedef struct {
  double m[16];
} mat4;

vec3 v3(double x, double y, double z);
vec3 v3_of(const float p[3]);
vec3 add(vec3 a, vec3 b);
vec3 sub(vec3 a, vec3 b);
vec3 scaled(vec3 a, double s);
double dot(vec3 a, vec3 b);
vec3 cross(vec3 a, vec3 b);
vec3 normalized(vec3 a);

mat4 identity(void);
mat4 multiply(const mat4 *a, const mat4 *b);
mat4 look_at(vec3 eye, vec3 target, vec3 up);
mat4 translation(double x, double y, double z);

/* Projections to -1..1 in all three coordinates. */
mat4 frustum(double left, double right, double bottom, double top, double near, double far);
mat4 orthographic(double left, double right, double bottom, double top, double near, double far);

/* p after m with the division by w. *w may be NULL. */
vec3 project(const mat4 *m, vec3 p, double *w);

/* The matrix as GL and the library take it, and the same rounded matrix in double. */
void to_float(const mat4 *m, float out[16]);
mat4 from_float(const float m[16]);

#endif
