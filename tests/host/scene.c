#include "scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

mesh mesh_make(const char *name, int vertex_count, int index_count) {
  mesh out = {.name = name, .vertex_count = vertex_count, .index_count = index_count, .casts = 1};
  size_t vertices = (size_t)vertex_count;
  out.rest = calloc(3 * vertices, sizeof *out.rest);
  out.posed = calloc(3 * vertices, sizeof *out.posed);
  out.texcoords = calloc(2 * vertices, sizeof *out.texcoords);
  out.indices = calloc((size_t)index_count, sizeof *out.indices);
  mat4 place = identity();
  to_float(&place, out.place);
  if (!out.rest || !out.posed || !out.texcoords || !out.indices) {
    mesh_free(&out);
  }
  return out;
}

void mesh_free(mesh *self) {
  free(self->rest);
  free(self->posed);
  free(self->texcoords);
  free(self->indices);
  memset(self, 0, sizeof *self);
}

/* The same formula stands in the vertex shader (renderer.c): a standing wave that grows away from the pole at x = 0. */
void mesh_pose(mesh *self, float phase) {
  for (int i = 0; i < self->vertex_count; i++) {
    const float *p = self->rest + 3 * i;
    float *q = self->posed + 3 * i;
    q[0] = p[0], q[1] = p[1];
    q[2] = p[2] + self->wave * p[0] * sinf(4.0f * p[0] + phase);
    for (int axis = 0; axis < 3; axis++) {
      if (i == 0 || q[axis] < self->bounds_min[axis]) self->bounds_min[axis] = q[axis];
      if (i == 0 || q[axis] > self->bounds_max[axis]) self->bounds_max[axis] = q[axis];
    }
  }
}

static void put(float *out, double x, double y, double z) { out[0] = (float)x, out[1] = (float)y, out[2] = (float)z; }

static void place(mesh *self, vec3 at, double turn) {
  double c = cos(turn), s = sin(turn);
  mat4 m = {{c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, at.x, at.y, at.z, 1}};
  to_float(&m, self->place);
}

/* A grid of (columns + 1) x (rows + 1) vertices and two triangles a cell; the caller fills in the positions. */
static mesh grid(const char *name, int columns, int rows) {
  mesh out = mesh_make(name, (columns + 1) * (rows + 1), 6 * columns * rows);
  uint32_t *index = out.indices;
  for (int row = 0; out.vertex_count && row < rows; row++) {
    for (int column = 0; column < columns; column++) {
      uint32_t a = (uint32_t)(row * (columns + 1) + column), b = a + 1, c = a + (uint32_t)columns + 1, d = c + 1;
      uint32_t cell[6] = {a, b, d, a, d, c};
      memcpy(index, cell, sizeof cell);
      index += 6;
    }
  }
  return out;
}

static void fill_texcoords(mesh *self, int columns, int rows) {
  for (int i = 0; i < self->vertex_count; i++) {
    self->texcoords[2 * i] = (float)(i % (columns + 1)) / (float)columns;
    self->texcoords[2 * i + 1] = (float)(i / (columns + 1)) / (float)rows;
  }
}

static void make_floor(mesh *out) {
  *out = grid("floor", 1, 1);
  for (int i = 0; i < out->vertex_count; i++) put(out->rest + 3 * i, i % 2 ? 4 : -4, 0, i / 2 ? -4 : 4);
  out->casts = 0;
}

static void make_flag(mesh *out) {
  enum { COLUMNS = 16, ROWS = 6 };
  *out = grid("flag", COLUMNS, ROWS);
  fill_texcoords(out, COLUMNS, ROWS);
  for (int i = 0; i < out->vertex_count; i++) {
    put(out->rest + 3 * i, 1.3 * out->texcoords[2 * i], 0.9 * out->texcoords[2 * i + 1], 0);
  }
  out->holes = 1;
  out->wave = 0.12f;
  place(out, v3(-1.9, 0.7, 0.3), -0.5);
}

