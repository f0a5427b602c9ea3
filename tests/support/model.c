#include "model.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *model_name(int index) {
  static const char *const names[] = {"asteroid-high.3ds", "asteroid-low.3ds", "bunny.obj",        "cat.3ds",
                                      "cube.3ds",          "horse.3ds",        "jellyfish.jobj"};
  return index < (int)(sizeof names / sizeof *names) ? names[index] : NULL;
}

static void *grown(void *array, size_t bytes) {
  void *out = realloc(array, bytes);
  if (!out) abort();
  return out;
}

static float *add_vertices(model *m, size_t count) {
  m->positions = grown(m->positions, (m->vertices + count) * 12);
  m->vertices += count;
  return m->positions + 3 * (m->vertices - count);
}

static uint32_t *add_faces(model *m, size_t count) {
  m->indices = grown(m->indices, (m->index_count + 3 * count) * 4);
  m->index_count += 3 * count;
  return m->indices + m->index_count - 3 * count;
}

/* Faces as three numbers from 1 in a line f, or, in glmark2's own variant, one number from 0 in each line i. */
static void read_obj(char *text, model *m) {
  size_t corner = 0;
  for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
    char *at = line + 1;
    if (!strncmp(line, "v ", 2)) {
      float *p = add_vertices(m, 1);
      for (int i = 0; i < 3; i++) p[i] = strtof(at, &at);
    }
    if (!strncmp(line, "i ", 2)) {
      if (corner++ % 3 == 0) add_faces(m, 1);
      m->indices[corner - 1] = (uint32_t)strtoul(at, NULL, 10);
    }
    if (!strncmp(line, "f ", 2)) {
      uint32_t *f = add_faces(m, 1);
      for (int i = 0; i < 3; i++) {
        f[i] = (uint32_t)strtoul(at, &at, 10) - 1;
        at += strcspn(at, " ");
      }
    }
  }
}

static uint32_t number(const unsigned char *at, int bytes) {
  uint32_t value = 0;
  for (int i = bytes; i-- > 0;) value = value << 8 | at[i];
  return value;
}

/* Chunks hold chunks: those with vertices (4110) and faces (4120) are read, those around them gone into. */
static void read_3ds(const unsigned char *at, const unsigned char *end, model *m, size_t base) {
  while (at + 6 <= end) {
    uint32_t id = number(at, 2), length = number(at + 2, 4);
    if (length < 6 || length > (size_t)(end - at)) return;
    const unsigned char *body = at + 6, *next = at + length;
    if (id == 0x4000) body += strlen((const char *)body) + 1;
    if (id == 0x4d4d || id == 0x3d3d || id == 0x4000 || id == 0x4100) read_3ds(body, next, m, m->vertices);
    if (id == 0x4110) memcpy(add_vertices(m, number(body, 2)), body + 2, 12 * (size_t)number(body, 2));
    if (id == 0x4120) {
      uint32_t count = number(body, 2), *f = add_faces(m, count);
      for (uint32_t i = 0; i < 3 * count; i++) f[i] = (uint32_t)base + number(body + 2 + 8 * (i / 3) + 2 * (i % 3), 2);
    }
    at = next;
  }
}

int model_read(const char *path, model *out) {
  *out = (model){0};
  FILE *file = fopen(path, "rb");
  if (!file) return 0;
  fseek(file, 0, SEEK_END);
  size_t bytes = (size_t)ftell(file);
  rewind(file);
  unsigned char *all = grown(NULL, bytes + 1);
  bytes = fread(all, 1, bytes, file);
  fclose(file);
  all[bytes] = 0;
  if (strstr(path, ".3ds")) read_3ds(all, all + bytes, out, 0);
  else read_obj((char *)all, out);
  free(all);
  return out->index_count > 0;
}

void model_free(model *m) {
  free(m->positions);
  free(m->indices);
  *m = (model){0};
}
