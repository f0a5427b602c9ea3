/* Forward shading: the techniques as text for a host's own shaders, and their textures bound for it. */
#include <stdio.h>
#include <string.h>

#include "light.h"

/* ---- text -------------------------------------------------------------------------------------------------------- */

static const char *kept_text(pn_context *context, const char *key) {
  for (pni_forward_text *t = context->forward_texts; t; t = t->next)
    if (!strcmp(t->key, key)) return t->text;
  return NULL;
}

static const char *keep_text(pn_context *context, const char *key, char *text) {
  pni_gpu *gpu = &context->gpu;
  size_t bytes = strlen(key) + 1;
  pni_forward_text *kept = pni_allocate_zero(gpu, sizeof *kept);
  char *copy = kept ? pni_reallocate(gpu, NULL, bytes) : NULL;
  if (!copy) {
    pni_free(gpu, kept);
    pni_free(gpu, text);
    return NULL;
  }
  memcpy(copy, key, bytes);
  *kept = (pni_forward_text){copy, text, context->forward_texts};
  context->forward_texts = kept;
  return text;
}

static const char *forward_text(pn_context *context, const char *path, const char *more, const char *defines) {
  char key[PNI_TECHNIQUE_DEFINES + 160];
  snprintf(key, sizeof key, "%s %s %s", path, more ? more : "", defines);
  const char *known = kept_text(context, key);
  if (known && !context->gpu.shader_directory) return known;
  char *text = NULL;
  const char *paths[] = {path, more, NULL};
  if (pni_shader_text(&context->gpu, paths, defines, &text) != PN_OK) return NULL;
  return keep_text(context, key, text);
}

const char *pn_glsl(pn_context *context, const char *spec, int glsl_version, int es) {
  if (!context) return NULL;
  pni_gpu *gpu = &context->gpu;
  if (!spec) {
    pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_glsl: spec is NULL");
    return NULL;
  }
  if (glsl_version < (es ? 300 : 330)) {
    pni_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_FORWARD, "GLSL 330 or GLSL ES 300 at least is needed");
    return NULL;
  }
  if (!strcmp(spec, "caster")) return forward_text(context, "casters/peel.glsl", NULL, "");
  char why[512];
  const pn_technique *table;
  double values[PNI_PARAMETERS_MAX];
  if (pn_technique_parse(spec, &table, values, why, sizeof why) != PN_OK) {
    pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_TECHNIQUE_UNKNOWN, "%s", why);
    return NULL;
  }
  const pni_technique_class *technique = pni_technique_class_of(table);
  if (!technique->shader) {
    pni_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_FORWARD, "technique %s has no forward form", table->name);
    return NULL;
  }
  char own[PNI_TECHNIQUE_DEFINES], defines[PNI_TECHNIQUE_DEFINES + 32];
  pni_technique_defines(technique, values, own);
  snprintf(defines, sizeof defines, "PN_LIGHTS %d\n%s", PN_FORWARD_LIGHTS_MAX, own);
  return forward_text(context, "shaders/forward.glsl", technique->shader, defines);
}

/* ---- binding ----------------------------------------------------------------------------------------------------- */

static pn_result check_lights(pn_light *const *lights, int count, const pn_slots *slots) {
  pni_gpu *gpu = &lights[0]->object.context->gpu;
  if (!slots) return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_bind: slots is NULL");
  GLint units = 0, bindings = 0;
  GL(gpu, GetIntegerv)(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, &units);
  GL(gpu, GetIntegerv)(GL_MAX_UNIFORM_BUFFER_BINDINGS, &bindings);
  if (count > PN_FORWARD_LIGHTS_MAX || slots->first_texture_unit < 0 || slots->first_texture_unit > units - 2 * count ||
      slots->uniform_binding < 0 || slots->uniform_binding >= bindings)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_FORWARD, "1 to %d lights, units below %d, a binding below %d",
                    PN_FORWARD_LIGHTS_MAX, units, bindings);
  for (int i = 0; i < count; i++) {
    if (!lights[i] || lights[i]->technique != lights[0]->technique || !lights[i]->technique->shader)
      return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_FORWARD,
                      "the lights must share a technique that has a forward form");
    if (!lights[i]->maps.ready)
      return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "pn_maps_update comes first");
  }
  return PN_OK;
}

static pn_result fill_blocks(pn_context *context, pn_light *const *lights, int count) {
  pni_light_block blocks[PN_FORWARD_LIGHTS_MAX];
  memset(blocks, 0, sizeof blocks);
  for (int i = 0; i < count; i++) {
    pni_light_fill_block(lights[i], &blocks[i]);
    if (lights[i]->maps.fit.empty) blocks[i].maps[0] = 0;
  }
  return pni_uniform_buffer_set(&context->gpu, &context->forward_block, blocks, sizeof blocks);
}

/* Every sampler gets a unit of its own kind, lights or not: two kinds of sampler on one unit are an error when
 * drawing. */
static void set_units(pni_gpu *gpu, pn_gl program, int count, int first) {
  for (int i = 0; i < PN_FORWARD_LIGHTS_MAX; i++) {
    char name[16];
    int unit = first + 2 * (i < count ? i : 0);
    snprintf(name, sizeof name, "pn_maps_%d", i);
    GL(gpu, Uniform1i)(GL(gpu, GetUniformLocation)(program, name), unit);
    snprintf(name, sizeof name, "pn_range_%d", i);
    GL(gpu, Uniform1i)(GL(gpu, GetUniformLocation)(program, name), unit + 1);
  }
}

static void bind_textures(pni_gpu *gpu, pn_light *const *lights, int count, int first) {
  for (int i = 0; i < count; i++) {
    pni_bind_texture(gpu, first + 2 * i, GL_TEXTURE_2D_ARRAY, lights[i]->maps.depth.id, false);
    pni_bind_texture(gpu, first + 2 * i + 1, GL_TEXTURE_2D_ARRAY, lights[i]->maps.range.id, false);
  }
}

pn_result pn_bind(pn_light *const *lights, int count, pn_gl program, const pn_slots *slots) {
  if (!lights || count < 1 || !lights[0]) return PN_ERROR_ARGUMENT;
  pn_context *context = lights[0]->object.context;
  pni_gpu *gpu = &context->gpu;
  pn_result result = check_lights(lights, count, slots);
  if (result == PN_OK) result = fill_blocks(context, lights, count);
  if (result != PN_OK) return result;
  bool linked = GL(gpu, IsProgram)(program);
  GLuint block = linked ? GL(gpu, GetUniformBlockIndex)(program, "pn_block") : GL_INVALID_INDEX;
  if (block == GL_INVALID_INDEX)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_FORWARD, "program %u does not contain pn_glsl's text", program);
  GLint before = 0, unit = 0;
  GL(gpu, GetIntegerv)(GL_CURRENT_PROGRAM, &before);
  GL(gpu, GetIntegerv)(GL_ACTIVE_TEXTURE, &unit);
  GL(gpu, UseProgram)(program);
  set_units(gpu, program, count, slots->first_texture_unit);
  GL(gpu, UseProgram)((GLuint)before);
  GL(gpu, UniformBlockBinding)(program, block, (GLuint)slots->uniform_binding);
  GL(gpu, BindBufferBase)(GL_UNIFORM_BUFFER, (GLuint)slots->uniform_binding, context->forward_block.id);
  bind_textures(gpu, lights, count, slots->first_texture_unit);
  GL(gpu, ActiveTexture)((GLenum)unit);
  return PN_OK;
}
