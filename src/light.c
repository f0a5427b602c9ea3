/* Lights: their description, their technique, what shaders read of them. */
#include "light.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "gl/host.h"
#include "maps/maps.h"

/* ---- the object -------------------------------------------------------------------------------------------------- */

static void release_light(pni_object *object, bool abandon) {
  pn_light *light = (pn_light *)object;
  pni_gpu *gpu = pni_light_gpu(light);
  pni_kept_free(gpu, &light->kept, abandon);
  pni_maps_free(gpu, &light->maps, abandon);
  for (int i = 0; i < 2; i++) pni_texture_free(gpu, &light->trim[i], abandon);
  pni_buffer_free(gpu, &light->block, abandon);
  pni_clock_free(gpu, &light->clock, abandon);
}

pn_result pn_light_create(pn_context *context, pn_light **out) {
  if (!context) return PN_ERROR_ARGUMENT;
  if (!out) return pni_fail(&context->gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_light_create: out is NULL");
  *out = pni_object_create(context, release_light, sizeof **out);
  if (!*out) return PN_ERROR_OUT_OF_MEMORY;
  return pn_light_technique(*out, PN_TECHNIQUE_DEFAULT, NULL, 0);
}

void pn_light_destroy(pn_light **light) {
  if (!light || !*light) return;
  pni_object_destroy(&(*light)->object);
  *light = NULL;
}

/* ---- the description --------------------------------------------------------------------------------------------- */

/* Products of extents and distances have to be floats. */
static const float largest_half = 1e9f;

static bool in_range(float value, float most) { return value > 0 && value <= most; }

static pn_result check_shape(pni_gpu *gpu, const pn_light_desc *d) {
  if (d->shape != PN_LIGHT_RECTANGLE && d->shape != PN_LIGHT_SUN)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_SHAPE, "light shape %d is unknown", (int)d->shape);
  float most = d->shape == PN_LIGHT_SUN ? PN_SUN_TANGENT_MAX : largest_half;
  if (!in_range(d->half_u, most) || !in_range(d->half_v, most))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_SIZE, "half extents %g, %g must be positive, at most %g%s",
                    d->half_u, d->half_v, most, d->shape == PN_LIGHT_SUN ? ", the tangent of 45 degrees" : "");
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
  if ((int)d->fit < PN_FIT_VISIBLE || d->fit > PN_FIT_GIVEN)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FIT, "fit %d is unknown", (int)d->fit);
  for (int i = 0; i < 3 && d->fit == PN_FIT_GIVEN; i++)
    if (!isfinite(d->fit_bounds[i]) || !isfinite(d->fit_bounds[3 + i]) || d->fit_bounds[i] > d->fit_bounds[3 + i])
      return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FIT, "fit bounds are inverted or not finite");
  const float *box = d->fit_bounds;
  if (d->fit == PN_FIT_GIVEN && box[0] == box[3] && box[1] == box[4] && box[2] == box[5])
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FIT, "fit bounds are a point: %g, %g, %g", box[0], box[1],
                    box[2]);
  if (d->map_width < 0 || d->map_height < 0 || d->map_width > most || d->map_height > most)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_MAP, "map %d x %d is not within 1..%d", d->map_width,
                    d->map_height, most);
  return PN_OK;
}

static bool is_zero(const float v[3]) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

static pn_result check_frame(pni_gpu *gpu, const pn_light_desc *d) {
  const float *const vectors[] = {d->center, d->direction, d->axis_u};
  static const char *const names[] = {"centre", "direction", "axis_u"};
  for (int i = 0; i < 3; i++)
    if (!pni_floats_finite(vectors[i], 3))
      return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FRAME, "%s %g, %g, %g is not finite", names[i],
                      vectors[i][0], vectors[i][1], vectors[i][2]);
  if (is_zero(d->direction)) return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FRAME, "direction is zero");
  return PN_OK;
}

static pn_result make_frame(pni_gpu *gpu, const pn_light_desc *d, pni_frame *frame) {
  static const float up[3] = {0, 1, 0};
  float axis[3];
  bool derived = is_zero(d->axis_u);
  memcpy(axis, d->axis_u, sizeof axis);
  pn_result result = check_frame(gpu, d);
  if (result != PN_OK) return result;
  bool sound = (!derived || pn_light_frame(d->direction, up, NULL, axis, NULL) == PN_OK) &&
               pni_frame_axes(d->direction, axis, frame);
  if (!sound)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FRAME,
                    "axis_u %g, %g, %g is parallel to direction %g, %g, %g", axis[0], axis[1], axis[2], d->direction[0],
                    d->direction[1], d->direction[2]);
  bool sun = d->shape == PN_LIGHT_SUN;
  frame->projection = sun ? PNI_PARALLEL : PNI_CENTRAL;
  for (int i = 0; i < 3; i++) frame->origin[i] = sun ? 0 : d->center[i];
  return PN_OK;
}

static bool same_numbers(const float *a, const float *b, int count) {
  for (int i = 0; i < count; i++)
    if (a[i] != b[i]) return false;
  return true;
}

