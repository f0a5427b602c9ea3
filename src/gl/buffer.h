/* Buffers: uniform blocks, vertices, what the GPU counts; and vertex arrays. */
#ifndef PNI_GL_BUFFER_H
#define PNI_GL_BUFFER_H

#include "gl/gpu.h"

typedef struct {
  pn_gl id; /* 0: none */
  size_t bytes;
} pni_buffer;

typedef enum { PNI_BUFFER_BLOCK, PNI_BUFFER_VERTICES, PNI_BUFFER_INDICES, PNI_BUFFER_COUNTS } pni_buffer_use;

/* Fills the buffer, making it where there is none; data NULL: undefined. What there was stays where that fails. */
pn_result pni_buffer_fill(pni_gpu *gpu, pni_buffer *buffer, const char *label, pni_buffer_use use, const void *data,
                          size_t bytes);
/* A buffer of that size, its contents undefined; nothing happens where it has that size. */
pn_result pni_buffer_reserve(pni_gpu *gpu, pni_buffer *buffer, const char *label, pni_buffer_use use, size_t bytes);
void pni_buffer_free(pni_gpu *gpu, pni_buffer *buffer, bool abandon);

/* The uniform block of the passes that follow. */
void pni_bind_block(pni_gpu *gpu, const pni_buffer *block);

/* Buffers of the host's. */
bool pni_buffer_exists(pni_gpu *gpu, pn_gl buffer);
size_t pni_buffer_size(pni_gpu *gpu, pn_gl buffer);
/* Waits for the GPU. */
void pni_buffer_read(pni_gpu *gpu, pn_gl buffer, size_t offset, size_t bytes, void *out);

/* Attributes of floats, and indices, for pni_draw_vertices. */
typedef struct {
  pn_gl id; /* 0: none */
} pni_vertices;

void pni_vertices_make(pni_gpu *gpu, pni_vertices *vertices);
void pni_vertices_free(pni_gpu *gpu, pni_vertices *vertices, bool abandon);
void pni_vertices_attribute(pni_gpu *gpu, const pni_vertices *vertices, int index, int floats, pn_gl buffer,
                            size_t offset, size_t stride);
void pni_vertices_indices(pni_gpu *gpu, const pni_vertices *vertices, pn_gl buffer);

#endif
