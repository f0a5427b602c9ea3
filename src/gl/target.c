#include "gl/target.h"

#include <stdint.h>
#include <string.h>

#include "gl/state.h"

/* ---- memory ------------------------------------------------------------------------------------------------------ */

pn_result pni_memory_take(pni_gpu *gpu, size_t bytes) {
  size_t limit = gpu->desc.gpu_memory_limit;
  if (limit && (bytes > limit || gpu->memory > limit - bytes))
    return pni_fail(gpu, PN_ERROR_OUT_OF_MEMORY, PN_MESSAGE_GPU_MEMORY,
                    "%zu bytes of GPU memory more would pass the limit of %zu (%zu in use)", bytes, limit, gpu->memory);
  gpu->memory += bytes;
  return PN_OK;
}

void pni_memory_give(pni_gpu *gpu, size_t bytes) { gpu->memory -= bytes; }

pn_result pni_memory_check(pni_gpu *gpu, size_t bytes) {
  bool exhausted = false;
  for (GLenum error; (error = GL(gpu, GetError)()) != GL_NO_ERROR;) {
    if (error == GL_OUT_OF_MEMORY) exhausted = true;
    if (error == GL_CONTEXT_LOST)
      return pni_fail(gpu, PN_ERROR_CONTEXT_LOST, PN_MESSAGE_GL_LOST, "the GL context is lost");
  }
  if (!exhausted) return PN_OK;
  return pni_fail(gpu, PN_ERROR_OUT_OF_MEMORY, PN_MESSAGE_GPU_MEMORY, "the driver has no %zu bytes of GPU memory",
                  bytes);
}

/* ---- textures ---------------------------------------------------------------------------------------------------- */

typedef struct {
  GLenum format, layout, type;
  int bytes, channels;
} format_info;

static const format_info formats[] = {
    {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 1},
    {GL_R16F, GL_RED, GL_FLOAT, 2, 1},
    {GL_R32F, GL_RED, GL_FLOAT, 4, 1},
    {GL_RG32F, GL_RG, GL_FLOAT, 8, 2},
    {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16, 4},
    {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4, 1},
    {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 8, 2},
    {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16, 4},
    {GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT, 2, 1},
    {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, 4, 1},
    {GL_DEPTH_COMPONENT32, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, 4, 1},
    {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4, 1},
    {GL_DEPTH24_STENCIL8, GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8, 4, 1},
    {GL_DEPTH32F_STENCIL8, GL_DEPTH_STENCIL, GL_FLOAT_32_UNSIGNED_INT_24_8_REV, 8, 1},
};

static const format_info *find_format(GLenum format) {
  for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
    if (formats[i].format == format) return &formats[i];
  return NULL;
}

static int half(int size, int level) { return size >> level > 1 ? size >> level : 1; }

static size_t texture_bytes(const pni_texture *t, const format_info *info) {
  size_t bytes = 0;
  for (int level = 0; level < t->levels; level++)
    bytes += (size_t)half(t->width, level) * (size_t)half(t->height, level) * (size_t)(t->layers ? t->layers : 1) *
             (size_t)info->bytes;
  return bytes;
}

/* Allocates the images; the unit used is one the library saves. The number of levels comes first: Mesa allocates by
 * it, and where it has to guess, for small arrays, some images cannot be drawn into. */
