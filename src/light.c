#include "light.h"

#include <math.h>
#include <string.h>

#include "search/gather.h"

static pn_gpu *gpu_of(const pn_light *light) { return &light->object.context->gpu; }

/* ---- the object -------------------------------------------------------------------------------------------------- */

pn_result pn_light_create(pn_context *context, pn_light **out) {
  if (!context) return PN_ERROR_ARGUMENT;
  if (!out) return pn_fail(&context->gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_light_create: out is NULL");
  *out = pn_object_create(context, PN_OBJECT_LIGHT, sizeof **out);
  if (!*out) return PN_ERROR_OUT_OF_MEMORY;
  return pn_light_technique(*out, PN_TECHNIQUE_DEFAULT, NULL, 0);
}

void pn_light_free(pn_light *light, bool abandon) {
  pn_gpu *gpu = gpu_of(light);
  pn_pairs_drop(&light->object, abandon);
  pn_maps_free(gpu, &light->maps, abandon);
  pn_uniform_buffer_free(gpu, &light->block, abandon);
  pn_clock_free(gpu, &light->clock, abandon);
  pn_object_unlink(&light->object);
  pn_free(gpu, light);
}

void pn_light_destroy(pn_light **light) {
  if (!light || !*light) return;
  pn_context *context = (*light)->object.context;
  pn_enter(context);
  pn_light_free(*light, false);
  pn_leave(context, PN_OK);
  *light = NULL;
}

/* ---- the description --------------------------------------------------------------------------------------------- */

static bool positive(float value) { return isfinite(value) && value > 0; }

static pn_result check_shape(pn_gpu *gpu, const pn_light_desc *d) {
  if (d->shape != PN_LIGHT_RECTANGLE && d->shape != PN_LIGHT_SUN)
    return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_SHAPE, "light shape %d is unknown", (int)d->shape);
  float most = d->shape == PN_LIGHT_SUN ? PN_SUN_TANGENT_MAX : INFINITY;
  if (!positive(d->half_u) || !positive(d->half_v) || d->half_u > most || d->half_v > most)
    return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_SIZE, "half extents %g, %g must be positive and finite%s",
                   d->half_u, d->half_v, d->shape == PN_LIGHT_SUN ? ", at most a tangent of 1" : "");
  if (!isfinite(d->near_distance) || !isfinite(d->range) || d->near_distance < 0 || d->range < 0 ||
      (d->range > 0 && d->near_distance >= d->range))
    return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_RANGE, "near distance %g and range %g do not make a range",
                   d->near_distance, d->range);
  if (d->texture)
    return pn_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_LIGHT_TEXTURE, "textured lights are not supported yet");
  return PN_OK;
}

static pn_result check_maps(pn_gpu *gpu, const pn_light_desc *d) {
  int most = gpu->can.texture_size_max < PN_MAP_SIZE_MAX ? gpu->can.texture_size_max : PN_MAP_SIZE_MAX;
  if ((int)d->fit < PN_FIT_CASTERS || d->fit > PN_FIT_GIVEN)
    return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FIT, "fit %d is unknown", (int)d->fit);
  for (int i = 0; i < 3 && d->fit == PN_FIT_GIVEN; i++)
    if (!isfinite(d->fit_bounds[i]) || !isfinite(d->fit_bounds[3 + i]) || d->fit_bounds[i] > d->fit_bounds[3 + i])
      return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FIT, "fit bounds are inverted or not finite");
  if (d->map_width < 0 || d->map_height < 0 || d->map_width > most || d->map_height > most)
    return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_MAP, "map %d x %d is not within 1..%d", d->map_width,
                   d->map_height, most);
  return PN_OK;
}

