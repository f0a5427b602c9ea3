#include "truth.h"

#include <math.h>
#include <stddef.h>

truth_light truth_light_of(const pn_light_desc *desc, const pn_maps_info *maps) {
  static const float up[3] = {0, 1, 0};
  truth_light out = {
      .shape = desc->shape, .center = v3_of(desc->center), .half_u = desc->half_u, .half_v = desc->half_v};
  out.direction = normalized(v3_of(desc->direction));
  vec3 axis = v3_of(desc->axis_u);
  if (dot(axis, axis) == 0) {
    float direction[3], u[3], v[3];
    pn_light_frame(desc->direction, up, direction, u, v);
    axis = v3_of(u);
  }
  out.u = normalized(sub(axis, scaled(out.direction, dot(axis, out.direction))));
  out.v = cross(out.u, out.direction);
  out.texel_s = (maps->s1 - maps->s0) / maps->width;
  out.texel_t = (maps->t1 - maps->t0) / maps->height;
  return out;
}

/* The fraction along o + f d where it meets the triangle, or -1; *a and *b are the barycentric weights of corners 1 and
 * 2. */
static double hit(vec3 o, vec3 d, vec3 p0, vec3 p1, vec3 p2, double *a, double *b) {
  vec3 e1 = sub(p1, p0), e2 = sub(p2, p0), h = cross(d, e2);
  double det = dot(e1, h);
  if (det == 0) return -1;
  vec3 s = sub(o, p0), q = cross(s, e1);
  *a = dot(s, h) / det;
  *b = dot(d, q) / det;
  if (*a < 0 || *b < 0 || *a + *b > 1) return -1;
  return dot(e2, q) / det;
}

static int misses_box(const mesh *m, vec3 o, vec3 d, double most) {
  double origin[3] = {o.x, o.y, o.z}, step[3] = {d.x, d.y, d.z}, near = 0, far = most;
  for (int axis = 0; axis < 3; axis++) {
    double low = m->bounds_min[axis] - 1e-6, high = m->bounds_max[axis] + 1e-6;
    if (step[axis] == 0) {
      if (origin[axis] < low || origin[axis] > high) return 1;
      continue;
    }
    double a = (low - origin[axis]) / step[axis], b = (high - origin[axis]) / step[axis];
    near = fmax(near, fmin(a, b));
    far = fmin(far, fmax(a, b));
  }
  return near > far;
}

/* The placement of every mesh is a rotation and a translation. */
static vec3 into_object(const mesh *m, vec3 p, double w) {
  const float *k = m->place;
  vec3 q = sub(p, scaled(v3(k[12], k[13], k[14]), w));
  return v3(k[0] * q.x + k[1] * q.y + k[2] * q.z, k[4] * q.x + k[5] * q.y + k[6] * q.z,
            k[8] * q.x + k[9] * q.y + k[10] * q.z);
}

static int mesh_blocks(const mesh *m, vec3 o, vec3 d, double most) {
  if (misses_box(m, o, d, most)) return 0;
  for (int i = 0; i < m->index_count; i += 3) {
    const uint32_t *k = m->indices + i;
    const float *t = m->texcoords;
    double a, b;
    double f = hit(o, d, v3_of(m->posed + 3 * k[0]), v3_of(m->posed + 3 * k[1]), v3_of(m->posed + 3 * k[2]), &a, &b);
    if (f <= 0 || f >= most) continue;
    if (!m->holes) return 1;
    double c = 1 - a - b, u = c * t[2 * k[0]] + a * t[2 * k[1]] + b * t[2 * k[2]];
    double v = c * t[2 * k[0] + 1] + a * t[2 * k[1] + 1] + b * t[2 * k[2] + 1];
    /* The texture has whole texels, nearest. */
    u = (floor(u * HOLE_TEXELS) + 0.5) / HOLE_TEXELS;
    v = (floor(v * HOLE_TEXELS) + 0.5) / HOLE_TEXELS;
    if (!scene_hole(u, v)) return 1;
  }
  return 0;
}

int truth_blocked(const scene *world, vec3 a, vec3 b, double most) {
  for (int i = 0; i < world->count; i++) {
    const mesh *m = &world->meshes[i];
    if (!m->casts) continue;
    vec3 o = into_object(m, a, 1), end = into_object(m, b, 1);
    if (mesh_blocks(m, o, sub(end, o), most)) return 1;
  }
  return 0;
}

