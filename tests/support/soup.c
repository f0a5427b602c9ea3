#include "soup.h"

#include <stdlib.h>

void soup_triangle(soup *s, vec a, vec b, vec c) {
  if (s->count == s->capacity) {
    s->capacity = s->capacity ? 2 * s->capacity : 64;
    s->list = realloc(s->list, (size_t)s->capacity * sizeof *s->list);
  }
  const vec corners[3] = {a, b, c};
  triangle *t = &s->list[s->count++];
  for (int i = 0; i < 3; i++) {
    t->p[i][0] = (float)corners[i].x;
    t->p[i][1] = (float)corners[i].y;
    t->p[i][2] = (float)corners[i].z;
  }
}

void soup_quad(soup *s, vec corner, vec a, vec b) {
  vec opposite = add(corner, add(a, b));
  soup_triangle(s, corner, add(corner, a), opposite);
  soup_triangle(s, corner, opposite, add(corner, b));
}

void soup_patch(soup *s, vec centre, vec a, vec b) { soup_quad(s, sub(centre, add(a, b)), mul(2, a), mul(2, b)); }

void soup_box(soup *s, vec min, vec max) {
  vec half = mul(0.5, sub(max, min));
  soup_block(s, mul(0.5, add(min, max)), v3(half.x, 0, 0), v3(0, half.y, 0), v3(0, 0, half.z));
}

void soup_block(soup *s, vec centre, vec a, vec b, vec c) {
  const vec axes[3] = {a, b, c};
  for (int i = 0; i < 3; i++) {
    vec out = axes[i], right = axes[(i + 1) % 3], up = axes[(i + 2) % 3];
    soup_patch(s, add(centre, out), right, up);
    soup_patch(s, sub(centre, out), up, right);
  }
}

void soup_free(soup *s) {
  free(s->list);
  *s = (soup){0};
}

vec corner_of(const triangle *t, int i) { return v3(t->p[i][0], t->p[i][1], t->p[i][2]); }

vec normal_of(const triangle *t) {
  vec a = corner_of(t, 0);
  return unit(cross(sub(corner_of(t, 1), a), sub(corner_of(t, 2), a)));
}