static pn_result make_frame(pn_gpu *gpu, const pn_light_desc *d, pn_frame *frame) {
  static const float up[3] = {0, 1, 0};
  float axis[3];
  bool derived = d->axis_u[0] == 0 && d->axis_u[1] == 0 && d->axis_u[2] == 0;
  memcpy(axis, d->axis_u, sizeof axis);
  bool sound = pn_floats_finite(d->center, 3) && pn_floats_finite(d->direction, 3) && pn_floats_finite(axis, 3) &&
               (!derived || pn_light_frame(d->direction, up, NULL, axis, NULL) == PN_OK) &&
               pn_frame_axes(d->direction, axis, frame);
  if (!sound)
    return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_LIGHT_FRAME,
                   "centre, direction and axis must be finite, direction and axis neither zero nor parallel");
  frame->sun = d->shape == PN_LIGHT_SUN;
  for (int i = 0; i < 3; i++) frame->origin[i] = frame->sun ? 0 : d->center[i];
  frame->extent[0] = d->half_u;
  frame->extent[1] = d->half_v;
  return PN_OK;
}

pn_result pn_light_set(pn_light *light, const pn_light_desc *desc) {
  if (!light) return PN_ERROR_ARGUMENT;
  pn_gpu *gpu = gpu_of(light);
  if (!desc) return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_light_set: desc is NULL");
  pn_frame frame;
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
    return pn_fail(gpu_of(light), PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_light_technique: spec is NULL");
  }
  char text[512];
  const pn_technique *table;
  double values[PN_PARAMETERS_MAX] = {0};
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
    return pn_fail(gpu_of(light), result, message, "%s", text);
  }
  const pn_technique_class *technique = pn_technique_class_of(table);
  if (technique == light->technique && !memcmp(values, light->values, sizeof values)) return PN_OK;
  light->technique = technique;
  memcpy(light->values, values, sizeof values);
  light->maps.ready = false;
  return PN_OK;
}

pn_result pn_light_parameter(pn_light *light, const char *name, double value) {
  if (!light) return PN_ERROR_ARGUMENT;
  pn_gpu *gpu = gpu_of(light);
  pn_message message;
  if (!name) return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_light_parameter: name is NULL");
  pn_maps_want before, after;
  light->technique->want(light->values, &before);
  if (!pn_parameter_set(&light->technique->table, name, value, light->values, &message))
    return pn_fail(gpu, PN_ERROR_ARGUMENT, message, "technique %s: %s = %g", light->technique->table.name, name, value);
  light->technique->want(light->values, &after);
  if (memcmp(&before, &after, sizeof before)) light->maps.ready = false;
  return PN_OK;
}

pn_result pn_prepare(pn_context *context, const char *spec) {
  if (!context) return PN_ERROR_ARGUMENT;
  pn_gpu *gpu = &context->gpu;
  char why[512];
  const pn_technique *table;
  double values[PN_PARAMETERS_MAX] = {0};
  if (pn_technique_parse(spec ? spec : PN_TECHNIQUE_DEFAULT, &table, values, why, sizeof why) != PN_OK)
    return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_TECHNIQUE_UNKNOWN, "%s", why);
  const pn_technique_class *technique = pn_technique_class_of(table);
  char defines[PN_TECHNIQUE_DEFINES];
  pn_maps_want want;
  technique->want(values, &want);
  pn_technique_defines(technique, values, defines);
  pn_enter(context);
  pn_result result = pn_maps_prepare(gpu, &want);
  if (result == PN_OK)
    result = technique->prepare ? technique->prepare(gpu, values) : pn_gather_prepare(gpu, technique->shader, defines);
  return pn_leave(context, result);
}

/* ---- maps -------------------------------------------------------------------------------------------------------- */

static pn_result check_lost(pn_gpu *gpu) {
  if (!gpu->can.robustness || GL(gpu, GetGraphicsResetStatus)() == GL_NO_ERROR) return PN_OK;
  return pn_fail(gpu, PN_ERROR_CONTEXT_LOST, PN_MESSAGE_GL_LOST, "the GL context was reset");
}

void pn_light_fill_block(const pn_light *light, pn_light_block *block) {
  *block = light->maps.block;
  for (int i = 0; i < light->technique->table.parameter_count; i++) block->parameters[i] = (float)light->values[i];
}

