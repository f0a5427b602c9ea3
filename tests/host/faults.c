#include "faults.h"

#include <stdlib.h>
#include <string.h>

#include "gl.h"

static struct {
  fault_kind kind;
  long at, seen;
  int hit;
  int exhausted; /* glGetError has to say so */
  GLuint banned; /* a texture that cannot be drawn into */
  GLuint attached[3];
} f;

void faults_arm(fault_kind kind, long at) {
  f.kind = kind;
  f.at = at;
  f.seen = 0;
  f.hit = f.exhausted = 0;
  f.banned = 0;
}

int faults_disarm(int *enough) {
  *enough = f.seen >= f.at;
  f.at = 0;
  return f.hit;
}

static int counts(fault_kind kind) { return kind == f.kind && f.at != 0 && ++f.seen == f.at; }

static int fails(fault_kind kind) {
  if (!counts(kind)) return 0;
  f.hit = 1;
  return 1;
}

void *faults_allocate(void *user, void *old, size_t bytes) {
  (void)user;
  if (bytes == 0) {
    free(old);
    return NULL;
  }
  return fails(FAULT_MEMORY) ? NULL : realloc(old, bytes);
}

/* ---- GL ---------------------------------------------------------------------------------------------------------- */

static PFNGLGETERRORPROC get_error;
static PFNGLTEXIMAGE2DPROC tex_image_2d;
static PFNGLTEXIMAGE3DPROC tex_image_3d;
static PFNGLBUFFERDATAPROC buffer_data;
static PFNGLGETBUFFERPARAMETERIVPROC get_buffer;
static PFNGLGETSHADERIVPROC get_shader;
static PFNGLGETPROGRAMIVPROC get_program;
static PFNGLCHECKFRAMEBUFFERSTATUSPROC check_framebuffer;
static PFNGLGENTEXTURESPROC gen_textures;
static PFNGLFRAMEBUFFERTEXTUREPROC framebuffer_texture;
static PFNGLFRAMEBUFFERTEXTURE2DPROC framebuffer_texture_2d;
static PFNGLFRAMEBUFFERTEXTURELAYERPROC framebuffer_texture_layer;

static GLenum APIENTRY on_get_error(void) {
  int exhausted = f.exhausted;
  f.exhausted = 0;
  return exhausted ? GL_OUT_OF_MEMORY : get_error();
}

static void APIENTRY on_tex_image_2d(GLenum target, GLint level, GLint internal, GLsizei width, GLsizei height,
                                     GLint border, GLenum format, GLenum type, const void *pixels) {
  if (fails(FAULT_GL_MEMORY)) f.exhausted = 1;
  tex_image_2d(target, level, internal, width, height, border, format, type, pixels);
}

static void APIENTRY on_tex_image_3d(GLenum target, GLint level, GLint internal, GLsizei width, GLsizei height,
                                     GLsizei depth, GLint border, GLenum format, GLenum type, const void *pixels) {
  if (fails(FAULT_GL_MEMORY)) f.exhausted = 1;
  tex_image_3d(target, level, internal, width, height, depth, border, format, type, pixels);
}

/* What has the same size as before is written into memory that there is. */
static void APIENTRY on_buffer_data(GLenum target, GLsizeiptr bytes, const void *data, GLenum usage) {
  GLint before = 0;
  get_buffer(target, GL_BUFFER_SIZE, &before);
  if (before != bytes && fails(FAULT_GL_MEMORY)) f.exhausted = 1;
  buffer_data(target, bytes, data, usage);
}

static void APIENTRY on_get_shader(GLuint shader, GLenum name, GLint *out) {
  get_shader(shader, name, out);
  if (name == GL_COMPILE_STATUS && fails(FAULT_COMPILE)) *out = GL_FALSE;
}

static void APIENTRY on_get_program(GLuint program, GLenum name, GLint *out) {
  get_program(program, name, out);
  if (name == GL_LINK_STATUS && fails(FAULT_LINK)) *out = GL_FALSE;
}

static void APIENTRY on_gen_textures(GLsizei count, GLuint *out) {
  gen_textures(count, out);
  if (counts(FAULT_FRAMEBUFFER)) f.banned = out[0];
}

static void attach(GLenum target, GLenum point, GLuint texture) {
  if (target == GL_DRAW_FRAMEBUFFER)
    f.attached[point == GL_DEPTH_ATTACHMENT ? 2 : point - GL_COLOR_ATTACHMENT0] = texture;
}

static void APIENTRY on_framebuffer_texture(GLenum target, GLenum point, GLuint texture, GLint level) {
  attach(target, point, texture);
  framebuffer_texture(target, point, texture, level);
}

static void APIENTRY on_framebuffer_texture_2d(GLenum target, GLenum point, GLenum kind, GLuint texture, GLint level) {
  attach(target, point, texture);
  framebuffer_texture_2d(target, point, kind, texture, level);
}

static void APIENTRY on_framebuffer_texture_layer(GLenum target, GLenum point, GLuint texture, GLint level,
                                                  GLint layer) {
  attach(target, point, texture);
  framebuffer_texture_layer(target, point, texture, level, layer);
}

static GLenum APIENTRY on_check_framebuffer(GLenum target) {
  for (int i = 0; i < 3 && f.at && f.banned; i++)
    if (target == GL_DRAW_FRAMEBUFFER && f.attached[i] == f.banned) {
      f.hit = 1;
      return GL_FRAMEBUFFER_UNSUPPORTED;
    }
  return check_framebuffer(target);
}

/* A function pointer and an object pointer are different things in C, the same on every system with EGL. */
#define HOOK(text, own, real) \
  if (strcmp(name, text) == 0) { \
    union { \
      void *object; \
      void (*function)(void); \
    } found = {gl_address(user, name)}, hook = {.function = (void (*)(void))own}; \
    memcpy(&real, &found, sizeof real); \
    return hook.object; \
  }

static void find_get_buffer(void) {
  void *found = gl_address(NULL, "glGetBufferParameteriv");
  memcpy(&get_buffer, &found, sizeof found);
}

void *faults_address(void *user, const char *name) {
  if (!get_buffer) find_get_buffer();
  HOOK("glGetError", on_get_error, get_error)
  HOOK("glTexImage2D", on_tex_image_2d, tex_image_2d)
  HOOK("glTexImage3D", on_tex_image_3d, tex_image_3d)
  HOOK("glBufferData", on_buffer_data, buffer_data)
  HOOK("glGetShaderiv", on_get_shader, get_shader)
  HOOK("glGetProgramiv", on_get_program, get_program)
  HOOK("glCheckFramebufferStatus", on_check_framebuffer, check_framebuffer)
  HOOK("glGenTextures", on_gen_textures, gen_textures)
  HOOK("glFramebufferTexture", on_framebuffer_texture, framebuffer_texture)
  HOOK("glFramebufferTexture2D", on_framebuffer_texture_2d, framebuffer_texture_2d)
  HOOK("glFramebufferTextureLayer", on_framebuffer_texture_layer, framebuffer_texture_layer)
  return gl_address(user, name);
}
