#include "gl/texture.h"

#include <stdint.h>
#include <string.h>

#include "gl/bound.h"
#include "gl/host.h"
#include "gl/label.h"

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

/* ---- formats ----------------------------------------------------------------------------------------------------- */

typedef struct {
  GLenum format, layout, type;
  int bytes, channels;
} format_info;

static const format_info formats[PNI_FORMAT_COUNT] = {
    [PNI_R8] = {GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 1},
    [PNI_R16F] = {GL_R16F, GL_RED, GL_FLOAT, 2, 1},
    [PNI_R32F] = {GL_R32F, GL_RED, GL_FLOAT, 4, 1},
    [PNI_RG32F] = {GL_RG32F, GL_RG, GL_FLOAT, 8, 2},
    [PNI_RGBA32F] = {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16, 4},
    [PNI_R32UI] = {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4, 1},
    [PNI_RG32UI] = {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 8, 2},
    [PNI_RGBA32UI] = {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16, 4},
    [PNI_DEPTH16] = {GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT, 2, 1},
    [PNI_DEPTH24] = {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, 4, 1},
    [PNI_DEPTH32] = {GL_DEPTH_COMPONENT32, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, 4, 1},
    [PNI_DEPTH32F] = {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4, 1},
    [PNI_DEPTH24_STENCIL8] = {GL_DEPTH24_STENCIL8, GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8, 4, 1},
    [PNI_DEPTH32F_STENCIL8] = {GL_DEPTH32F_STENCIL8, GL_DEPTH_STENCIL, GL_FLOAT_32_UNSIGNED_INT_24_8_REV, 8, 1},
};

static bool is_depth(const pni_texture *t) { return t->format >= PNI_DEPTH16; }

/* ---- textures ---------------------------------------------------------------------------------------------------- */

static GLenum target_of(const pni_texture *t) { return t->layers ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D; }

static int half(int size, int level) { return size >> level > 1 ? size >> level : 1; }

static size_t texture_bytes(const pni_texture *t) {
  size_t bytes = 0;
  for (int level = 0; level < t->levels; level++)
    bytes += (size_t)half(t->width, level) * (size_t)half(t->height, level) * (size_t)(t->layers ? t->layers : 1) *
             (size_t)formats[t->format].bytes;
  return bytes;
}

/* The number of levels comes first: Mesa allocates by it, and where it has to guess, for small arrays, some images
 * cannot be drawn into. */
