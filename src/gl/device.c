#define _GNU_SOURCE /* RTLD_NOLOAD */
#include "gl/device.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <epoxy/egl.h>

#include "gl/host.h"
#include "gl/label.h"
#include "gl/program.h"

static void use_epoxy(pni_gpu *gpu) {
#define X(type, name) gpu->gl.name = &epoxy_gl##name;
  PNI_GL_REQUIRED(X)
  PNI_GL_OPTIONAL(X)
#undef X
}

static const char *use_loader(pni_gpu *gpu) {
  const char *missing = NULL;
#define X(type, name) \
  { \
    void *found = gpu->desc.get_proc_address(gpu->desc.user, "gl" #name); \
    memcpy(&gpu->storage.name, &found, sizeof found); \
    gpu->gl.name = &gpu->storage.name; \
    if (!found && !missing) missing = "gl" #name; \
  }
  PNI_GL_REQUIRED(X)
  const char *required = missing;
  PNI_GL_OPTIONAL(X)
#undef X
  return required;
}

static bool has_extension(pni_gpu *gpu, const char *name) {
  GLint count = 0;
  GL(gpu, GetIntegerv)(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; i++) {
    const char *extension = (const char *)GL(gpu, GetStringi)(GL_EXTENSIONS, (GLuint)i);
    if (extension && !strcmp(extension, name)) return true;
  }
  return false;
}

static bool is_software(const char *renderer) {
  static const char *const names[] = {"llvmpipe", "softpipe", "swrast", "SwiftShader", "Software Rasterizer"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (strstr(renderer, names[i])) return true;
  return false;
}

/* What changes what a pass draws, beside the clip distances; GL_DITHER is the only one that is on by GL's default.
 * Multisampling is of no effect in the single-sample targets the library draws to. */
static void find_switches(pni_gpu *gpu) {
  static const GLenum always[] = {GL_SCISSOR_TEST,
                                  GL_STENCIL_TEST,
                                  GL_DEPTH_TEST,
                                  GL_CULL_FACE,
                                  GL_POLYGON_OFFSET_FILL,
                                  GL_POLYGON_SMOOTH,
                                  GL_COLOR_LOGIC_OP,
                                  GL_RASTERIZER_DISCARD,
                                  GL_SAMPLE_ALPHA_TO_COVERAGE,
                                  GL_SAMPLE_COVERAGE,
                                  GL_SAMPLE_MASK,
                                  GL_PRIMITIVE_RESTART,
                                  GL_FRAMEBUFFER_SRGB,
                                  GL_DITHER,
                                  GL_DEPTH_CLAMP,
                                  GL_SAMPLE_ALPHA_TO_ONE,
                                  GL_PROGRAM_POINT_SIZE};
  static const GLenum fixed[] = {GL_ALPHA_TEST, GL_POLYGON_STIPPLE, GL_POINT_SMOOTH};
  pni_capabilities *can = &gpu->can;
  memcpy(can->switches, always, sizeof always);
  int count = sizeof always / sizeof *always;
  if (can->version >= 43) can->switches[count++] = GL_PRIMITIVE_RESTART_FIXED_INDEX;
  if (has_extension(gpu, "GL_EXT_depth_bounds_test")) can->switches[count++] = GL_DEPTH_BOUNDS_TEST_EXT;
  for (int i = 0; i < 3 && can->compatibility; i++) can->switches[count++] = fixed[i];
  can->switch_count = count;
}

static void read_capabilities(pni_gpu *gpu) {
  pni_capabilities *can = &gpu->can;
  const char *renderer = (const char *)GL(gpu, GetString)(GL_RENDERER);
  can->software = renderer && is_software(renderer);
  GLint profile = 0;
  GL(gpu, GetIntegerv)(GL_CONTEXT_PROFILE_MASK, &profile);
  can->compatibility = (profile & GL_CONTEXT_COMPATIBILITY_PROFILE_BIT) != 0;
  bool function = !gpu->desc.get_proc_address || gpu->storage.ClipControl;
  can->clip_control = function && (can->version >= 45 || has_extension(gpu, "GL_ARB_clip_control"));
  function = !gpu->desc.get_proc_address || gpu->storage.GetGraphicsResetStatus;
  can->robustness = function && can->version >= 45;
  function = !gpu->desc.get_proc_address ||
             (gpu->storage.ViewportIndexedf && gpu->storage.DepthRangeIndexed && gpu->storage.ScissorIndexed);
  can->viewports = function && can->version >= 41;
  function = !gpu->desc.get_proc_address || (gpu->storage.BlendEquationSeparatei && gpu->storage.BlendFuncSeparatei);
  can->blend_buffers = function && can->version >= 40;
  function = !gpu->desc.get_proc_address || gpu->storage.DrawArraysIndirect;
  can->indirect = function && (can->version >= 40 || has_extension(gpu, "GL_ARB_draw_indirect"));
  function =
      !gpu->desc.get_proc_address || (gpu->storage.GetTextureParameteriv && gpu->storage.GetTextureLevelParameteriv &&
                                      gpu->storage.GetNamedRenderbufferParameteriv);
  can->by_name = function && (can->version >= 45 || has_extension(gpu, "GL_ARB_direct_state_access"));
  /* Mesa refuses GL_TEXTURE_TARGET in compatibility contexts. */
  can->targets = can->by_name && !can->compatibility;
  function = !gpu->desc.get_proc_address ||
             (gpu->storage.ObjectLabel && gpu->storage.PushDebugGroup && gpu->storage.PopDebugGroup);
  can->labels = function && (can->version >= 43 || has_extension(gpu, "GL_KHR_debug"));
  if (can->labels) GL(gpu, GetIntegerv)(GL_MAX_DEBUG_GROUP_STACK_DEPTH, &can->debug_groups);
  can->float_blend = true;
  function =
      !gpu->desc.get_proc_address || (gpu->storage.PixelTransferf && gpu->storage.TexEnvf && gpu->storage.GetTexEnvfv);
  can->fixed = function && can->compatibility;
  can->stencil_texturing = can->version >= 43 || has_extension(gpu, "GL_ARB_stencil_texturing");
  find_switches(gpu);
  GL(gpu, GetIntegerv)(GL_MAX_TEXTURE_SIZE, &can->texture_size_max);
  GL(gpu, GetIntegerv)(GL_MAX_ARRAY_TEXTURE_LAYERS, &can->layers_max);
  GL(gpu, GetIntegerv)(GL_MAX_DRAW_BUFFERS, &can->draw_buffers);
  GL(gpu, GetIntegerv)(GL_SUBPIXEL_BITS, &can->subpixel_bits);
  GL(gpu, GetIntegerv)(GL_MAX_CLIP_DISTANCES, &can->clip_distances);
  /* More of these than every device has are left alone. */
  if (can->draw_buffers > PNI_DRAW_BUFFERS_SAVED) can->draw_buffers = PNI_DRAW_BUFFERS_SAVED;
  if (can->clip_distances > PNI_CLIP_DISTANCES_SAVED) can->clip_distances = PNI_CLIP_DISTANCES_SAVED;
  GL(gpu, GetIntegerv)(GL_MAX_SAMPLE_MASK_WORDS, &can->sample_mask_words);
}

/* Whether GLX has a current context, without linking it and without loading it: a host that uses it has it loaded. */
static bool glx_is_current(void) {
  static const char *const libraries[] = {"libGLX.so.0", "libGL.so.1"};
  for (size_t i = 0; i < sizeof libraries / sizeof *libraries; i++) {
    void *library = dlopen(libraries[i], RTLD_LAZY | RTLD_NOLOAD);
    if (!library) continue;
    void *(*current)(void) = NULL;
    void *found = dlsym(library, "glXGetCurrentContext");
    memcpy(&current, &found, sizeof found);
    bool yes = current && current();
    dlclose(library);
    if (yes) return true;
  }
  return false;
}

/* libepoxy aborts the program when it resolves a function without a current context; ask before it does. */
static bool context_is_current(const pni_gpu *gpu) {
  return gpu->desc.get_proc_address || (epoxy_has_egl() && eglGetCurrentContext()) || glx_is_current();
}

static pn_result check_version(pni_gpu *gpu) {
  if (!context_is_current(gpu))
    return pni_fail(gpu, PN_ERROR_CONTEXT_LOST, PN_MESSAGE_GL_LOST, "no GL context is current");
  const char *version = (const char *)GL(gpu, GetString)(GL_VERSION);
  if (!version) return pni_fail(gpu, PN_ERROR_CONTEXT_LOST, PN_MESSAGE_GL_LOST, "no GL context is current");
  if (!strncmp(version, "OpenGL ES", 9))
    return pni_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_GL_VERSION, "OpenGL 3.3 core is needed, this is %s", version);
  int major = 0, minor = 0;
  sscanf(version, "%d.%d", &major, &minor);
  gpu->can.version = major * 10 + minor;
  if (gpu->can.version < 33)
    return pni_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_GL_VERSION, "OpenGL 3.3 core is needed, this is %s", version);
  return PN_OK;
}

