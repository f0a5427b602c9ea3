/* Forward shading: the techniques as text for a host's own shaders, and their textures bound for it. */
#include <stdio.h>
#include <string.h>

#include "gl/host.h"
#include "gl/host_program.h"
#include "gl/source.h"
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

enum { DEFINES = PNI_TECHNIQUE_DEFINES + 32 };

static const char *forward_text(pn_context *context, const char *path, const char *more, const char *defines) {
  char key[DEFINES + 160];
  snprintf(key, sizeof key, "%s %s %s", path, more ? more : "", defines);
  const char *known = kept_text(context, key);
  if (known && !context->gpu.shader_directory) return known;
  char *text = NULL;
  const char *paths[] = {path, more, NULL};
  if (pni_shader_text(&context->gpu, paths, defines, &text) != PN_OK) return NULL;
  return keep_text(context, key, text);
}

static const char *technique_text(pn_context *context, const char *spec) {
  pni_gpu *gpu = &context->gpu;
  const pni_technique_class *technique;
  double values[PNI_PARAMETERS_MAX];
  pni_explanation why;
  if (pni_spec_read(spec, &technique, values, &why) != PN_OK) {
    pni_fail(gpu, PN_ERROR_ARGUMENT, why.message, "%s", why.text);
    return NULL;
  }
  if (!technique->gathering.shader) {
    pni_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_FORWARD, "technique %s has no forward form", technique->table.name);
    return NULL;
  }
  char own[PNI_TECHNIQUE_DEFINES], defines[DEFINES];
  pni_gather_defines(&technique->gathering, &technique->table, values, own);
  snprintf(defines, sizeof defines, "PN_LIGHTS %d\n%s", PN_FORWARD_LIGHTS_MAX, own);
  return forward_text(context, "shaders/forward.glsl", technique->gathering.shader, defines);
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
  return strcmp(spec, "caster") ? technique_text(context, spec) : forward_text(context, "casters/peel.glsl", NULL, "");
}

/* ---- binding ----------------------------------------------------------------------------------------------------- */

/* Whether one program's text serves both: the same technique, compiled alike. Values that are read from the block may
 * differ. */
static bool same_text(const pn_light *a, const pn_light *b) {
  if (a->technique != b->technique) return false;
  char first[PNI_TECHNIQUE_DEFINES], second[PNI_TECHNIQUE_DEFINES];
  pni_gather_defines(&a->technique->gathering, &a->technique->table, a->values, first);
  pni_gather_defines(&b->technique->gathering, &b->technique->table, b->values, second);
  return !strcmp(first, second);
}

static pn_result check_lights(pn_light *const *lights, int count, const pn_slots *slots) {
  pni_gpu *gpu = &lights[0]->object.context->gpu;
  if (!slots) return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_bind: slots is NULL");
  int units = 0, bindings = 0;
  pni_host_limits(gpu, &units, &bindings);
  if (count > PN_FORWARD_LIGHTS_MAX || slots->first_texture_unit < 0 || slots->first_texture_unit > units - 2 * count ||
      slots->uniform_binding < 0 || slots->uniform_binding >= bindings)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_FORWARD, "1 to %d lights, units below %d, a binding below %d",
                    PN_FORWARD_LIGHTS_MAX, units, bindings);
  for (int i = 0; i < count; i++) {
    if (!lights[i] || lights[i]->object.context != lights[0]->object.context)
      return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT,
                      "pn_bind: a light is NULL, or of another context");
    if (!lights[i]->technique->gathering.shader || !same_text(lights[i], lights[0]))
      return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_FORWARD,
                      "the lights must share a technique that has a forward form, and what is compiled of its "
                      "parameters");
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
    if (lights[i]->maps.fit.empty) blocks[i].map_count = 0;
  }
  return pni_buffer_fill(&context->gpu, &context->forward_block, "forward lights", PNI_BUFFER_BLOCK, blocks,
                         sizeof blocks);
}

/* Every sampler gets a unit of its own kind, lights or not: two kinds of sampler on one unit are an error when
 * drawing. */
static int fill_samplers(pn_light *const *lights, int count, int first, pni_host_sampler *out) {
  for (int i = 0; i < PN_FORWARD_LIGHTS_MAX; i++) {
    int unit = first + 2 * (i < count ? i : 0);
    const pn_light *light = i < count ? lights[i] : NULL;
    pni_host_sampler *maps = &out[2 * i], *beside = &out[2 * i + 1];
    *maps = (pni_host_sampler){.unit = unit, .texture = light ? &light->maps.depth : NULL};
    *beside = (pni_host_sampler){.unit = unit + 1};
    if (light) beside->texture = pni_gather_beside(&light->technique->gathering, &light->maps, light->kept.state);
    snprintf(maps->name, sizeof maps->name, "pn_maps_%d", i);
    snprintf(beside->name, sizeof beside->name, "pn_range_%d", i);
  }
  return 2 * PN_FORWARD_LIGHTS_MAX;
}

pn_result pn_bind(pn_light *const *lights, int count, pn_gl program, const pn_slots *slots) {
  if (!lights || count < 1 || !lights[0]) return PN_ERROR_ARGUMENT;
  pn_context *context = lights[0]->object.context;
  pni_gpu *gpu = &context->gpu;
  pn_result result = check_lights(lights, count, slots);
  if (result == PN_OK && !pni_host_program_fits(gpu, program))
    result =
        pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_FORWARD, "program %u does not contain pn_glsl's text", program);
  if (result == PN_OK) result = fill_blocks(context, lights, count);
  if (result != PN_OK) return result;
  pni_host_sampler samplers[2 * PN_FORWARD_LIGHTS_MAX];
  int sampler_count = fill_samplers(lights, count, slots->first_texture_unit, samplers);
  pni_host_program_bind(gpu, program, &context->forward_block, slots->uniform_binding, samplers, sampler_count);
  return PN_OK;
}