static void define_texture(pni_gpu *gpu, const pni_texture *t) {
  GLenum target = target_of(t);
  const format_info *info = &formats[t->format];
  pni_bind_scratch(gpu, target, t->id);
  GL(gpu, TexParameteri)(target, GL_TEXTURE_MAX_LEVEL, t->levels - 1);
  GL(gpu, TexParameteri)(target, GL_TEXTURE_MIN_FILTER, t->levels > 1 ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST);
  for (int level = 0; level < t->levels; level++) {
    int w = half(t->width, level), h = half(t->height, level);
    GLint format = (GLint)info->format;
    if (t->layers) GL(gpu, TexImage3D)(target, level, format, w, h, t->layers, 0, info->layout, info->type, NULL);
    else GL(gpu, TexImage2D)(target, level, format, w, h, 0, info->layout, info->type, NULL);
  }
  GL(gpu, TexParameteri)(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  GL(gpu, TexParameteri)(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  GL(gpu, TexParameteri)(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

static bool same_shape(const pni_texture *a, const pni_texture *b) {
  return a->id && a->format == b->format && a->width == b->width && a->height == b->height && a->layers == b->layers &&
         a->levels == b->levels;
}

static void delete_texture(pni_gpu *gpu, pni_texture *texture) {
  if (!texture->id) return;
  pni_texture_gone(gpu, texture->id);
  GL(gpu, DeleteTextures)(1, &texture->id);
  pni_memory_give(gpu, texture->bytes);
  *texture = (pni_texture){0};
}

/* ---- textures that replace others while a call is planned -------------------------------------------------------- */

typedef struct pni_replaced {
  pni_texture *at, before; /* before: id 0 where there was none */
} pni_replaced;

/* Room for one more, before anything is made. */
static bool room_to_replace(pni_gpu *gpu) {
  pni_plan *plan = &gpu->plan;
  if (!plan->keep || plan->count < plan->capacity) return true;
  int more = plan->capacity ? 2 * plan->capacity : 16;
  pni_replaced *grown = pni_reallocate(gpu, plan->replaced, (size_t)more * sizeof *grown);
  if (!grown) return false;
  plan->replaced = grown;
  plan->capacity = more;
  return true;
}

static void replace(pni_gpu *gpu, pni_texture *texture, const pni_texture *made) {
  pni_plan *plan = &gpu->plan;
  plan->made = true;
  if (plan->keep) plan->replaced[plan->count++] = (pni_replaced){texture, *texture};
  else delete_texture(gpu, texture);
  *texture = *made;
}

void pni_textures_settle(pni_gpu *gpu, bool replaced) {
  pni_plan *plan = &gpu->plan;
  while (plan->count > 0) {
    pni_replaced *r = &plan->replaced[--plan->count];
    delete_texture(gpu, replaced ? &r->before : r->at);
    if (!replaced) *r->at = r->before;
  }
}

/* ---- making ------------------------------------------------------------------------------------------------------ */

pn_result pni_texture_shape(pni_gpu *gpu, pni_texture *texture, const char *label, pni_format format, int width,
                            int height, int layers, int levels) {
  pni_texture made = {.format = format, .width = width, .height = height, .layers = layers, .levels = levels};
  if (same_shape(texture, &made)) return PN_OK;
  int most = gpu->can.texture_size_max;
  if (width < 1 || height < 1 || width > most || height > most || layers > gpu->can.layers_max)
    return pni_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_FRAMEBUFFER, "this device has no texture of %d x %d x %d",
                    width, height, layers);
  made.bytes = texture_bytes(&made);
  pn_result result = room_to_replace(gpu) ? pni_memory_take(gpu, made.bytes) : PN_ERROR_OUT_OF_MEMORY;
  if (result != PN_OK) return result;
  pni_ready(gpu);
  GL(gpu, GenTextures)(1, &made.id);
  define_texture(gpu, &made);
  pni_label(gpu, GL_TEXTURE, made.id, label);
  result = pni_memory_check(gpu, made.bytes);
  if (result != PN_OK) {
    pni_texture_free(gpu, &made, result == PN_ERROR_CONTEXT_LOST);
    return result;
  }
  replace(gpu, texture, &made);
  return PN_OK;
}

void pni_texture_free(pni_gpu *gpu, pni_texture *texture, bool abandon) {
  if (!texture->id) return;
  if (!abandon) {
    delete_texture(gpu, texture);
    return;
  }
  pni_memory_give(gpu, texture->bytes);
  memset(texture, 0, sizeof *texture);
}

void pni_texture_spare(pni_gpu *gpu, pni_texture *texture) {
  if (!gpu->plan.on) pni_texture_free(gpu, texture, false);
}

void pni_texture_describe(const pni_texture *t, pn_image *out) {
  const format_info *info = &formats[t->format];
  *out = (pn_image){t->id, target_of(t), info->format, t->width, t->height, t->layers, info->channels};
}

pni_image pni_image_of(const pni_texture *texture, int level, int layer) {
  return (pni_image){texture->id, texture->layers > 0, level, layer};
}

void pni_texture_limit(pni_gpu *gpu, const pni_texture *texture, int first, int last) {
  if (gpu->plan.on) return;
  pni_bind_scratch(gpu, target_of(texture), texture->id);
  GL(gpu, TexParameteri)(target_of(texture), GL_TEXTURE_BASE_LEVEL, first);
  GL(gpu, TexParameteri)(target_of(texture), GL_TEXTURE_MAX_LEVEL, last);
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

void pni_texture_write(pni_gpu *gpu, const pni_texture *t, const void *texels, size_t count) {
  const format_info *info = &formats[t->format];
  size_t row = (size_t)t->width, rows = count / row, rest = count % row;
  const char *last = (const char *)texels + rows * row * (size_t)info->bytes;
  pni_ready(gpu);
  pni_bind_scratch(gpu, GL_TEXTURE_2D, t->id);
  if (rows) GL(gpu, TexSubImage2D)(GL_TEXTURE_2D, 0, 0, 0, t->width, (GLsizei)rows, info->layout, info->type, texels);
  if (rest) GL(gpu, TexSubImage2D)
  (GL_TEXTURE_2D, 0, 0, (GLint)rows, (GLsizei)rest, 1, info->layout, info->type, last);
}

void pni_texture_write_row(pni_gpu *gpu, const pni_texture *t, int row, const void *texels, int count) {
  const format_info *info = &formats[t->format];
  pni_ready(gpu);
  pni_bind_scratch(gpu, GL_TEXTURE_2D, t->id);
  GL(gpu, TexSubImage2D)(GL_TEXTURE_2D, 0, 0, row, count, 1, info->layout, info->type, texels);
}

void pni_texture_write_from(pni_gpu *gpu, const pni_texture *t, pn_gl buffer, size_t offset, size_t count) {
  pni_ready(gpu);
  GL(gpu, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, buffer);
  pni_texture_write(gpu, t, (const void *)(uintptr_t)offset, count);
  GL(gpu, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, 0);
}

/* ---- reading and copying ----------------------------------------------------------------------------------------- */

static void attach_for_reading(pni_gpu *gpu, GLenum point, const pni_texture *t, int level, int layer) {
  if (t && t->layers) GL(gpu, FramebufferTextureLayer)(GL_READ_FRAMEBUFFER, point, t->id, level, layer);
  else GL(gpu, FramebufferTexture2D)(GL_READ_FRAMEBUFFER, point, GL_TEXTURE_2D, t ? t->id : 0, level);
}

void pni_read_from(pni_gpu *gpu, const pni_texture *texture, int level, int layer) {
  bool depth = is_depth(texture);
  pni_ready(gpu);
  pni_bind_read_framebuffer(gpu);
  attach_for_reading(gpu, GL_DEPTH_ATTACHMENT, depth ? texture : NULL, level, layer);
  attach_for_reading(gpu, GL_COLOR_ATTACHMENT0, depth ? NULL : texture, level, layer);
  GL(gpu, ReadBuffer)(depth ? GL_NONE : GL_COLOR_ATTACHMENT0);
}

void pni_texture_read(pni_gpu *gpu, const pni_texture *texture, int level, int layer, int width, int height,
                      int channels, void *out) {
  static const GLenum floats[] = {0, GL_RED, GL_RG, 0, GL_RGBA};
  static const GLenum integers[] = {0, GL_RED_INTEGER, GL_RG_INTEGER, 0, GL_RGBA_INTEGER};
  bool integer = formats[texture->format].type == GL_UNSIGNED_INT;
  if (gpu->plan.on) return;
  pni_read_from(gpu, texture, level, layer);
  GL(gpu, ReadPixels)
  (0, 0, width, height, (integer ? integers : floats)[channels], integer ? GL_UNSIGNED_INT : GL_FLOAT, out);
}

/* Depth cannot be copied into a texture that way; a blit can, from framebuffer to framebuffer. */
static void blit_depth(pni_gpu *gpu, const pni_texture *from, const pni_texture *to, int layer) {
  pni_bind_framebuffer(gpu);
  gpu->bound.attached = false;
  GL(gpu, FramebufferTextureLayer)(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, to->id, 0, layer);
  for (GLenum i = 0; i < 2; i++)
    GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + i, GL_TEXTURE_2D, 0, 0);
  pni_set_scissor_test(gpu, false);
  GL(gpu, BlitFramebuffer)
  (0, 0, from->width, from->height, 0, 0, from->width, from->height, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
}

void pni_copy_part_to_layer(pni_gpu *gpu, const pni_texture *from, const pni_texture *to, int layer, int x, int y,
                            int width, int height) {
  if (gpu->plan.on) return;
  pni_read_from(gpu, from, 0, 0);
  pni_bind_scratch(gpu, target_of(to), to->id);
  GL(gpu, CopyTexSubImage3D)(target_of(to), 0, x, y, layer, x, y, width, height);
}

void pni_copy_to_layer(pni_gpu *gpu, const pni_texture *from, const pni_texture *to, int layer) {
  if (gpu->plan.on) return;
  pni_read_from(gpu, from, 0, 0);
  if (is_depth(from)) {
    blit_depth(gpu, from, to, layer);
    return;
  }
  pni_bind_scratch(gpu, target_of(to), to->id);
  GL(gpu, CopyTexSubImage3D)(target_of(to), 0, 0, 0, layer, 0, 0, from->width, from->height);
}
