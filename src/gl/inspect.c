#include "gl/inspect.h"

#include "gl/bound.h"
#include "gl/host_texture.h"
#include "gl/pass.h"

bool pni_texture_is_2d(pni_gpu *gpu, pn_gl texture) { return pni_texture_is(gpu, texture, GL_TEXTURE_2D); }

bool pni_framebuffer_exists(pni_gpu *gpu, pn_gl framebuffer) { return GL(gpu, IsFramebuffer)(framebuffer); }

/* ---- depth ------------------------------------------------------------------------------------------------------- */

static GLint attachment_parameter(pni_gpu *gpu, GLenum target, GLenum point, GLenum name) {
  GLint value = 0;
  GL(gpu, GetFramebufferAttachmentParameteriv)(target, point, name, &value);
  return value;
}

static bool read_depth(pni_gpu *gpu, GLenum target, GLenum point, pni_depth_source *out) {
  if (attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_NONE) return false;
  out->depth_bits = attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE);
  out->stencil_bits = attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE);
  out->is_float = attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE) == GL_FLOAT;
  return out->depth_bits > 0;
}

/* Of the draw framebuffer. */
static void read_samples(pni_gpu *gpu, pni_depth_source *out) {
  out->at[0] = out->at[1] = 0.5f;
  GL(gpu, GetIntegerv)(GL_SAMPLES, &out->samples);
  if (out->samples > 0) GL(gpu, GetMultisamplefv)(GL_SAMPLE_POSITION, 0, out->at);
}

/* The passes' framebuffer with nothing attached but what is looked at. */
static void clear_framebuffer(pni_gpu *gpu) {
  pni_ready(gpu);
  pni_bind_framebuffer(gpu);
  gpu->bound.attached = false;
  GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
  for (GLenum i = 0; i < 2; i++)
    GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + i, GL_TEXTURE_2D, 0, 0);
}

bool pni_inspect_depth(pni_gpu *gpu, pn_gl texture, pni_depth_source *out) {
  GLenum none = GL_NONE;
  if (!pni_texture_is_2d(gpu, texture) && !pni_texture_is(gpu, texture, GL_TEXTURE_2D_MULTISAMPLE)) return false;
  clear_framebuffer(gpu);
  GL(gpu, DrawBuffers)(1, &none);
  GL(gpu, FramebufferTexture)(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, texture, 0);
  bool sound = GL(gpu, CheckFramebufferStatus)(GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE &&
               read_depth(gpu, GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, out) &&
               !attachment_parameter(gpu, GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_FRAMEBUFFER_ATTACHMENT_LAYERED);
  if (sound) read_samples(gpu, out);
  GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
  return sound;
}

static void bind_host(pni_gpu *gpu, GLenum target, pn_gl framebuffer) {
  GL(gpu, BindFramebuffer)(target, framebuffer);
  *(target == GL_READ_FRAMEBUFFER ? &gpu->bound.read_framebuffer : &gpu->bound.framebuffer) = framebuffer;
}

/* Its size, which framebuffers themselves cannot be asked for; as large as there are textures where it is not told. */
static void read_size(pni_gpu *gpu, pn_gl framebuffer, pni_depth_source *out) {
  GLenum target = GL_READ_FRAMEBUFFER, point = GL_DEPTH_ATTACHMENT;
  out->width = out->height = gpu->can.texture_size_max;
  if (!framebuffer || !gpu->can.by_name) return;
  GLuint name = (GLuint)attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME);
  if (attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_RENDERBUFFER) {
    GL(gpu, GetNamedRenderbufferParameteriv)(name, GL_RENDERBUFFER_WIDTH, &out->width);
    GL(gpu, GetNamedRenderbufferParameteriv)(name, GL_RENDERBUFFER_HEIGHT, &out->height);
  } else {
    GLint level = attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL);
    GL(gpu, GetTextureLevelParameteriv)(name, level, GL_TEXTURE_WIDTH, &out->width);
    GL(gpu, GetTextureLevelParameteriv)(name, level, GL_TEXTURE_HEIGHT, &out->height);
  }
}

bool pni_inspect_framebuffer(pni_gpu *gpu, pn_gl framebuffer, pni_depth_source *out) {
  pni_ready(gpu);
  bind_host(gpu, GL_READ_FRAMEBUFFER, framebuffer);
  GLenum status = GL(gpu, CheckFramebufferStatus)(GL_READ_FRAMEBUFFER);
  GLenum point = framebuffer ? GL_DEPTH_ATTACHMENT : GL_DEPTH;
  if (status != GL_FRAMEBUFFER_COMPLETE || !read_depth(gpu, GL_READ_FRAMEBUFFER, point, out)) return false;
  read_size(gpu, framebuffer, out);
  bind_host(gpu, GL_DRAW_FRAMEBUFFER, framebuffer);
  read_samples(gpu, out);
  return true;
}

