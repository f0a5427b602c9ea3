#include "host/device.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/message.h"
#include "host/shader_cache.h"

/* Ways to a display: one for each EGL device, and what is left where devices cannot be enumerated. */
enum { CANDIDATES_MAX = 32 };
enum kind { KIND_DEVICE, KIND_SURFACELESS_SOFTWARE, KIND_DEFAULT };
struct candidate {
  enum kind kind;
  EGLDeviceEXT device;
  int software;
};

struct device {
  EGLDisplay display;
  EGLContext context;
  EGLSurface surface;
  int number, software;
  char renderer[128], version[128];
};

static int has_word(const char *list, const char *word) {
  size_t length = strlen(word);
  for (const char *at = list; at && (at = strstr(at, word)); at += length)
    if ((at == list || at[-1] == ' ') && (at[length] == ' ' || !at[length])) return 1;
  return 0;
}

/* Drivers chat on stderr about what they miss. It is silenced while they start. */
static int silence(void) {
  fflush(stderr);
  int saved = dup(STDERR_FILENO), nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) {
    dup2(nowhere, STDERR_FILENO);
    close(nowhere);
  }
  return saved;
}

static void unsilence(int saved) {
  if (saved < 0) return;
  dup2(saved, STDERR_FILENO);
  close(saved);
}