static pn_result bind_block(pn_light *light) {
  pn_light_block block;
  pn_light_fill_block(light, &block);
  pn_result result = pn_uniform_buffer_set(gpu_of(light), &light->block, &block, sizeof block);
  if (result == PN_OK) GL(gpu_of(light), BindBufferBase)(GL_UNIFORM_BUFFER, PN_BLOCK_BINDING, light->block.id);
  return result;
}

/* What PN_FIT_FRUSTUM looks at; for PN_FIT_VISIBLE too it comes first, because it costs nothing and may settle the
 * matter. */
static pn_result find_frusta(pn_light *light, pn_receiver *const *receivers, int count) {
  bool wanted = light->desc.fit == PN_FIT_VISIBLE || light->desc.fit == PN_FIT_FRUSTUM;
  light->has_visible = wanted && count > 0;
  light->visible = pn_region_empty();
  for (int i = 0; i < count && light->has_visible; i++) {
    if (!receivers[i] || !receivers[i]->set)
      return pn_fail(gpu_of(light), PN_ERROR_NOT_READY, PN_MESSAGE_RECEIVER_UNSET, "visible receiver %d was never set", i);
    pn_receiver_frustum(receivers[i], &light->frame, &light->visible);
  }
  return PN_OK;
}

/* What PN_FIT_VISIBLE looks at: the surfaces themselves. */
static pn_result find_surfaces(pn_light *light, pn_receiver *const *receivers, int count) {
  light->visible = pn_region_empty();
  pn_block_frame(&light->maps.block, &light->frame, gpu_of(light), 0, 0, 1, 1);
  pn_result result = bind_block(light);
  for (int i = 0; i < count && result == PN_OK; i++)
    result = pn_receiver_bounds(receivers[i], &light->frame, &light->visible);
  pn_clock_mark(gpu_of(light), &light->clock, "fit");
  return result;
}

static void fit_light(pn_light *light) {
  const pn_light_desc *d = &light->desc;
  pn_fit_request request = {.frame = &light->frame, .near_distance = d->near_distance, .range = d->range,
                            .width = d->map_width, .height = d->map_height,
                            .given = d->fit == PN_FIT_GIVEN ? d->fit_bounds : NULL,
                            .visible = light->has_visible ? &light->visible : NULL};
  pn_fit_maps(light->casters, light->groups, &request, &light->maps.fit);
  if (!light->maps.fit.clamped || light->warned_angle) return;
  light->warned_angle = true;
  pn_note(gpu_of(light), PN_LOG_WARNING, PN_MESSAGE_LIGHT_ANGLE,
          "the map would open past 170 degrees; casters beyond are left out");
}

static pn_map_draw tile_draw(const pn_light *light, int tile) {
  const pn_fit_result *fit = &light->maps.fit;
  pn_map_draw draw = {.frame = &light->frame, .casters = light->casters, .groups = light->groups, .map = tile,
                      .w_near = fit->w_near, .w_far = fit->w_far};
  memcpy(draw.bounds, fit->tile[tile], sizeof draw.bounds);
  return draw;
}

static pn_result draw_maps(pn_light *light, const pn_maps_want *want) {
  pn_gpu *gpu = gpu_of(light);
  pn_maps *maps = &light->maps;
  int width = light->desc.map_width, height = light->desc.map_height;
  pn_result result = pn_maps_shape(gpu, maps, want, maps->fit.tiles, width, height);
  if (result != PN_OK) return result;
  pn_block_frame(&maps->block, &light->frame, gpu, maps->fit.tiles, maps->layers, width, height);
  for (int tile = 0; tile < maps->fit.tiles && result == PN_OK; tile++) {
    pn_map_draw draw = tile_draw(light, tile);
    pn_block_map(&maps->block, gpu, &draw, width, height);
    result = pn_maps_draw(gpu, maps, &draw);
  }
  pn_clock_mark(gpu, &light->clock, "depth_map");
  if (result != PN_OK || !want->range.structure) return result;
  result = bind_block(light);
  if (result == PN_OK) result = pn_range_build(gpu, maps);
  pn_clock_mark(gpu, &light->clock, "range");
  return result;
}