int truth_corners(const truth_light *light, vec3 p, vec3 n) {
  int count = 0;
  for (int corner = 0; corner < 4; corner++) {
    double a = corner & 1 ? light->half_u : -light->half_u, b = corner & 2 ? light->half_v : -light->half_v;
    vec3 offset = add(scaled(light->u, a), scaled(light->v, b));
    vec3 towards = light->shape == PN_LIGHT_SUN ? sub(offset, light->direction) : sub(add(light->center, offset), p);
    count += dot(n, normalized(towards)) > 0;
  }
  return count;
}

/* Where the map ray through (s, t) starts and which way it goes, per unit of depth along the light's axis. */
static void map_ray(const truth_light *light, double s, double t, vec3 *start, vec3 *step) {
  vec3 side = add(scaled(light->u, s), scaled(light->v, t));
  if (light->shape == PN_LIGHT_SUN) {
    *start = sub(side, scaled(light->direction, 20));
    *step = light->direction;
  } else {
    *start = light->center;
    *step = add(light->direction, side);
  }
}

int truth_hard(const truth_light *light, const scene *world, vec3 p, vec3 n, double texels) {
  enum { RAYS = 5 }; /* a side: what is thinner than 3/8 of a texel may slip through */
  int corners = truth_corners(light, p, n);
  if (corners == 0) return TRUTH_AWAY;
  if (corners < 4) return TRUTH_EITHER;
  int sun = light->shape == PN_LIGHT_SUN;
  vec3 q = sun ? p : sub(p, light->center);
  double z = sun ? 1 : dot(q, light->direction), s = dot(q, light->u) / z, t = dot(q, light->v) / z;
  int answer = -1;
  for (int k = 0; k < RAYS * RAYS; k++) {
    vec3 start, step;
    double a = texels * (2.0 * (k % RAYS) / (RAYS - 1) - 1), b = texels * (2.0 * (k / RAYS) / (RAYS - 1) - 1);
    map_ray(light, s + light->texel_s * a, t + light->texel_t * b, &start, &step);
    /* The same surface as seen along the neighbouring ray. */
    double slope = dot(n, step), depth = dot(n, sub(p, start)) / slope;
    if (!(-slope > 0.1 * sqrt(dot(step, step))) || !(depth > 0)) return TRUTH_EITHER;
    int lit = !truth_blocked(world, start, add(start, scaled(step, depth)), 1 - 2e-4);
    if (answer < 0) answer = lit;
    if (lit != answer) return TRUTH_EITHER;
  }
  return answer;
}

int truth_sees_all(const truth_light *light, const scene *world, vec3 p, vec3 n) {
  enum { SIDE = 9 };
  if (truth_corners(light, p, n) < 4) return 0;
  for (int texels = 1; texels <= 4; texels++) {
    if (truth_hard(light, world, p, n, texels) != TRUTH_LIT) return 0;
  }
  vec3 from = add(p, scaled(n, 1e-4));
  for (int k = 0; k < SIDE * SIDE; k++) {
    double a = 1.3 * light->half_u * (2.0 * (k % SIDE) / (SIDE - 1) - 1);
    double b = 1.3 * light->half_v * (2.0 * (k / SIDE) / (SIDE - 1) - 1);
    vec3 offset = add(scaled(light->u, a), scaled(light->v, b));
    vec3 to =
        light->shape == PN_LIGHT_SUN ? add(p, scaled(sub(offset, light->direction), 20)) : add(light->center, offset);
    if (truth_blocked(world, from, to, 1)) return 0;
  }
  return 1;
}

static int same_face(const surfaces *seen, int a, int b) {
  const float *p = seen->position + 4 * a, *q = seen->position + 4 * b;
  vec3 n = v3_of(seen->normal + 3 * a), m = v3_of(seen->normal + 3 * b);
  return p[3] == q[3] && dot(n, m) > 0.999 && fabs(dot(n, sub(v3_of(p), v3_of(q)))) < 1e-3;
}

/* The pixel and the next two that way. */
static int run_of_three(const surfaces *seen, int i, int step) {
  return same_face(seen, i, i + step) && same_face(seen, i, i + 2 * step);
}

int truth_plane_known(const surfaces *seen, int x, int y) {
  int i = y * seen->width + x, row = seen->width;
  if (x < 2 || y < 2 || x >= seen->width - 2 || y >= seen->height - 2) return 0;
  return (run_of_three(seen, i, -1) || run_of_three(seen, i, 1)) &&
         (run_of_three(seen, i, -row) || run_of_three(seen, i, row));
}
