#include "gl/host_program.h"

#include "gl/bound.h"

void pni_host_limits(pni_gpu *gpu, int *units, int *bindings) {
  GL(gpu, GetIntegerv)(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, units);
  GL(gpu, GetIntegerv)(GL_MAX_UNIFORM_BUFFER_BINDINGS, bindings);
}

static void set_units(pni_gpu *gpu, pn_gl program, const pni_host_sampler *samplers, int count) {
  GLint before = 0;
  GL(gpu, GetIntegerv)(GL_CURRENT_PROGRAM, &before);
  GL(gpu, UseProgram)(program);
  for (int i = 0; i < count; i++)
    GL(gpu, Uniform1i)(GL(gpu, GetUniformLocation)(program, samplers[i].name), samplers[i].unit);
  /* A program that the host has deleted lives only as long as it is current. */
  if (before && GL(gpu, IsProgram)((GLuint)before)) GL(gpu, UseProgram)((GLuint)before);
  else GL(gpu, UseProgram)(0);
}

static void bind_textures(pni_gpu *gpu, const pni_host_sampler *samplers, int count) {
  GLint unit = 0;
  GL(gpu, GetIntegerv)(GL_ACTIVE_TEXTURE, &unit);
  for (int i = 0; i < count; i++) {
    if (!samplers[i].texture) continue;
    GL(gpu, ActiveTexture)(GL_TEXTURE0 + (GLenum)samplers[i].unit);
    GL(gpu, BindTexture)(GL_TEXTURE_2D_ARRAY, samplers[i].texture->id);
    GL(gpu, BindSampler)((GLuint)samplers[i].unit, gpu->sampler_nearest);
  }
  GL(gpu, ActiveTexture)((GLenum)unit);
}

static GLuint block_of(pni_gpu *gpu, pn_gl program) {
  GLint linked = GL_FALSE;
  if (GL(gpu, IsProgram)(program)) GL(gpu, GetProgramiv)(program, GL_LINK_STATUS, &linked);
  return linked ? GL(gpu, GetUniformBlockIndex)(program, "pn_block") : GL_INVALID_INDEX;
}

bool pni_host_program_fits(pni_gpu *gpu, pn_gl program) { return block_of(gpu, program) != GL_INVALID_INDEX; }

void pni_host_program_bind(pni_gpu *gpu, pn_gl program, const pni_buffer *block, int binding,
                           const pni_host_sampler *samplers, int count) {
  set_units(gpu, program, samplers, count);
  GL(gpu, UniformBlockBinding)(program, block_of(gpu, program), (GLuint)binding);
  GL(gpu, BindBufferBase)(GL_UNIFORM_BUFFER, (GLuint)binding, block->id);
  bind_textures(gpu, samplers, count);
  pni_forget(gpu);
}