static pn_result update_maps(pn_light *light, pn_receiver *const *visible, int visible_count) {
  pn_result result = check_lost(gpu_of(light));
  if (result == PN_OK) result = find_frusta(light, visible, visible_count);
  if (result != PN_OK) return result;
  fit_light(light);
  if (light->desc.fit == PN_FIT_VISIBLE && light->has_visible && !light->maps.fit.empty) {
    result = find_surfaces(light, visible, visible_count);
    if (result != PN_OK) return result;
    fit_light(light);
  }
  pn_maps_want want;
  light->technique->want(light->values, &want);
  if (!light->maps.fit.empty && pn_want_layers(&want) > 0) result = draw_maps(light, &want);
  light->maps.ready = result == PN_OK;
  return result;
}

pn_result pn_maps_update(pn_light *light, pn_casters *casters, uint32_t groups, pn_receiver *const *visible,
                         int visible_count) {
  if (!light) return PN_ERROR_ARGUMENT;
  pn_gpu *gpu = gpu_of(light);
  if (!casters || (visible_count > 0 && !visible) || visible_count < 0)
    return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_maps_update: casters or visible is NULL");
  if (!light->set) return pn_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_LIGHT_UNSET, "pn_light_set comes first");
  light->casters = casters;
  light->groups = groups;
  pn_enter(light->object.context);
  pn_clock_start(gpu, &light->clock);
  pn_result result = update_maps(light, visible, visible_count);
  pn_clock_end(gpu, &light->clock);
  return pn_leave(light->object.context, result);
}

pn_result pn_light_maps(const pn_light *light, pn_maps_info *out) {
  if (!light) return PN_ERROR_ARGUMENT;
  if (!out) return pn_fail(gpu_of(light), PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_light_maps: out is NULL");
  const pn_maps *maps = &light->maps;
  if (!maps->ready)
    return pn_fail(gpu_of(light), PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "pn_maps_update comes first");
  const double *b = maps->fit.bounds;
  *out = (pn_maps_info){
      .empty = maps->fit.empty, .tiles = maps->fit.tiles, .layers = maps->layers,
      .width = light->desc.map_width, .height = light->desc.map_height,
      .s0 = (float)b[0], .t0 = (float)b[1], .s1 = (float)b[2], .t1 = (float)b[3],
      .w_near = (float)maps->fit.w_near, .w_far = (float)maps->fit.w_far,
      .gpu_memory = maps->depth.bytes + maps->range.bytes + maps->peel[0].bytes + maps->peel[1].bytes,
  };
  return PN_OK;
}

/* ---- visibility -------------------------------------------------------------------------------------------------- */

static bool is_alive(const pn_context *context, const void *object) {
  for (const pn_object *o = context->objects; o; o = o->next)
    if (o == object) return true;
  return false;
}

static pn_result fill_with_light(pn_gpu *gpu, pn_attachment target, int width, int height) {
  pn_pass pass = {.color = {target}, .width = width, .height = height};
  pn_result result = pn_pass_begin(gpu, &pass);
  static const GLfloat one[4] = {1, 1, 1, 1};
  if (result == PN_OK) {
    /* The host's own texture may be larger than the view: only the view is written. */
    pn_set_switch(gpu, GL_SCISSOR_TEST, true);
    pn_set_scissor(gpu, 0, 0, width, height);
    GL(gpu, ClearBufferfv)(GL_COLOR, 0, one);
    pn_set_switch(gpu, GL_SCISSOR_TEST, false);
  }
  return result;
}

static pn_result draw_visibility(pn_light *light, pn_receiver *receiver, pn_pair *pair, pn_attachment target) {
  pn_gpu *gpu = gpu_of(light);
  const pn_technique_class *technique = light->technique;
  pn_result result = PN_OK;
  if (light->maps.fit.empty) {
    result = fill_with_light(gpu, target, receiver->desc.width, receiver->desc.height);
    pn_clock_mark(gpu, &pair->clock, "visibility");
    return result;
  }
  if (technique->shader) {
    result = bind_block(light);
    if (result != PN_OK) return result;
    char defines[PN_TECHNIQUE_DEFINES];
    pn_technique_defines(technique, light->values, defines);
    pn_gathering gathering = {gpu, technique->shader, defines, technique->searches, &light->frame, &light->maps, receiver, pair, target};
    return pn_gather(&gathering);
  }
  if (!is_alive(light->object.context, light->casters))
    return pn_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "the casters of the last pn_maps_update are gone");
  pn_visibility_request request = {gpu, &light->desc, &light->frame, light->values, &light->maps, &light->block,
                                   light->casters, light->groups, light->has_visible ? &light->visible : NULL, receiver,
                                   pair, target};
  return technique->draw(&request);
}

