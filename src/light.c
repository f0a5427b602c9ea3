/* Lights: their description, their technique, what shaders read of them. */
#include "light.h"

#include <math.h>
#include <string.h>

#include "search/gather.h"

/* ---- the object -------------------------------------------------------------------------------------------------- */

static void free_light(pni_object *object, bool abandon) {
  pn_light *light = (pn_light *)object;
  pni_gpu *gpu = pni_light_gpu(light);
  pni_pairs_drop(&light->object, abandon);
  pni_maps_free(gpu, &light->maps, abandon);
  pni_buffer_free(gpu, &light->block, abandon);
  pni_clock_free(gpu, &light->clock, abandon);
  pni_object_unlink(&light->object);
  pni_free(gpu, light);
}

pn_result pn_light_create(pn_context *context, pn_light **out) {
  if (!context) return PN_ERROR_ARGUMENT;
  if (!out) return pni_fail(&context->gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_light_create: out is NULL");
  *out = pni_object_create(context, free_light, sizeof **out);
  if (!*out) return PN_ERROR_OUT_OF_MEMORY;
  return pn_light_technique(*out, PN_TECHNIQUE_DEFAULT, NULL, 0);
}

void pn_light_destroy(pn_light **light) {
  if (!light || !*light) return;
  pn_context *context = (*light)->object.context;
  pni_enter(context);
  free_light(&(*light)->object, false);
  pni_leave(context, PN_OK);
  *light = NULL;
}

/* ---- the description --------------------------------------------------------------------------------------------- */

static bool positive(float value) { return isfinite(value) && value > 0; }

static pn_result check_shape(pni_gpu *gpu, const pn_light_desc *d) {
  if (d->shape != PN_LIGHT_RECTANGLE && d->shape != PN_LIGHT_SUN)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_SHAPE, "light shape %d is unknown", (int)d->shape);
  float most = d->shape == PN_LIGHT_SUN ? PN_SUN_TANGENT_MAX : INFINITY;
  if (!positive(d->half_u) || !positive(d->half_v) || d->half_u > most || d->half_v > most)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_SIZE, "half extents %g, %g must be positive and finite%s",
                    d->half_u, d->half_v, d->shape == PN_LIGHT_SUN ? ", at most a tangent of 1" : "");
  if (!isfinite(d->near_distance) || !isfinite(d->range) || d->near_distance < 0 || d->range < 0 ||
      (d->range > 0 && d->near_distance >= d->range))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_RANGE, "near distance %g and range %g do not make a range",
                    d->near_distance, d->range);
  if (d->texture)
    return pni_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_LIGHT_TEXTURE, "textured lights are not supported yet");
  return PN_OK;
}

static pn_result check_maps(pni_gpu *gpu, const pn_light_desc *d) {
  int most = gpu->can.texture_size_max < PN_MAP_SIZE_MAX ? gpu->can.texture_size_max : PN_MAP_SIZE_MAX;
  if ((int)d->fit < PN_FIT_CASTERS || d->fit > PN_FIT_GIVEN)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FIT, "fit %d is unknown", (int)d->fit);
  for (int i = 0; i < 3 && d->fit == PN_FIT_GIVEN; i++)
    if (!isfinite(d->fit_bounds[i]) || !isfinite(d->fit_bounds[3 + i]) || d->fit_bounds[i] > d->fit_bounds[3 + i])
      return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FIT, "fit bounds are inverted or not finite");
  if (d->map_width < 0 || d->map_height < 0 || d->map_width > most || d->map_height > most)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_MAP, "map %d x %d is not within 1..%d", d->map_width,
                    d->map_height, most);
  return PN_OK;
}

static pn_result make_frame(pni_gpu *gpu, const pn_light_desc *d, pni_frame *frame) {
  static const float up[3] = {0, 1, 0};
  float axis[3];
  bool derived = d->axis_u[0] == 0 && d->axis_u[1] == 0 && d->axis_u[2] == 0;
  memcpy(axis, d->axis_u, sizeof axis);
  bool sound = pni_floats_finite(d->center, 3) && pni_floats_finite(d->direction, 3) && pni_floats_finite(axis, 3) &&
               (!derived || pn_light_frame(d->direction, up, NULL, axis, NULL) == PN_OK) &&
               pni_frame_axes(d->direction, axis, frame);
  if (!sound)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FRAME,
                    "centre, direction and axis must be finite, direction and axis neither zero nor parallel");
  frame->sun = d->shape == PN_LIGHT_SUN;
  for (int i = 0; i < 3; i++) frame->origin[i] = frame->sun ? 0 : d->center[i];
  frame->extent[0] = d->half_u;
  frame->extent[1] = d->half_v;
  return PN_OK;
}