static int find_candidates(struct candidate *out) {
  shader_cache_guard();
  const char *extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  int count = 0, any_software = 0;
  if (has_word(extensions, "EGL_EXT_device_base") ||
      (has_word(extensions, "EGL_EXT_device_enumeration") && has_word(extensions, "EGL_EXT_device_query"))) {
    PFNEGLQUERYDEVICESEXTPROC devices = (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
    PFNEGLQUERYDEVICESTRINGEXTPROC text = (PFNEGLQUERYDEVICESTRINGEXTPROC)eglGetProcAddress("eglQueryDeviceStringEXT");
    EGLDeviceEXT found[CANDIDATES_MAX - 2];
    EGLint found_count = 0;
    if (devices && devices(CANDIDATES_MAX - 2, found, &found_count))
      for (int i = 0; i < found_count; i++) {
        int software = text && has_word(text(found[i], EGL_EXTENSIONS), "EGL_MESA_device_software");
        any_software |= software;
        out[count++] = (struct candidate){KIND_DEVICE, found[i], software};
      }
  }
  if (!any_software && has_word(extensions, "EGL_MESA_platform_surfaceless"))
    out[count++] = (struct candidate){KIND_SURFACELESS_SOFTWARE, NULL, 1};
  if (count == 0) out[count++] = (struct candidate){KIND_DEFAULT, NULL, 0};
  return count;
}

static EGLDisplay get_display(const struct candidate *candidate) {
  PFNEGLGETPLATFORMDISPLAYEXTPROC platform =
      (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
  switch (candidate->kind) {
  case KIND_DEVICE: return platform ? platform(EGL_PLATFORM_DEVICE_EXT, candidate->device, NULL) : EGL_NO_DISPLAY;
  case KIND_SURFACELESS_SOFTWARE:
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    return platform ? platform(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL) : EGL_NO_DISPLAY;
  case KIND_DEFAULT: return eglGetDisplay(EGL_DEFAULT_DISPLAY);
  }
  return EGL_NO_DISPLAY;
}

static EGLContext create_context(EGLDisplay display, EGLConfig config) {
  static const int versions[][2] = {{4, 5}, {4, 4}, {4, 3}, {4, 2}, {4, 1}, {4, 0}, {3, 3}};
  for (size_t i = 0; i < sizeof versions / sizeof *versions; i++) {
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION_KHR,
                                 versions[i][0],
                                 EGL_CONTEXT_MINOR_VERSION_KHR,
                                 versions[i][1],
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK_KHR,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT_KHR,
                                 EGL_NONE};
    EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
    if (context != EGL_NO_CONTEXT) return context;
  }
  return EGL_NO_CONTEXT;
}

/* Makes the display's context current; a string says why not. */
static const char *start(struct device *device) {
  if (!eglInitialize(device->display, NULL, NULL)) return "its driver does not start";
  if (!eglBindAPI(EGL_OPENGL_API)) return "its driver has no desktop OpenGL";
  const char *extensions = eglQueryString(device->display, EGL_EXTENSIONS);
  int surfaceless = has_word(extensions, "EGL_KHR_surfaceless_context");
  EGLConfig config = NULL;
  if (!surfaceless || !has_word(extensions, "EGL_KHR_no_config_context")) {
    const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, surfaceless ? 0 : EGL_PBUFFER_BIT,
                             EGL_NONE};
    EGLint count = 0;
    if (!eglChooseConfig(device->display, wanted, &config, 1, &count) || count < 1)
      return "its driver offers no configuration";
  }
  device->context = create_context(device->display, config);
  if (device->context == EGL_NO_CONTEXT) return "its driver has no OpenGL 3.3 core";
  if (!surfaceless) {
    const EGLint size[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
    device->surface = eglCreatePbufferSurface(device->display, config, size);
  }
  if (!eglMakeCurrent(device->display, device->surface, device->surface, device->context))
    return "its context cannot be made current";
  return NULL;
}

static int names_software(const char *renderer) {
  static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "SWR", "Software", "lavapipe"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (strstr(renderer, names[i])) return 1;
  return 0;
}

void device_close(struct device **device) {
  if (!device || !*device) return;
  struct device *d = *device;
  if (d->display != EGL_NO_DISPLAY) {
    eglMakeCurrent(d->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (d->surface != EGL_NO_SURFACE) eglDestroySurface(d->display, d->surface);
    if (d->context != EGL_NO_CONTEXT) eglDestroyContext(d->display, d->context);
    eglTerminate(d->display);
  }
  free(d);
  *device = NULL;
}

/* NULL and a reason where it does not work. */
static struct device *open_candidate(const struct candidate *candidate, int number, const char **problem) {
  struct device *device = calloc(1, sizeof *device);
  *problem = "out of memory";
  if (!device) return NULL;
  int saved = silence();
  device->number = number;
  device->surface = EGL_NO_SURFACE;
  device->display = get_display(candidate);
  *problem = device->display == EGL_NO_DISPLAY ? "EGL has no display for it" : start(device);
  if (!*problem) {
    const char *renderer = (const char *)glGetString(GL_RENDERER), *version = (const char *)glGetString(GL_VERSION);
    if (!renderer || !version) *problem = "its OpenGL does not answer";
    snprintf(device->renderer, sizeof device->renderer, "%s", renderer ? renderer : "");
    snprintf(device->version, sizeof device->version, "%s", version ? version : "");
    device->software = candidate->software || names_software(device->renderer);
  }
  if (*problem) device_close(&device);
  unsilence(saved);
  return device;
}

/* The first that works and is of the wanted kind: 0 hardware, 1 software. */
static struct device *open_first(const struct candidate *candidates, int count, int software) {
  for (int i = 0; i < count; i++) {
    if (candidates[i].software && !software) continue;
    const char *problem;
    struct device *device = open_candidate(&candidates[i], i, &problem);
    if (device && device->software == software) return device;
    if (device) note("device %d is a software rasteriser", i);
    else note("device %d: %s", i, problem);
    device_close(&device);
  }
  return NULL;
}

int device_open(const char *which, struct device **out) {
  *out = NULL;
  struct candidate candidates[CANDIDATES_MAX];
  int count = find_candidates(candidates);
  if (which && *which >= '0' && *which <= '9') {
    int number = atoi(which);
    const char *problem;
    if (number >= count) return input_error("--device %d: there is no such device; penumbra info numbers them", number);
    *out = open_candidate(&candidates[number], number, &problem);
    return *out ? STATUS_OK : work_error("--device %d cannot be used: %s", number, problem);
  }
  int only_software = which && strcmp(which, "software") == 0;
  if (!only_software) *out = open_first(candidates, count, 0);
  if (!*out) *out = open_first(candidates, count, 1);
  if (*out) return STATUS_OK;
  return work_error(
      only_software ? "no software OpenGL 3.3 was found (Mesa's is in the package libgl1-mesa-dri)"
                    : "no OpenGL 3.3 device was found (Mesa's software rasteriser is in the package libgl1-mesa-dri)");
}

int device_list(struct device_info *out, int capacity) {
  struct candidate candidates[CANDIDATES_MAX];
  int count = find_candidates(candidates);
  for (int i = 0; i < count && i < capacity; i++) {
    const char *problem;
    struct device *device = open_candidate(&candidates[i], i, &problem);
    out[i] = (struct device_info){.number = i, .usable = device != NULL, .software = candidates[i].software};
    if (device) {
      memcpy(out[i].renderer, device->renderer, sizeof out[i].renderer);
      memcpy(out[i].version, device->version, sizeof out[i].version);
      out[i].software = device->software;
    } else {
      snprintf(out[i].problem, sizeof out[i].problem, "%s", problem);
    }
    device_close(&device);
  }
  return count;
}

const char *device_renderer(const struct device *device) { return device->renderer; }

const char *device_version(const struct device *device) { return device->version; }

int device_number(const struct device *device) { return device->number; }
