#include "model.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  float *positions;
  uint32_t *indices;
  size_t position_count, position_room, index_count, index_room;
} builder;

static int grow(void **data, size_t element, size_t count, size_t *room) {
  if (count <= *room) return 1;
  size_t wanted = 2 * count;
  void *more = realloc(*data, wanted * element);
  if (!more) return 0;
  *data = more;
  *room = wanted;
  return 1;
}

static int read_vertex(builder *b, char *text) {
  size_t at = 3 * b->position_count;
  if (!grow((void **)&b->positions, sizeof *b->positions, at + 3, &b->position_room)) return 0;
  for (int axis = 0; axis < 3; axis++) {
    char *end;
    b->positions[at + (size_t)axis] = strtof(text, &end);
    if (end == text) return 0;
    text = end;
  }
  b->position_count++;
  return 1;
}

/* v, v/vt, v//vn or v/vt/vn for each corner; negative numbers count from the end. */
static int read_face(builder *b, char *text) {
  uint32_t first = 0, last = 0;
  for (int corner = 0;; corner++) {
    char *end;
    long i = strtol(text, &end, 10);
    if (end == text) return corner >= 3;
    if (i < 0) i += (long)b->position_count + 1;
    if (i < 1 || (size_t)i > b->position_count) return 0;
    uint32_t index = (uint32_t)(i - 1);
    if (corner == 0) first = index;
    if (corner >= 2) {
      uint32_t triangle[3] = {first, last, index};
      if (!grow((void **)&b->indices, sizeof *b->indices, b->index_count + 3, &b->index_room)) return 0;
      memcpy(b->indices + b->index_count, triangle, sizeof triangle);
      b->index_count += 3;
    }
    last = index;
    text = end + strcspn(end, " \t\r\n");
  }
}

static int read_lines(builder *b, FILE *file) {
  char line[4096];
  while (fgets(line, sizeof line, file)) {
    if (strncmp(line, "v ", 2) == 0 && !read_vertex(b, line + 2)) return 0;
    if (strncmp(line, "f ", 2) == 0 && !read_face(b, line + 2)) return 0;
  }
  return b->index_count > 0;
}

int model_load(const char *path, mesh *out) {
  builder b = {0};
  FILE *file = fopen(path, "r");
  int ok = file && read_lines(&b, file);
  if (file) fclose(file);
  *out = (mesh){0};
  if (ok) *out = mesh_make("model", (int)b.position_count, (int)b.index_count);
  if (out->vertex_count) {
    memcpy(out->rest, b.positions, 3 * b.position_count * sizeof *b.positions);
    memcpy(out->indices, b.indices, b.index_count * sizeof *b.indices);
    mesh_pose(out, 0);
  } else {
    fprintf(stderr, "%s: not a model that the host client can read\n", path);
  }
  free(b.positions);
  free(b.indices);
  return out->vertex_count > 0;
}

int model_save(const char *path, const scene *world) {
  FILE *file = fopen(path, "w");
  if (!file) return 0;
  uint32_t first = 1;
  for (int i = 0; i < world->count; i++) {
    const mesh *m = &world->meshes[i];
    fprintf(file, "o %s\n", m->name);
    for (int v = 0; v < m->vertex_count; v++) {
      vec3 p = mesh_vertex(m, (uint32_t)v);
      fprintf(file, "v %.9g %.9g %.9g\n", (float)p.x, (float)p.y, (float)p.z);
    }
    for (int k = 0; k < m->index_count; k += 3) {
      const uint32_t *t = m->indices + k;
      fprintf(file, "f %u %u %u\n", first + t[0], first + t[1], first + t[2]);
    }
    first += (uint32_t)m->vertex_count;
  }
  return fclose(file) == 0;
}