pni_format pni_depth_format(const pni_depth_source *source) {
  if (source->is_float) return source->stencil_bits ? PNI_DEPTH32F_STENCIL8 : PNI_DEPTH32F;
  if (source->stencil_bits) return PNI_DEPTH24_STENCIL8;
  if (source->depth_bits == 16) return PNI_DEPTH16;
  return source->depth_bits == 32 ? PNI_DEPTH32 : PNI_DEPTH24;
}

pn_result pni_copy_depth(pni_gpu *gpu, pn_gl framebuffer, int x, int y, const pni_texture *to) {
  pni_pass pass = {.name = "copy of depth",
                   .depth = pni_image_of(to, 0, 0),
                   .width = to->width,
                   .height = to->height,
                   .depth_use = PNI_DEPTH_WRITE};
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK || gpu->plan.on) return result;
  bind_host(gpu, GL_READ_FRAMEBUFFER, framebuffer);
  GL(gpu, BlitFramebuffer)
  (x, y, x + to->width, y + to->height, 0, 0, to->width, to->height, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  return PN_OK;
}

/* ---- textures ---------------------------------------------------------------------------------------------------- */

static GLint level_parameter(pni_gpu *gpu, GLenum target, GLenum name) {
  GLint value = 0;
  GL(gpu, GetTexLevelParameteriv)(target, 0, name, &value);
  return value;
}

void pni_inspect_size(pni_gpu *gpu, pn_gl texture, bool multisample, int *width, int *height) {
  GLenum target = multisample ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D;
  pni_ready(gpu);
  pni_bind_scratch(gpu, target, texture);
  *width = level_parameter(gpu, target, GL_TEXTURE_WIDTH);
  *height = level_parameter(gpu, target, GL_TEXTURE_HEIGHT);
  pni_bind_scratch(gpu, target, 0);
}

pni_color_source pni_inspect_color(pni_gpu *gpu, pn_gl texture) {
  static const GLenum sizes[3] = {GL_TEXTURE_RED_SIZE, GL_TEXTURE_GREEN_SIZE, GL_TEXTURE_BLUE_SIZE};
  pni_color_source out = {0};
  pni_ready(gpu);
  pni_bind_scratch(gpu, GL_TEXTURE_2D, texture);
  int type = level_parameter(gpu, GL_TEXTURE_2D, GL_TEXTURE_RED_TYPE);
  if (type != GL_INT && type != GL_UNSIGNED_INT) out.bits = level_parameter(gpu, GL_TEXTURE_2D, sizes[0]);
  while (out.bits > 0 && out.channels < 3 && level_parameter(gpu, GL_TEXTURE_2D, sizes[out.channels]) > 0)
    out.channels++;
  out.is_float = type == GL_FLOAT;
  pni_bind_scratch(gpu, GL_TEXTURE_2D, 0);
  return out;
}

/* Of what is attached for drawing; integers are none. */
static int color_channels(pni_gpu *gpu) {
  static const GLenum sizes[4] = {GL_FRAMEBUFFER_ATTACHMENT_RED_SIZE, GL_FRAMEBUFFER_ATTACHMENT_GREEN_SIZE,
                                  GL_FRAMEBUFFER_ATTACHMENT_BLUE_SIZE, GL_FRAMEBUFFER_ATTACHMENT_ALPHA_SIZE};
  GLenum target = GL_DRAW_FRAMEBUFFER, point = GL_COLOR_ATTACHMENT0;
  GLint type = attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE);
  int channels = 0;
  for (int i = 0; i < 4 && type != GL_INT && type != GL_UNSIGNED_INT; i++)
    if (attachment_parameter(gpu, target, point, sizes[i]) > 0) channels |= 1 << i;
  return channels;
}

bool pni_inspect_target(pni_gpu *gpu, pn_gl texture, pni_target_kind *out) {
  GLenum color = GL_COLOR_ATTACHMENT0;
  GLint layered = 0, samples = 0;
  int channels = 0;
  if (!texture || !pni_texture_exists(gpu, texture)) return false;
  clear_framebuffer(gpu);
  GL(gpu, FramebufferTexture)(GL_DRAW_FRAMEBUFFER, color, texture, 0);
  GL(gpu, DrawBuffers)(1, &color);
  bool sound = GL(gpu, CheckFramebufferStatus)(GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  if (sound) layered = attachment_parameter(gpu, GL_DRAW_FRAMEBUFFER, color, GL_FRAMEBUFFER_ATTACHMENT_LAYERED);
  if (sound) channels = color_channels(gpu);
  if (sound) GL(gpu, GetIntegerv)(GL_SAMPLES, &samples);
  GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, color, GL_TEXTURE_2D, 0, 0);
  GLenum target = layered ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
  if (!sound || samples > 0 || !pni_texture_is(gpu, texture, target)) return false;
  pni_bind_scratch(gpu, target, texture);
  *out = (pni_target_kind){layered != 0, level_parameter(gpu, target, GL_TEXTURE_WIDTH),
                           level_parameter(gpu, target, GL_TEXTURE_HEIGHT),
                           layered ? level_parameter(gpu, target, GL_TEXTURE_DEPTH) : 1, channels};
  pni_bind_scratch(gpu, target, 0);
  return true;
}
