#include "gl/buffer.h"

#include <stdint.h>
#include <string.h>

#include "gl/bound.h"
#include "gl/label.h"
#include "gl/texture.h"

static GLenum use_target(pni_buffer_use use) {
  static const GLenum targets[] = {[PNI_BUFFER_BLOCK] = GL_UNIFORM_BUFFER,
                                   [PNI_BUFFER_VERTICES] = GL_ARRAY_BUFFER,
                                   [PNI_BUFFER_INDICES] = GL_ELEMENT_ARRAY_BUFFER,
                                   [PNI_BUFFER_COUNTS] = GL_PIXEL_PACK_BUFFER};
  return targets[use];
}

static bool changes_often(pni_buffer_use use) { return use == PNI_BUFFER_BLOCK || use == PNI_BUFFER_COUNTS; }

pn_result pni_buffer_fill(pni_gpu *gpu, pni_buffer *buffer, const char *label, pni_buffer_use use, const void *data,
                          size_t bytes) {
  GLenum target = use_target(use);
  bool fresh = !buffer->id, resized = buffer->bytes != bytes;
  pn_result result = resized ? pni_memory_take(gpu, bytes) : PN_OK;
  if (result != PN_OK) return result;
  if (fresh) GL(gpu, GenBuffers)(1, &buffer->id);
  if (use == PNI_BUFFER_INDICES) { /* they are bound to a vertex array, which must not be the host's */
    pni_ready(gpu);
    pni_bind_vertex_array(gpu, gpu->vertex_array);
  }
  GL(gpu, BindBuffer)(target, buffer->id);
  GL(gpu, BufferData)(target, (GLsizeiptr)bytes, data, changes_often(use) ? GL_STREAM_DRAW : GL_STATIC_DRAW);
  if (use == PNI_BUFFER_INDICES || use == PNI_BUFFER_COUNTS) GL(gpu, BindBuffer)(target, 0);
  if (fresh) pni_label(gpu, GL_BUFFER, buffer->id, label);
  if (!resized) return PN_OK;
  result = pni_memory_check(gpu, bytes);
  pni_memory_give(gpu, result == PN_OK ? buffer->bytes : bytes);
  if (result == PN_OK) buffer->bytes = bytes;
  return result;
}

pn_result pni_buffer_reserve(pni_gpu *gpu, pni_buffer *buffer, const char *label, pni_buffer_use use, size_t bytes) {
  return buffer->bytes == bytes ? PN_OK : pni_buffer_fill(gpu, buffer, label, use, NULL, bytes);
}

void pni_buffer_free(pni_gpu *gpu, pni_buffer *buffer, bool abandon) {
  if (!buffer->id) return;
  if (!abandon) {
    pni_buffer_gone(gpu, buffer->id);
    GL(gpu, DeleteBuffers)(1, &buffer->id);
  }
  pni_memory_give(gpu, buffer->bytes);
  memset(buffer, 0, sizeof *buffer);
}

void pni_bind_block(pni_gpu *gpu, const pni_buffer *block) {
  if (gpu->plan.on) return;
  pni_ready(gpu);
  if (gpu->bound.block == block->id) return;
  GL(gpu, BindBufferBase)(GL_UNIFORM_BUFFER, PNI_BLOCK_BINDING, block->id);
  gpu->bound.block = block->id;
}

/* ---- the host's -------------------------------------------------------------------------------------------------- */

bool pni_buffer_exists(pni_gpu *gpu, pn_gl buffer) { return GL(gpu, IsBuffer)(buffer); }

size_t pni_buffer_size(pni_gpu *gpu, pn_gl buffer) {
  GLint64 bytes = 0;
  GL(gpu, BindBuffer)(GL_ARRAY_BUFFER, buffer);
  GL(gpu, GetBufferParameteri64v)(GL_ARRAY_BUFFER, GL_BUFFER_SIZE, &bytes);
  GL(gpu, BindBuffer)(GL_ARRAY_BUFFER, 0);
  return (size_t)bytes;
}

void pni_buffer_read(pni_gpu *gpu, pn_gl buffer, size_t offset, size_t bytes, void *out) {
  GL(gpu, BindBuffer)(GL_ARRAY_BUFFER, buffer);
  GL(gpu, GetBufferSubData)(GL_ARRAY_BUFFER, (GLintptr)offset, (GLsizeiptr)bytes, out);
  GL(gpu, BindBuffer)(GL_ARRAY_BUFFER, 0);
}

/* ---- vertex arrays ----------------------------------------------------------------------------------------------- */

void pni_vertices_make(pni_gpu *gpu, pni_vertices *vertices) {
  pni_ready(gpu);
  GL(gpu, GenVertexArrays)(1, &vertices->id);
  pni_bind_vertex_array(gpu, vertices->id);
  pni_label(gpu, GL_VERTEX_ARRAY, vertices->id, "mesh");
}

void pni_vertices_free(pni_gpu *gpu, pni_vertices *vertices, bool abandon) {
  if (vertices->id && !abandon) {
    if (gpu->bound.known && gpu->bound.vertex_array == vertices->id) gpu->bound.vertex_array = (pn_gl)-1;
    GL(gpu, DeleteVertexArrays)(1, &vertices->id);
  }
  vertices->id = 0;
}

void pni_vertices_attribute(pni_gpu *gpu, const pni_vertices *vertices, int index, int floats, pn_gl buffer,
                            size_t offset, size_t stride) {
  pni_ready(gpu);
  pni_bind_vertex_array(gpu, vertices->id);
  GL(gpu, BindBuffer)(GL_ARRAY_BUFFER, buffer);
  GL(gpu, EnableVertexAttribArray)((GLuint)index);
  GL(gpu, VertexAttribPointer)
  ((GLuint)index, floats, GL_FLOAT, GL_FALSE, (GLsizei)stride, (const void *)(uintptr_t)offset);
}

void pni_vertices_indices(pni_gpu *gpu, const pni_vertices *vertices, pn_gl buffer) {
  pni_ready(gpu);
  pni_bind_vertex_array(gpu, vertices->id);
  GL(gpu, BindBuffer)(GL_ELEMENT_ARRAY_BUFFER, buffer);
}
