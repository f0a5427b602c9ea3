/* The models of glmark2-data, read without the program: OBJ (v and f lines of triangles) and 3DS (its vertex and face
 * chunks). */
#ifndef TEST_MODEL_H
#define TEST_MODEL_H

#include <stdint.h>
#include <stddef.h>

typedef struct {
  float *positions; /* three a vertex */
  uint32_t *indices;
  size_t vertices, index_count;
} model;

/* The numbered models of one folder; 0 past the last, or where the package is missing. */
const char *model_name(int index);
int model_read(const char *path, model *out);
void model_free(model *m);

#endif