pn_result pn_light_set(pn_light *light, const pn_light_desc *desc) {
  if (!light) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = pni_light_gpu(light);
  if (!desc) return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_light_set: desc is NULL");
  pni_frame frame;
  pn_result result = check_shape(gpu, desc);
  if (result == PN_OK) result = check_maps(gpu, desc);
  if (result == PN_OK) result = make_frame(gpu, desc, &frame);
  if (result != PN_OK) return result;
  pn_light_desc filled;
  memcpy(&filled, desc, sizeof filled); /* padding too: the next line compares it */
  if (!filled.map_width) filled.map_width = 512;
  if (!filled.map_height) filled.map_height = filled.map_width;
  if (light->set && !memcmp(&light->desc, &filled, sizeof filled)) return PN_OK;
  memcpy(&light->desc, &filled, sizeof filled);
  light->frame = frame;
  light->set = true;
  light->warned_angle = false;
  light->maps.ready = false;
  return PN_OK;
}

/* ---- the technique ----------------------------------------------------------------------------------------------- */

pn_result pn_light_technique(pn_light *light, const char *spec, char *why, size_t why_size) {
  if (!light) return PN_ERROR_ARGUMENT;
  if (!spec) {
    if (why && why_size) why[0] = 0;
    return pni_fail(pni_light_gpu(light), PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT,
                    "pn_light_technique: spec is NULL");
  }
  char text[512];
  const pn_technique *table;
  double values[PNI_PARAMETERS_MAX] = {0};
  pn_result result = pn_technique_parse(spec, &table, values, text, sizeof text);
  if (why && why_size) {
    strncpy(why, text, why_size - 1);
    why[why_size - 1] = 0;
  }
  if (result != PN_OK) {
    bool known = spec && strstr(text, "parameter '");
    pn_message message = strstr(text, "is no value") ? PN_MESSAGE_PARAMETER_VALUE
                         : known                     ? PN_MESSAGE_PARAMETER_UNKNOWN
                                                     : PN_MESSAGE_TECHNIQUE_UNKNOWN;
    return pni_fail(pni_light_gpu(light), result, message, "%s", text);
  }
  const pni_technique_class *technique = pni_technique_class_of(table);
  if (technique == light->technique && !memcmp(values, light->values, sizeof values)) return PN_OK;
  light->technique = technique;
  memcpy(light->values, values, sizeof values);
  light->maps.ready = false;
  return PN_OK;
}

pn_result pn_light_parameter(pn_light *light, const char *name, double value) {
  if (!light) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = pni_light_gpu(light);
  pn_message message;
  if (!name) return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_light_parameter: name is NULL");
  pni_maps_want before, after;
  light->technique->want(light->values, &before);
  if (!pni_parameter_set(&light->technique->table, name, value, light->values, &message))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, message, "technique %s: %s = %g", light->technique->table.name, name,
                    value);
  light->technique->want(light->values, &after);
  if (memcmp(&before, &after, sizeof before)) light->maps.ready = false;
  return PN_OK;
}

pn_result pn_prepare(pn_context *context, const char *spec) {
  if (!context) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = &context->gpu;
  char why[512];
  const pn_technique *table;
  double values[PNI_PARAMETERS_MAX] = {0};
  if (pn_technique_parse(spec ? spec : PN_TECHNIQUE_DEFAULT, &table, values, why, sizeof why) != PN_OK)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_TECHNIQUE_UNKNOWN, "%s", why);
  const pni_technique_class *technique = pni_technique_class_of(table);
  char defines[PNI_TECHNIQUE_DEFINES];
  pni_maps_want want;
  technique->want(values, &want);
  pni_technique_defines(technique, values, defines);
  pni_enter(context);
  pn_result result = pni_maps_prepare(gpu, &want);
  if (result == PN_OK)
    result = technique->prepare ? technique->prepare(gpu, values) : pni_gather_prepare(gpu, technique->shader, defines);
  return pni_leave(context, result);
}

/* ---- the uniform block ---- */

void pni_light_fill_block(const pn_light *light, pni_light_block *block) {
  *block = light->maps.block;
  for (int i = 0; i < light->technique->table.parameter_count; i++) block->parameters[i] = (float)light->values[i];
}

pn_result pni_light_bind_block(pn_light *light) {
  pni_light_block block;
  pni_light_fill_block(light, &block);
  pn_result result = pni_uniform_buffer_set(pni_light_gpu(light), &light->block, &block, sizeof block);
  if (result == PN_OK) GL(pni_light_gpu(light), BindBufferBase)(GL_UNIFORM_BUFFER, PNI_BLOCK_BINDING, light->block.id);
  return result;
}