static pn_gl make_sampler(pni_gpu *gpu, GLenum filter, GLenum wrap) {
  pn_gl sampler = 0;
  GL(gpu, GenSamplers)(1, &sampler);
  const GLenum parameters[][2] = {
      {GL_TEXTURE_MIN_FILTER, filter}, {GL_TEXTURE_MAG_FILTER, filter},    {GL_TEXTURE_WRAP_S, wrap},
      {GL_TEXTURE_WRAP_T, wrap},       {GL_TEXTURE_COMPARE_MODE, GL_NONE},
  };
  for (size_t i = 0; i < sizeof parameters / sizeof *parameters; i++)
    GL(gpu, SamplerParameteri)(sampler, parameters[i][0], (GLint)parameters[i][1]);
  return sampler;
}

static void make_shared_objects(pni_gpu *gpu) {
  GL(gpu, GenVertexArrays)(1, &gpu->vertex_array);
  GL(gpu, GenFramebuffers)(1, &gpu->framebuffer);
  GL(gpu, GenFramebuffers)(1, &gpu->read_framebuffer);
  gpu->sampler_nearest = make_sampler(gpu, GL_NEAREST, GL_CLAMP_TO_EDGE);
  gpu->sampler_linear = make_sampler(gpu, GL_LINEAR, GL_REPEAT);
}

