#include "gl_context.h"

#include <stdio.h>
#include <stdlib.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

static EGLDisplay display = EGL_NO_DISPLAY;
static EGLContext context = EGL_NO_CONTEXT;
static int debug_errors;

static void APIENTRY on_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                                const GLchar *text, const void *user) {
  (void)source, (void)id, (void)severity, (void)user;
  if (type != GL_DEBUG_TYPE_ERROR && type != GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR) return;
  debug_errors++;
  fprintf(stderr, "GL: %.*s\n", (int)length, text);
}

static EGLDisplay any_display(void) {
  PFNEGLGETPLATFORMDISPLAYEXTPROC get = (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
  EGLDisplay found = get ? get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL) : EGL_NO_DISPLAY;
  if (found != EGL_NO_DISPLAY && eglInitialize(found, NULL, NULL)) return found;
  found = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  return found != EGL_NO_DISPLAY && eglInitialize(found, NULL, NULL) ? found : EGL_NO_DISPLAY;
}

int gl_open(void) {
  static const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3,
                                      EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                      EGL_CONTEXT_OPENGL_DEBUG, EGL_TRUE, EGL_NONE};
  display = any_display();
  if (display == EGL_NO_DISPLAY || !eglBindAPI(EGL_OPENGL_API)) return 0;
  context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return 0;
  if (epoxy_gl_version() >= 43 || epoxy_has_gl_extension("GL_KHR_debug")) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_message, NULL);
  }
  return 1;
}

void gl_close(void) {
  if (display == EGL_NO_DISPLAY) return;
  eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
  eglTerminate(display);
}

void gl_assert_clean(void) {
  int errors = debug_errors;
  debug_errors = 0;
  for (GLenum error; (error = glGetError()) != GL_NO_ERROR; errors++) fprintf(stderr, "GL: error 0x%x\n", error);
  assert_int_equal(errors, 0);
}

static int after_each(void **state) {
  (void)state;
  gl_assert_clean();
  return 0;
}

int gl_run(const char *name, const struct CMUnitTest *tests, size_t count) {
  if (!gl_open()) {
    fprintf(stderr, "%s: no OpenGL 3.3 core context here\n", name);
    return 77;
  }
  struct CMUnitTest *watched = calloc(count, sizeof *watched);
  for (size_t i = 0; i < count; i++) {
    watched[i] = tests[i];
    watched[i].teardown_func = after_each;
  }
  int failed = _cmocka_run_group_tests(name, watched, count, NULL, NULL);
  free(watched);
  gl_close();
  return failed ? 1 : 0;
}

/* Fails the running test with what GL says about a shader or a program that is not what it should be. */
static void demand(GLint done, PFNGLGETSHADERINFOLOGPROC read_log, GLuint object) {
  char log[2000] = "";
  if (done) return;
  read_log(object, sizeof log, NULL, log);
  fail_msg("%s", log);
}

static GLuint stage(GLenum kind, const char *text) {
  const char *parts[] = {"#version 330 core\n", text};
  GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 2, parts, NULL);
  glCompileShader(shader);
  GLint done = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  demand(done, glGetShaderInfoLog, shader);
  return shader;
}

GLuint gl_program(const char *vertex, const char *fragment) {
  GLuint shaders[2] = {stage(GL_VERTEX_SHADER, vertex), stage(GL_FRAGMENT_SHADER, fragment)};
  GLuint program = glCreateProgram();
  for (int i = 0; i < 2; i++) {
    glAttachShader(program, shaders[i]);
    glDeleteShader(shaders[i]);
  }
  glLinkProgram(program);
  GLint done = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &done);
  demand(done, glGetProgramInfoLog, program);
  return program;
}

static float *read_image(GLenum point, GLuint texture, int level, int layer, int width, int height, GLenum layout,
                         int channels) {
  GLuint framebuffer;
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  if (layer < 0)
    glFramebufferTexture2D(GL_READ_FRAMEBUFFER, point, GL_TEXTURE_2D, texture, level);
  else
    glFramebufferTextureLayer(GL_READ_FRAMEBUFFER, point, texture, level, layer);
  glReadBuffer(point == GL_DEPTH_ATTACHMENT ? GL_NONE : GL_COLOR_ATTACHMENT0);
  assert_int_equal(glCheckFramebufferStatus(GL_READ_FRAMEBUFFER), GL_FRAMEBUFFER_COMPLETE);
  float *values = malloc((size_t)width * (size_t)height * (size_t)channels * sizeof *values);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, layout, GL_FLOAT, values);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  glDeleteFramebuffers(1, &framebuffer);
  return values;
}

float *gl_read_texture(GLuint texture, int level, int layer, int width, int height, int channels) {
  static const GLenum layouts[] = {0, GL_RED, GL_RG, GL_RGB, GL_RGBA};
  return read_image(GL_COLOR_ATTACHMENT0, texture, level, layer, width, height, layouts[channels], channels);
}

float *gl_read_depth(GLuint texture, int layer, int width, int height) {
  return read_image(GL_DEPTH_ATTACHMENT, texture, 0, layer, width, height, GL_DEPTH_COMPONENT, 1);
}