static void make_torus(mesh *out) {
  enum { AROUND = 20, ACROSS = 10 };
  *out = grid("torus", AROUND, ACROSS);
  fill_texcoords(out, AROUND, ACROSS);
  for (int i = 0; i < out->vertex_count; i++) {
    double a = 2 * pi * out->texcoords[2 * i], b = -2 * pi * out->texcoords[2 * i + 1], r = 0.5 + 0.17 * cos(b);
    put(out->rest + 3 * i, r * cos(a), 0.17 * sin(b), r * sin(a));
  }
  place(out, v3(0.2, 1.3, -0.5), 0);
}

/* Each face has its own four corners, wound anticlockwise seen from outside. */
void mesh_box(mesh *out, const char *name, vec3 half) {
  *out = mesh_make(name, 24, 36);
  for (int face = 0; out->vertex_count && face < 6; face++) {
    int axis = face / 2, side = face % 2 ? 1 : -1;
    for (int corner = 0; corner < 4; corner++) {
      double a = corner == 1 || corner == 2 ? 1 : -1, b = corner >= 2 ? 1 : -1, p[3];
      p[axis] = side, p[(axis + 1) % 3] = a * side, p[(axis + 2) % 3] = b;
      put(out->rest + 3 * (4 * face + corner), half.x * p[0], half.y * p[1], half.z * p[2]);
    }
    uint32_t first = 4 * (uint32_t)face, two[6] = {first, first + 1, first + 2, first, first + 2, first + 3};
    memcpy(out->indices + 6 * face, two, sizeof two);
  }
}

void scene_make(scene *out) {
  memset(out, 0, sizeof *out);
  make_floor(&out->meshes[SCENE_FLOOR]);
  mesh_box(&out->meshes[SCENE_BOX], "box", v3(0.35, 0.5, 0.35));
  place(&out->meshes[SCENE_BOX], v3(1.2, 0.5, 0.4), 0.4);
  mesh_box(&out->meshes[SCENE_SLAB], "slab", v3(0.5, 0.06, 0.3));
  place(&out->meshes[SCENE_SLAB], v3(-0.3, 0.45, 1.0), -0.3);
  make_torus(&out->meshes[SCENE_TORUS]);
  make_flag(&out->meshes[SCENE_FLAG]);
  out->count = SCENE_MESHES;
  scene_pose(out, 0);
}

void scene_free(scene *self) {
  for (int i = 0; i < self->count; i++) mesh_free(&self->meshes[i]);
  self->count = 0;
}

void scene_pose(scene *self, float phase) {
  self->phase = phase;
  for (int i = 0; i < self->count; i++) mesh_pose(&self->meshes[i], phase);
}

int scene_hole(double u, double v) {
  double x = 4 * u - floor(4 * u) - 0.5, y = 3 * v - floor(3 * v) - 0.5;
  return x * x + y * y < 0.3 * 0.3;
}

vec3 mesh_vertex(const mesh *self, uint32_t i) {
  mat4 m = from_float(self->place);
  return project(&m, v3_of(self->posed + 3 * i), NULL);
}

void scene_bounds(const scene *self, float bounds[6]) {
  int first = 1;
  for (int i = 0; i < self->count; i++) {
    const mesh *m = &self->meshes[i];
    if (!m->casts) continue;
    for (int v = 0; v < m->vertex_count; v++) {
      vec3 p = mesh_vertex(m, (uint32_t)v);
      double q[3] = {p.x, p.y, p.z};
      for (int axis = 0; axis < 3; axis++) {
        /* A little more on each side: the numbers are rounded to float. */
        if (first || q[axis] < bounds[axis]) bounds[axis] = (float)q[axis] - 1e-6f;
        if (first || q[axis] > bounds[axis + 3]) bounds[axis + 3] = (float)q[axis] + 1e-6f;
      }
      first = 0;
    }
  }
}