static pn_result check_pair(pn_light *light, pn_receiver *receiver) {
  pn_gpu *gpu = gpu_of(light);
  if (!receiver || receiver->object.context != light->object.context)
    return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "receiver is NULL, or of another context");
  if (!receiver->set) return pn_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_RECEIVER_UNSET, "pn_receiver_set comes first");
  if (!light->maps.ready)
    return pn_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "pn_maps_update comes first");
  return PN_OK;
}

static GLenum result_format(pn_format format) {
  return format == PN_FORMAT_R32F ? GL_R32F : format == PN_FORMAT_R8 ? GL_R8 : GL_R16F;
}

static pn_result timed_visibility(pn_light *light, pn_receiver *receiver, pn_pair *pair, pn_attachment target) {
  pn_gpu *gpu = gpu_of(light);
  pn_clock_start(gpu, &pair->clock);
  pn_result result = draw_visibility(light, receiver, pair, target);
  pn_clock_end(gpu, &pair->clock);
  return result;
}

pn_result pn_visibility(pn_light *light, pn_receiver *receiver) {
  if (!light) return PN_ERROR_ARGUMENT;
  pn_result result = check_pair(light, receiver);
  if (result != PN_OK) return result;
  pn_pair *pair = pn_pair_get(&light->object, &receiver->object);
  if (!pair) return PN_ERROR_OUT_OF_MEMORY;
  const pn_receiver_desc *view = &receiver->desc;
  pn_enter(light->object.context);
  result = check_lost(gpu_of(light));
  if (result == PN_OK)
    result = pn_texture_shape(gpu_of(light), &pair->image, result_format(view->format), view->width, view->height, 0, 1);
  pn_attachment target = {pair->image.id, GL_TEXTURE_2D, 0, 0};
  if (result == PN_OK) result = timed_visibility(light, receiver, pair, target);
  pair->drawn = result == PN_OK;
  return pn_leave(light->object.context, result);
}

pn_result pn_result_image(pn_light *light, pn_receiver *receiver, pn_image *out) {
  if (!light) return PN_ERROR_ARGUMENT;
  pn_gpu *gpu = gpu_of(light);
  if (!receiver || !out)
    return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_result_image: receiver or out is NULL");
  pn_pair *pair = pn_pair_find(&light->object, &receiver->object);
  if (!pair || !pair->drawn)
    return pn_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "pn_visibility has not drawn this pair yet");
  pn_texture_image(&pair->image, out);
  return PN_OK;
}

/* ---- into the host's texture ------------------------------------------------------------------------------------- */

static void texture_extent(pn_gpu *gpu, GLenum target, pn_gl texture, GLint size[3]) {
  GL(gpu, ActiveTexture)(GL_TEXTURE0 + PN_UNIT_WORK);
  GL(gpu, BindTexture)(target, texture);
  GL(gpu, GetTexLevelParameteriv)(target, 0, GL_TEXTURE_WIDTH, &size[0]);
  GL(gpu, GetTexLevelParameteriv)(target, 0, GL_TEXTURE_HEIGHT, &size[1]);
  GL(gpu, GetTexLevelParameteriv)(target, 0, GL_TEXTURE_DEPTH, &size[2]);
  GL(gpu, BindTexture)(target, 0);
}

