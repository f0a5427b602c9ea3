#include "gl.h"

#include <stdio.h>
#include <string.h>

#include <EGL/egl.h>

gl_table gl;
static int debug_errors;

static void (*proc(const char *name))(void) { return eglGetProcAddress(name); }

static void APIENTRY on_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                                const GLchar *text, const void *user) {
  (void)id, (void)severity, (void)user;
  /* A text that does not compile is an error of the text's, not of a GL call. */
  if (source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
  if (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR) {
    debug_errors++;
    fprintf(stderr, "GL: %.*s\n", (int)length, text);
  }
}

int gl_load(const char **missing) {
  *missing = NULL;
#define X(upper, name) \
  gl.name = (PFNGL##upper##PROC)proc("gl" #name); \
  if (!gl.name) *missing = "gl" #name;
  HOST_GL_FUNCTIONS(X)
#undef X
#define X(upper, name) gl.name = (PFNGL##upper##PROC)proc("gl" #name);
  HOST_GL_OPTIONAL(X)
#undef X
  if (*missing) return 0;
  /* Mesa hands out a pointer for any name it knows, so the version and the extension list decide. */
  if (gl_version() < 45 && !gl_has("GL_ARB_clip_control")) gl.ClipControl = NULL;
  if (gl_version() < 43 && !gl_has("GL_KHR_debug")) gl.DebugMessageCallback = NULL;
  debug_errors = 0;
  if (gl.DebugMessageCallback) {
    gl.Enable(GL_DEBUG_OUTPUT);
    gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    gl.DebugMessageCallback(on_message, NULL);
  }
  return 1;
}

int gl_errors(void) {
  int count = debug_errors;
  debug_errors = 0;
  for (GLenum error = gl.GetError(); error != GL_NO_ERROR; error = gl.GetError()) {
    fprintf(stderr, "GL: error 0x%04x\n", error);
    count++;
  }
  return count;
}

int gl_version(void) {
  GLint major = 0, minor = 0;
  gl.GetIntegerv(GL_MAJOR_VERSION, &major);
  gl.GetIntegerv(GL_MINOR_VERSION, &minor);
  return 10 * major + minor;
}

int gl_has(const char *extension) {
  GLint count = 0;
  gl.GetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; i++) {
    if (strcmp((const char *)gl.GetStringi(GL_EXTENSIONS, (GLuint)i), extension) == 0) return 1;
  }
  return 0;
}

void *gl_address(void *user, const char *name) {
  (void)user;
  /* A function pointer and an object pointer are different things in C, the same on every system with EGL. */
  union {
    void (*function)(void);
    void *object;
  } pointer = {proc(name)};
  return pointer.object;
}
