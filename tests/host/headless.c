#include "headless.h"

#include <stdio.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "gl.h"

static EGLDisplay surfaceless_display(void) {
  PFNEGLGETPLATFORMDISPLAYEXTPROC get = (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
  EGLDisplay display = EGL_NO_DISPLAY;
  if (get) display = get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL)) {
    display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL)) return EGL_NO_DISPLAY;
  }
  return display;
}

static int open_profile(headless *out, EGLint profile) {
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               3,
                               EGL_CONTEXT_MINOR_VERSION,
                               3,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               profile,
                               EGL_CONTEXT_OPENGL_DEBUG,
                               EGL_TRUE,
                               EGL_NONE};
  EGLDisplay display = surfaceless_display();
  if (display == EGL_NO_DISPLAY || !eglBindAPI(EGL_OPENGL_API)) {
    fprintf(stderr, "host client: no EGL display\n");
    return 0;
  }
  EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
    fprintf(stderr, "host client: no OpenGL 3.3 context of that profile\n");
    return 0;
  }
  const char *missing = NULL;
  if (!gl_load(&missing)) {
    fprintf(stderr, "host client: no %s\n", missing);
    return 0;
  }
  *out = (headless){display, context};
  return 1;
}

int headless_open(headless *out) { return open_profile(out, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT); }

int headless_open_compatible(headless *out) { return open_profile(out, EGL_CONTEXT_OPENGL_COMPATIBILITY_PROFILE_BIT); }

int headless_open_es(const headless *main, headless *out) {
  static const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
  if (!eglBindAPI(EGL_OPENGL_ES_API)) return 0;
  EGLContext context = eglCreateContext(main->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT) {
    eglBindAPI(EGL_OPENGL_API);
    return 0;
  }
  *out = (headless){main->display, context};
  return eglMakeCurrent(main->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE;
}

void headless_current(const headless *self) {
  eglMakeCurrent(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, self->context);
}

void headless_close(headless *self) {
  if (!self->display) return;
  eglMakeCurrent(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(self->display, self->context);
  eglTerminate(self->display);
  *self = (headless){0};
}

void headless_close_es(headless *self) {
  eglMakeCurrent(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(self->display, self->context);
  eglBindAPI(EGL_OPENGL_API);
  *self = (headless){0};
}
