#include "gl/host_texture.h"

#include <string.h>

#include "gl/bound.h"

static const GLint identity[4] = {GL_RED, GL_GREEN, GL_BLUE, GL_ALPHA};

/* By name where the device can; else the texture is bound. */
static void get(pni_gpu *gpu, const pni_host_texture *t, GLenum name, GLint *out) {
  if (gpu->can.by_name) GL(gpu, GetTextureParameteriv)(t->texture, name, out);
  else GL(gpu, GetTexParameteriv)(t->target, name, out);
}

static GLint get_level(pni_gpu *gpu, const pni_host_texture *t, GLint level, GLenum name) {
  GLint value = 0;
  if (gpu->can.by_name) GL(gpu, GetTextureLevelParameteriv)(t->texture, level, name, &value);
  else GL(gpu, GetTexLevelParameteriv)(t->target, level, name, &value);
  return value;
}

bool pni_texture_exists(pni_gpu *gpu, pn_gl texture) { return texture && GL(gpu, IsTexture)(texture); }

enum { PENDING_MOST = 64 }; /* a lost context has errors without end */

static void drop_errors(pni_gpu *gpu) {
  for (int i = 0; i < PENDING_MOST && GL(gpu, GetError)() != GL_NO_ERROR; i++) {
  }
}

/* Where textures cannot be asked for their kind: by binding it, which is an error that nobody is to hear of. */
static bool try_target(pni_gpu *gpu, pn_gl texture, GLenum target) {
  pni_ready(gpu);
  pni_bind_scratch(gpu, target, 0);
  bool heard = gpu->can.labels && GL(gpu, IsEnabled)(GL_DEBUG_OUTPUT);
  if (heard) GL(gpu, Disable)(GL_DEBUG_OUTPUT);
  drop_errors(gpu);
  GL(gpu, BindTexture)(target, texture);
  bool is = GL(gpu, GetError)() == GL_NO_ERROR;
  GL(gpu, BindTexture)(target, 0);
  drop_errors(gpu);
  if (heard) GL(gpu, Enable)(GL_DEBUG_OUTPUT);
  return is;
}

bool pni_texture_is(pni_gpu *gpu, pn_gl texture, GLenum target) {
  GLint is = GL_NONE;
  if (!pni_texture_exists(gpu, texture)) return false;
  if (!gpu->can.targets) return try_target(gpu, texture, target);
  GL(gpu, GetTextureParameteriv)(texture, GL_TEXTURE_TARGET, &is);
  return (GLenum)is == target;
}

static void bind(pni_gpu *gpu, const pni_host_texture *t) {
  pni_ready(gpu);
  pni_bind_scratch(gpu, t->target, t->texture);
}

static void read_parameters(pni_gpu *gpu, pni_host_texture *t) {
  get(gpu, t, GL_TEXTURE_BASE_LEVEL, &t->base);
  get(gpu, t, GL_TEXTURE_SWIZZLE_RGBA, t->swizzle);
  t->stencil_mode = GL_DEPTH_COMPONENT;
  if (gpu->can.stencil_texturing) get(gpu, t, GL_DEPTH_STENCIL_TEXTURE_MODE, &t->stencil_mode);
  t->width = get_level(gpu, t, 0, GL_TEXTURE_WIDTH);
  t->height = get_level(gpu, t, 0, GL_TEXTURE_HEIGHT);
  t->depth_bits = get_level(gpu, t, 0, GL_TEXTURE_DEPTH_SIZE);
}

static void set_parameters(pni_gpu *gpu, const pni_host_texture *t, GLint base, const GLint *swizzle,
                           GLint stencil_mode) {
  bool odd_swizzle = memcmp(t->swizzle, identity, sizeof identity) != 0;
  if (t->base == 0 && !odd_swizzle && t->stencil_mode == GL_DEPTH_COMPONENT) return;
  bind(gpu, t);
  if (t->base != 0) GL(gpu, TexParameteri)(t->target, GL_TEXTURE_BASE_LEVEL, base);
  if (odd_swizzle) GL(gpu, TexParameteriv)(t->target, GL_TEXTURE_SWIZZLE_RGBA, swizzle);
  if (t->stencil_mode != GL_DEPTH_COMPONENT)
    GL(gpu, TexParameteri)(t->target, GL_DEPTH_STENCIL_TEXTURE_MODE, stencil_mode);
  pni_bind_scratch(gpu, t->target, 0);
}

bool pni_host_texture_open(pni_gpu *gpu, pn_gl texture, bool multisample, pni_host_texture *out) {
  pni_host_texture t = {.texture = texture, .target = multisample ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D};
  *out = (pni_host_texture){0};
  if (!pni_texture_is(gpu, texture, t.target)) return false;
  if (!gpu->can.by_name) bind(gpu, &t);
  read_parameters(gpu, &t);
  if (!gpu->can.by_name) pni_bind_scratch(gpu, t.target, 0);
  set_parameters(gpu, &t, 0, identity, GL_DEPTH_COMPONENT);
  *out = t;
  return true;
}

void pni_host_texture_close(pni_gpu *gpu, pni_host_texture *t) {
  if (t->texture) set_parameters(gpu, t, t->base, t->swizzle, t->stencil_mode);
  *t = (pni_host_texture){0};
}

static int half(int size) { return size > 1 ? size / 2 : 1; }

/* Whether levels base + 1 to last are each half of the one before, down to one texel. */
static bool has_levels(pni_gpu *gpu, const pni_host_texture *t, GLint base, GLint last) {
  int width = get_level(gpu, t, base, GL_TEXTURE_WIDTH), height = get_level(gpu, t, base, GL_TEXTURE_HEIGHT);
  for (GLint level = base + 1; level <= last && (width > 1 || height > 1); level++) {
    width = half(width);
    height = half(height);
    if (get_level(gpu, t, level, GL_TEXTURE_WIDTH) != width || get_level(gpu, t, level, GL_TEXTURE_HEIGHT) != height)
      return false;
  }
  return width > 0;
}

bool pni_host_texture_complete(pni_gpu *gpu, pn_gl texture) {
  pni_host_texture t = {.texture = texture, .target = GL_TEXTURE_2D};
  GLint filter = GL_LINEAR, base = 0, last = 0;
  bind(gpu, &t);
  get(gpu, &t, GL_TEXTURE_MIN_FILTER, &filter);
  get(gpu, &t, GL_TEXTURE_BASE_LEVEL, &base);
  get(gpu, &t, GL_TEXTURE_MAX_LEVEL, &last);
  bool complete = has_levels(gpu, &t, base, filter == GL_NEAREST || filter == GL_LINEAR ? base : last);
  pni_bind_scratch(gpu, t.target, 0);
  return complete;
}