static pn_result copy_strings(pni_gpu *gpu) {
  if ((int)gpu->desc.state < PN_STATE_RESTORE || gpu->desc.state > PN_STATE_RESET)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_STATE_MODE, "state mode %d is unknown", (int)gpu->desc.state);
  if (!gpu->desc.shader_directory) return PN_OK;
  FILE *directory = fopen(gpu->desc.shader_directory, "r");
  if (!directory)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_SHADER_DIRECTORY, "cannot read the shader directory %s",
                    gpu->desc.shader_directory);
  fclose(directory);
  size_t bytes = strlen(gpu->desc.shader_directory) + 1;
  gpu->shader_directory = pni_reallocate(gpu, NULL, bytes);
  if (!gpu->shader_directory) return PN_ERROR_OUT_OF_MEMORY;
  memcpy(gpu->shader_directory, gpu->desc.shader_directory, bytes);
  gpu->desc.shader_directory = gpu->shader_directory;
  return PN_OK;
}

pn_result pni_gpu_open(pni_gpu *gpu, const pn_context_desc *desc) {
  memset(gpu, 0, sizeof *gpu);
  if (desc) gpu->desc = *desc;
  if (gpu->desc.get_proc_address) {
    const char *missing = use_loader(gpu);
    if (missing)
      return pni_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_GL_FUNCTION, "get_proc_address has no %s", missing);
  } else {
    use_epoxy(gpu);
  }
  pn_result result = check_version(gpu);
  if (result == PN_OK) result = copy_strings(gpu);
  if (result != PN_OK) return result;
  read_capabilities(gpu);
  make_shared_objects(gpu);
  pni_find_group_room(gpu);
  return PN_OK;
}

void pni_gpu_close(pni_gpu *gpu, bool abandon) {
  pni_programs_free(gpu, abandon);
  if (!abandon) {
    GL(gpu, DeleteVertexArrays)(1, &gpu->vertex_array);
    GL(gpu, DeleteFramebuffers)(1, &gpu->framebuffer);
    GL(gpu, DeleteFramebuffers)(1, &gpu->read_framebuffer);
    GL(gpu, DeleteSamplers)(1, &gpu->sampler_nearest);
    GL(gpu, DeleteSamplers)(1, &gpu->sampler_linear);
  }
  pni_free(gpu, gpu->plan.replaced);
  pni_free(gpu, gpu->shader_directory);
}

pn_result pni_gpu_check_lost(pni_gpu *gpu) {
  if (!gpu->can.robustness || GL(gpu, GetGraphicsResetStatus)() == GL_NO_ERROR) return PN_OK;
  return pni_fail(gpu, PN_ERROR_CONTEXT_LOST, PN_MESSAGE_GL_LOST, "the GL context was reset");
}

void pni_gpu_names(pni_gpu *gpu, const char **vendor, const char **renderer, const char **version) {
  *vendor = (const char *)GL(gpu, GetString)(GL_VENDOR);
  *renderer = (const char *)GL(gpu, GetString)(GL_RENDERER);
  *version = (const char *)GL(gpu, GetString)(GL_VERSION);
}