static pn_result host_target(pn_gpu *gpu, const pn_receiver_desc *view, pn_gl texture, int layer, pn_attachment *out) {
  GLint layered = 0, size[3] = {0};
  bool sound = texture && GL(gpu, IsTexture)(texture);
  if (sound) {
    GLenum color = GL_COLOR_ATTACHMENT0;
    GL(gpu, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, gpu->framebuffer);
    GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
    GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D, 0, 0);
    GL(gpu, FramebufferTexture)(GL_DRAW_FRAMEBUFFER, color, texture, 0);
    GL(gpu, DrawBuffers)(1, &color);
    sound = GL(gpu, CheckFramebufferStatus)(GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    if (sound)
      GL(gpu, GetFramebufferAttachmentParameteriv)
    (GL_DRAW_FRAMEBUFFER, color, GL_FRAMEBUFFER_ATTACHMENT_LAYERED, &layered);
    GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, color, GL_TEXTURE_2D, 0, 0);
  }
  GLenum target = layered ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
  if (sound) texture_extent(gpu, target, texture, size);
  if (!sound || size[0] < view->width || size[1] < view->height || layer < 0 || layer >= (layered ? size[2] : 1))
    return pn_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RESULT_TARGET,
                   "texture %u cannot take a view of %d x %d in layer %d", texture, view->width, view->height, layer);
  *out = (pn_attachment){texture, target, 0, layer};
  return PN_OK;
}

pn_result pn_visibility_into(pn_light *light, pn_receiver *receiver, pn_gl texture, int layer) {
  if (!light) return PN_ERROR_ARGUMENT;
  pn_result result = check_pair(light, receiver);
  if (result != PN_OK) return result;
  pn_pair *pair = pn_pair_get(&light->object, &receiver->object);
  if (!pair) return PN_ERROR_OUT_OF_MEMORY;
  pn_attachment target;
  pn_enter(light->object.context);
  result = check_lost(gpu_of(light));
  if (result == PN_OK) result = host_target(gpu_of(light), &receiver->desc, texture, layer, &target);
  if (result == PN_OK) result = timed_visibility(light, receiver, pair, target);
  return pn_leave(light->object.context, result);
}

/* ---- looking inside ---------------------------------------------------------------------------------------------- */

int pn_debug_image(pn_light *light, pn_receiver *receiver, int index, const char **name, pn_image *out) {
  if (!light || !out || index < 0) return 0;
  const pn_pair *pair = receiver ? pn_pair_find(&light->object, &receiver->object) : NULL;
  const struct { const char *name; const pn_texture *texture; } all[] = {
      {"depth", &light->maps.depth},
      {"range", &light->maps.range},
      {"low", pair ? &pair->low : NULL},
      {"search", pair ? &pair->search : NULL},
      {"visibility", pair ? &pair->image : NULL},
  };
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    if (!all[i].texture || !all[i].texture->id || index-- > 0) continue;
    if (name) *name = all[i].name;
    pn_texture_image(all[i].texture, out);
    return 1;
  }
  return 0;
}

static int add_times(pn_gpu *gpu, pn_clock *clock, bool wait, pn_time *out, int capacity, int count) {
  pn_clock_read(gpu, clock, wait);
  for (int i = 0; i < clock->count; i++) {
    int at = 0;
    while (at < count && at < capacity && strcmp(out[at].stage, clock->stage[i])) at++;
    if (at < count && at < capacity) {
      out[at].milliseconds += clock->milliseconds[i];
      continue;
    }
    if (count < capacity) out[count] = (pn_time){clock->stage[i], clock->milliseconds[i]};
    count++;
  }
  return count;
}

int pn_times(pn_light *light, pn_time *out, int capacity, int wait) {
  if (!light || capacity < 0 || (capacity > 0 && !out)) return 0;
  pn_gpu *gpu = gpu_of(light);
  int count = add_times(gpu, &light->clock, wait != 0, out, capacity, 0);
  for (pn_pair *pair = light->object.context->pairs; pair; pair = pair->next)
    if (pair->light == &light->object) count = add_times(gpu, &pair->clock, wait != 0, out, capacity, count);
  return count;
}