/* Member by member: what lies between members says nothing. */
static bool same_light(const pn_light_desc *a, const pn_light_desc *b) {
  return a->shape == b->shape && same_numbers(a->center, b->center, 3) && same_numbers(a->direction, b->direction, 3) &&
         same_numbers(a->axis_u, b->axis_u, 3) && a->half_u == b->half_u && a->half_v == b->half_v &&
         a->near_distance == b->near_distance && a->range == b->range && a->texture == b->texture && a->fit == b->fit &&
         same_numbers(a->fit_bounds, b->fit_bounds, 6) && a->map_width == b->map_width &&
         a->map_height == b->map_height;
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
  pn_light_desc filled = *desc;
  if (!filled.map_width) filled.map_width = 512;
  if (!filled.map_height) filled.map_height = filled.map_width;
  if (filled.fit != PN_FIT_GIVEN) memset(filled.fit_bounds, 0, sizeof filled.fit_bounds); /* not read */
  if (light->set && same_light(&light->desc, &filled)) return PN_OK;
  light->desc = filled;
  light->frame = frame;
  light->emission = (pni_emission){{desc->half_u, desc->half_v}};
  light->set = true;
  light->warned_angle = false;
  light->maps.ready = false;
  return PN_OK;
}

/* ---- the technique ----------------------------------------------------------------------------------------------- */

static bool same_values(const double *a, const double *b) {
  for (int i = 0; i < PNI_PARAMETERS_MAX; i++)
    if (a[i] != b[i]) return false;
  return true;
}

pn_result pn_light_technique(pn_light *light, const char *spec, char *why, size_t why_size) {
  if (!light) return PN_ERROR_ARGUMENT;
  if (why && why_size) snprintf(why, why_size, "%s", spec ? "" : "the technique's spec is NULL");
  if (!spec)
    return pni_fail(pni_light_gpu(light), PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT,
                    "pn_light_technique: spec is NULL");
  const pni_technique_class *technique;
  double values[PNI_PARAMETERS_MAX];
  pni_explanation explanation;
  pn_result result = pni_spec_read(spec, &technique, values, &explanation);
  if (why && why_size) snprintf(why, why_size, "%s", explanation.text);
  if (result != PN_OK) return pni_fail(pni_light_gpu(light), result, explanation.message, "%s", explanation.text);
  if (technique == light->technique && same_values(values, light->values)) return PN_OK;
  light->technique = technique;
  memcpy(light->values, values, sizeof values);
  light->maps.ready = false;
  return PN_OK;
}

pn_result pn_light_parameter(pn_light *light, const char *name, double value) {
  if (!light) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = pni_light_gpu(light);
  if (!name) return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_light_parameter: name is NULL");
  pni_maps_want before, after;
  pni_explanation explanation;
  light->technique->want(light->values, &before);
  pn_result result = pni_parameter_set(light->technique, name, value, light->values, &explanation);
  if (result != PN_OK) return pni_fail(gpu, result, explanation.message, "%s", explanation.text);
  light->technique->want(light->values, &after);
  if (!pni_want_same(&before, &after)) light->maps.ready = false;
  return PN_OK;
}

/* ---- for the passes ---------------------------------------------------------------------------------------------- */

void pni_light_fill_block(const pn_light *light, pni_light_block *block) {
  *block = light->maps.block;
  for (int i = 0; i < light->technique->table.parameter_count; i++) block->parameters[i] = (float)light->values[i];
}

/* The block is floats from end to end, so that its bytes are what it says. */
pn_result pni_light_bind_block(pn_light *light) {
  pni_gpu *gpu = pni_light_gpu(light);
  pni_light_block block;
  if (gpu->plan.on) return pni_buffer_reserve(gpu, &light->block, "light", PNI_BUFFER_BLOCK, sizeof block);
  pni_light_fill_block(light, &block);
  if (!light->block.id || memcmp(&block, &light->uploaded, sizeof block) != 0) {
    pn_result result = pni_buffer_fill(gpu, &light->block, "light", PNI_BUFFER_BLOCK, &block, sizeof block);
    if (result != PN_OK) return result;
    light->uploaded = block;
  }
  pni_bind_block(gpu, &light->block);
  return PN_OK;
}

pn_result pni_light_job(pn_light *light, pni_job *out) {
  const pni_technique_class *technique = light->technique;
  *out = (pni_job){.gpu = pni_light_gpu(light),
                   .table = &technique->table,
                   .gathering = &technique->gathering,
                   .values = light->values,
                   .desc = &light->desc,
                   .frame = &light->frame,
                   .emission = &light->emission,
                   .maps = &light->maps,
                   .casters = (pn_casters *)pni_object_find(light->object.context, light->casters),
                   .groups = light->groups,
                   .visible = light->has_visible ? &light->visible : NULL,
                   .clock = &light->clock};
  return pni_kept_get(out->gpu, &light->kept, &technique->light_kind, &out->light_state);
}