static void define_texture(pni_gpu *gpu, const pni_texture *t, const format_info *info) {
  GL(gpu, ActiveTexture)(GL_TEXTURE0 + PNI_UNIT_WORK);
  GL(gpu, BindTexture)(t->target, t->id);
  GL(gpu, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, 0);
  GL(gpu, TexParameteri)(t->target, GL_TEXTURE_MAX_LEVEL, t->levels - 1);
  GL(gpu, TexParameteri)
  (t->target, GL_TEXTURE_MIN_FILTER, t->levels > 1 ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST);
  for (int level = 0; level < t->levels; level++) {
    int width = half(t->width, level), height = half(t->height, level);
    if (t->layers) GL(gpu, TexImage3D)
    (t->target, level, (GLint)t->format, width, height, t->layers, 0, info->layout, info->type, NULL);
    else GL(gpu, TexImage2D)(t->target, level, (GLint)t->format, width, height, 0, info->layout, info->type, NULL); }
  GL(gpu, TexParameteri)(t->target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  GL(gpu, TexParameteri)(t->target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  GL(gpu, TexParameteri)(t->target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  GL(gpu, BindTexture)(t->target, 0);
}

static bool same_shape(const pni_texture *a, const pni_texture *b) {
  return a->id && a->target == b->target && a->format == b->format && a->width == b->width && a->height == b->height &&
         a->layers == b->layers && a->levels == b->levels;
}

pn_result pni_texture_shape(pni_gpu *gpu, pni_texture *texture, GLenum format, int width, int height, int layers,
                            int levels) {
  pni_texture made = {.target = layers ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D,
                      .format = format,
                      .width = width,
                      .height = height,
                      .layers = layers,
                      .levels = levels};
  if (same_shape(texture, &made)) return PN_OK;
  const format_info *info = find_format(format);
  if (!info || width < 1 || height < 1 || width > gpu->can.texture_size_max || height > gpu->can.texture_size_max ||
      layers > gpu->can.layers_max)
    return pni_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_FRAMEBUFFER, "this device has no texture of %d x %d x %d",
                    width, height, layers);
  made.bytes = texture_bytes(&made, info);
  pn_result result = pni_memory_take(gpu, made.bytes);
  if (result != PN_OK) return result;
  GL(gpu, GenTextures)(1, &made.id);
  define_texture(gpu, &made, info);
  result = pni_memory_check(gpu, made.bytes);
  if (result != PN_OK) {
    pni_texture_free(gpu, &made, result == PN_ERROR_CONTEXT_LOST);
    return result;
  }
  pni_texture_free(gpu, texture, false);
  *texture = made;
  return PN_OK;
}

void pni_texture_write(pni_gpu *gpu, const pni_texture *texture, int width, int height, const void *pixels) {
  const format_info *info = find_format(texture->format);
  GL(gpu, ActiveTexture)(GL_TEXTURE0 + PNI_UNIT_WORK);
  GL(gpu, BindTexture)(texture->target, texture->id);
  GL(gpu, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, 0);
  GL(gpu, TexSubImage2D)(texture->target, 0, 0, 0, width, height, info->layout, info->type, pixels);
}

void pni_texture_free(pni_gpu *gpu, pni_texture *texture, bool abandon) {
  if (!texture->id) return;
  if (!abandon) GL(gpu, DeleteTextures)(1, &texture->id);
  pni_memory_give(gpu, texture->bytes);
  memset(texture, 0, sizeof *texture);
}

void pni_texture_image(const pni_texture *t, pn_image *out) {
  const format_info *info = find_format(t->format);
  *out = (pn_image){t->id, t->target, t->format, t->width, t->height, t->layers, info ? info->channels : 0};
}

void pni_bind_texture(pni_gpu *gpu, int unit, GLenum target, pn_gl texture, bool own_parameters) {
  GL(gpu, ActiveTexture)(GL_TEXTURE0 + (GLenum)unit);
  GL(gpu, BindTexture)(target, texture);
  GL(gpu, BindSampler)((GLuint)unit, own_parameters ? 0 : gpu->sampler_nearest);
}

/* ---- passes ------------------------------------------------------------------------------------------------------ */

static void attach(pni_gpu *gpu, GLenum point, const pni_attachment *a) {
  if (a->texture && a->target == GL_TEXTURE_2D_ARRAY)
    GL(gpu, FramebufferTextureLayer)(GL_DRAW_FRAMEBUFFER, point, a->texture, a->level, a->layer);
  else GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, point, GL_TEXTURE_2D, a->texture, a->level);
}

static pn_result attach_all(pni_gpu *gpu, const pni_pass *pass) {
  static const GLenum all[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  GL(gpu, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, gpu->framebuffer);
  GLenum draw[2];
  for (int i = 0; i < 2; i++) {
    attach(gpu, all[i], &pass->color[i]);
    draw[i] = pass->color[i].texture ? all[i] : GL_NONE;
  }
  attach(gpu, GL_DEPTH_ATTACHMENT, &pass->depth);
  GL(gpu, DrawBuffers)(2, draw);
  GLenum status = GL(gpu, CheckFramebufferStatus)(GL_DRAW_FRAMEBUFFER);
  if (status == GL_FRAMEBUFFER_COMPLETE) return PN_OK;
  return pni_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_FRAMEBUFFER,
                  "this device cannot draw into a %d x %d image of texture %u, level %d, layer %d (0x%x)", pass->width,
                  pass->height, pass->color[0].texture ? pass->color[0].texture : pass->depth.texture,
                  pass->color[0].texture ? pass->color[0].level : pass->depth.level,
                  pass->color[0].texture ? pass->color[0].layer : pass->depth.layer, status);
}

static void set_depth(pni_gpu *gpu, const pni_pass *pass) {
  if (!pass->depth.texture) return;
  GL(gpu, Enable)(GL_DEPTH_TEST);
  GL(gpu, DepthMask)(pass->depth_use == PNI_DEPTH_TEST ? GL_FALSE : GL_TRUE);
  if (pass->depth_clamp) GL(gpu, Enable)(GL_DEPTH_CLAMP);
  if (pass->depth_range[1] > 0) pni_set_depth_range(gpu, pass->depth_range[0], pass->depth_range[1]);
  if (pass->depth_use == PNI_DEPTH_WRITE) {
    GL(gpu, DepthFunc)(GL_ALWAYS);
    return;
  }
  if (pass->depth_use == PNI_DEPTH_TEST) return; /* GL_LESS is set */
  bool farthest = pass->depth_use == PNI_DEPTH_FARTHEST;
  GL(gpu, DepthFunc)(farthest ? GL_GREATER : GL_LESS);
  GLfloat nothing = farthest ? 0.0f : 1.0f;
  GL(gpu, ClearBufferfv)(GL_DEPTH, 0, &nothing);
}

pn_result pni_pass_begin(pni_gpu *gpu, const pni_pass *pass) {
  pni_state_neutral(gpu);
  pn_result result = attach_all(gpu, pass);
  if (result != PN_OK) return result;
  pni_set_viewport(gpu, 0, 0, pass->width, pass->height);
  set_depth(gpu, pass);
  pni_set_blend(gpu, pass->blend);
  if (pass->faces == PN_FACES_FRONT || pass->faces == PN_FACES_BACK) {
    GL(gpu, Enable)(GL_CULL_FACE);
    GL(gpu, CullFace)(pass->faces == PN_FACES_FRONT ? GL_BACK : GL_FRONT);
  }
  return PN_OK;
}

void pni_pass_limit(pni_gpu *gpu, const pni_part *part) {
  pni_set_switch(gpu, GL_SCISSOR_TEST, true);
  pni_set_scissor(gpu, part->x, part->y, part->width, part->height);
}

void pni_draw_screen(pni_gpu *gpu) {
  GL(gpu, BindVertexArray)(gpu->vertex_array);
  GL(gpu, DrawArrays)(GL_TRIANGLES, 0, 3);
}

pn_result pni_fill(pni_gpu *gpu, pni_attachment target, int width, int height, float value) {
  pni_pass pass = {.color = {target}, .width = width, .height = height};
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  const GLfloat values[4] = {value, value, value, 1};
  pni_set_switch(gpu, GL_SCISSOR_TEST, true);
  pni_set_scissor(gpu, 0, 0, width, height);
  GL(gpu, ClearBufferfv)(GL_COLOR, 0, values);
  pni_set_switch(gpu, GL_SCISSOR_TEST, false);
  return PN_OK;
}

pn_result pni_screen_begin(pni_gpu *gpu, const pni_pass *pass, const pni_program *program) {
  pn_result result = pni_pass_begin(gpu, pass);
  if (result == PN_OK) GL(gpu, UseProgram)(program->id);
  return result;
}

/* ---- buffers ----------------------------------------------------------------------------------------------------- */

static pn_result buffer_make(pni_gpu *gpu, pni_buffer *buffer, size_t bytes) {
  if (buffer->id) return PN_OK;
  pn_result result = pni_memory_take(gpu, bytes);
  if (result != PN_OK) return result;
  GL(gpu, GenBuffers)(1, &buffer->id);
  buffer->bytes = bytes;
  return PN_OK;
}

pn_result pni_uniform_buffer_set(pni_gpu *gpu, pni_buffer *buffer, const void *data, size_t bytes) {
  pn_result result = buffer_make(gpu, buffer, bytes);
  if (result != PN_OK) return result;
  GL(gpu, BindBuffer)(GL_UNIFORM_BUFFER, buffer->id);
  GL(gpu, BufferData)(GL_UNIFORM_BUFFER, (GLsizeiptr)bytes, data, GL_STREAM_DRAW);
  return PN_OK;
}

void pni_buffer_free(pni_gpu *gpu, pni_buffer *buffer, bool abandon) {
  if (!buffer->id) return;
  if (!abandon) GL(gpu, DeleteBuffers)(1, &buffer->id);
  pni_memory_give(gpu, buffer->bytes);
  memset(buffer, 0, sizeof *buffer);
}

/* ---- draws that the GPU counts ----------------------------------------------------------------------------------- */

void pni_read_from(pni_gpu *gpu, const pni_texture *texture, int level, int layer) {
  GL(gpu, BindFramebuffer)(GL_READ_FRAMEBUFFER, gpu->read_framebuffer);
  GL(gpu, FramebufferTexture2D)(GL_READ_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
  if (texture->layers) GL(gpu, FramebufferTextureLayer)
  (GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, texture->id, level, layer);
  else GL(gpu, FramebufferTexture2D)(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture->id, level);
  GL(gpu, ReadBuffer)(GL_COLOR_ATTACHMENT0);
}

void pni_copy_to_layer(pni_gpu *gpu, const pni_texture *from, const pni_texture *to, int layer) {
  pni_read_from(gpu, from, 0, 0);
  GL(gpu, ActiveTexture)(GL_TEXTURE0 + PNI_UNIT_WORK);
  GL(gpu, BindTexture)(to->target, to->id);
  GL(gpu, CopyTexSubImage3D)(to->target, 0, 0, 0, layer, 0, 0, from->width, from->height);
}

enum { ARGUMENT_BYTES = 16 }; /* four unsigned integers: GL's DrawArraysIndirectCommand */

pn_result pni_counts_take(pni_gpu *gpu, const pni_texture *arguments, pni_buffer *buffer) {
  if (!gpu->can.indirect) return PN_OK;
  size_t bytes = ARGUMENT_BYTES * (size_t)arguments->width;
  bool fresh = !buffer->id;
  pn_result result = buffer_make(gpu, buffer, bytes);
  if (result != PN_OK) return result;
  GL(gpu, BindBuffer)(GL_PIXEL_PACK_BUFFER, buffer->id);
  if (fresh) GL(gpu, BufferData)(GL_PIXEL_PACK_BUFFER, (GLsizeiptr)bytes, NULL, GL_STREAM_DRAW);
  pni_read_from(gpu, arguments, 0, 0);
  GL(gpu, ReadPixels)(0, 0, arguments->width, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, NULL);
  GL(gpu, BindBuffer)(GL_PIXEL_PACK_BUFFER, 0);
  return PN_OK;
}

void pni_draw_counted(pni_gpu *gpu, const pni_buffer *buffer, int index, int most) {
  GL(gpu, BindVertexArray)(gpu->vertex_array);
  if (!gpu->can.indirect) {
    GL(gpu, DrawArrays)(GL_TRIANGLES, 0, most);
    return;
  }
  GL(gpu, BindBuffer)(GL_DRAW_INDIRECT_BUFFER, buffer->id);
  GL(gpu, DrawArraysIndirect)(GL_TRIANGLES, (const void *)(uintptr_t)(ARGUMENT_BYTES * index));
}
