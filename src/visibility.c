/* From maps to visibility buffers: into the library's own images or the host's, and what can be looked at on the way. */
#include <string.h>

#include "light.h"
#include "search/gather.h"

/* ---- visibility -------------------------------------------------------------------------------------------------- */

static bool is_alive(const pn_context *context, const void *object) {
  for (const pni_object *o = context->objects; o; o = o->next)
    if (o == object) return true;
  return false;
}

static pn_result draw_visibility(pn_light *light, pn_receiver *receiver, pni_pair *pair, pni_attachment target) {
  pni_gpu *gpu = pni_light_gpu(light);
  const pni_technique_class *technique = light->technique;
  pn_result result = PN_OK;
  pni_pair_begin(gpu, pair, technique);
  if (light->maps.fit.empty) {
    result = pni_fill(gpu, target, receiver->desc.width, receiver->desc.height, 1);
    pni_clock_mark(gpu, &pair->clock, "visibility");
    return result;
  }
  result = pni_light_bind_block(light);
  if (result != PN_OK) return result;
  if (technique->shader) {
    char defines[PNI_TECHNIQUE_DEFINES];
    pni_technique_defines(technique, light->values, defines);
    pni_gathering gathering = {
        gpu, technique->shader, defines, technique->searches, &light->frame, &light->maps, receiver, pair, target};
    return pni_gather(&gathering);
  }
  if (!is_alive(light->object.context, light->casters))
    return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "the casters of the last pn_maps_update are gone");
  pni_visibility_request request = {gpu,
                                    &light->desc,
                                    &light->frame,
                                    light->values,
                                    &light->maps,
                                    &light->block,
                                    light->casters,
                                    light->groups,
                                    light->has_visible ? &light->visible : NULL,
                                    receiver,
                                    pair,
                                    target};
  return technique->draw(&request);
}

static pn_result check_pair(pn_light *light, pn_receiver *receiver) {
  pni_gpu *gpu = pni_light_gpu(light);
  if (!receiver || receiver->object.context != light->object.context)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "receiver is NULL, or of another context");
  if (!receiver->set)
    return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_RECEIVER_UNSET, "pn_receiver_set comes first");
  if (!light->maps.ready) return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "pn_maps_update comes first");
  return PN_OK;
}

static GLenum result_format(pn_format format) {
  return format == PN_FORMAT_R32F ? GL_R32F : format == PN_FORMAT_R8 ? GL_R8 : GL_R16F;
}

static pn_result timed_visibility(pn_light *light, pn_receiver *receiver, pni_pair *pair, pni_attachment target) {
  pni_gpu *gpu = pni_light_gpu(light);
  pni_clock_start(gpu, &pair->clock);
  pn_result result = draw_visibility(light, receiver, pair, target);
  pni_clock_end(gpu, &pair->clock);
  return result;
}

pn_result pn_visibility(pn_light *light, pn_receiver *receiver) {
  if (!light) return PN_ERROR_ARGUMENT;
  pn_result result = check_pair(light, receiver);
  if (result != PN_OK) return result;
  pni_pair *pair = pni_pair_get(&light->object, &receiver->object);
  if (!pair) return PN_ERROR_OUT_OF_MEMORY;
  const pn_receiver_desc *view = &receiver->desc;
  pni_enter(light->object.context);
  result = pni_gpu_check_lost(pni_light_gpu(light));
  if (result == PN_OK)
    result = pni_texture_shape(pni_light_gpu(light), &pair->image, result_format(view->format), view->width,
                               view->height, 0, 1);
  pni_attachment target = {pair->image.id, GL_TEXTURE_2D, 0, 0};
  if (result == PN_OK) result = timed_visibility(light, receiver, pair, target);
  pair->drawn = result == PN_OK;
  return pni_leave(light->object.context, result);
}

pn_result pn_result_image(pn_light *light, pn_receiver *receiver, pn_image *out) {
  if (!light) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = pni_light_gpu(light);
  if (!receiver || !out)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_result_image: receiver or out is NULL");
  pni_pair *pair = pni_pair_find(&light->object, &receiver->object);
  if (!pair || !pair->drawn)
    return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "pn_visibility has not drawn this pair yet");
  pni_texture_image(&pair->image, out);
  return PN_OK;
}

pn_result pn_soft_shadow_map_image(pn_light *light, pn_receiver *receiver, pn_soft_shadow_map *out) {
  if (!light) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = pni_light_gpu(light);
  if (!receiver || !out)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT,
                    "pn_soft_shadow_map_image: receiver or out is NULL");
  pni_pair *pair = pni_pair_find(&light->object, &receiver->object);
  if (!pair || !pair->soft.image.texture)
    return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "the pair's last result has no soft shadow map");
  *out = pair->soft;
  return PN_OK;
}

/* ---- into the host's texture ------------------------------------------------------------------------------------- */

static void texture_extent(pni_gpu *gpu, GLenum target, pn_gl texture, GLint size[3]) {
  GL(gpu, ActiveTexture)(GL_TEXTURE0 + PNI_UNIT_WORK);
  GL(gpu, BindTexture)(target, texture);
  GL(gpu, GetTexLevelParameteriv)(target, 0, GL_TEXTURE_WIDTH, &size[0]);
  GL(gpu, GetTexLevelParameteriv)(target, 0, GL_TEXTURE_HEIGHT, &size[1]);
  GL(gpu, GetTexLevelParameteriv)(target, 0, GL_TEXTURE_DEPTH, &size[2]);
  GL(gpu, BindTexture)(target, 0);
}

static pn_result host_target(pni_gpu *gpu, const pn_receiver_desc *view, pn_gl texture, int layer,
                             pni_attachment *out) {
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
    if (sound) GL(gpu, GetFramebufferAttachmentParameteriv)
    (GL_DRAW_FRAMEBUFFER, color, GL_FRAMEBUFFER_ATTACHMENT_LAYERED, &layered);
    GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, color, GL_TEXTURE_2D, 0, 0);
  }
  GLenum target = layered ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
  if (sound) texture_extent(gpu, target, texture, size);
  if (!sound || size[0] < view->width || size[1] < view->height || layer < 0 || layer >= (layered ? size[2] : 1))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RESULT_TARGET,
                    "texture %u cannot take a view of %d x %d in layer %d", texture, view->width, view->height, layer);
  *out = (pni_attachment){texture, target, 0, layer};
  return PN_OK;
}

pn_result pn_visibility_into(pn_light *light, pn_receiver *receiver, pn_gl texture, int layer) {
  if (!light) return PN_ERROR_ARGUMENT;
  pn_result result = check_pair(light, receiver);
  if (result != PN_OK) return result;
  pni_pair *pair = pni_pair_get(&light->object, &receiver->object);
  if (!pair) return PN_ERROR_OUT_OF_MEMORY;
  pni_attachment target;
  pni_enter(light->object.context);
  result = pni_gpu_check_lost(pni_light_gpu(light));
  if (result == PN_OK) result = host_target(pni_light_gpu(light), &receiver->desc, texture, layer, &target);
  if (result == PN_OK) result = timed_visibility(light, receiver, pair, target);
  return pni_leave(light->object.context, result);
}

/* ---- looking inside ---------------------------------------------------------------------------------------------- */

int pn_debug_image(pn_light *light, pn_receiver *receiver, int index, const char **name, pn_image *out) {
  if (!light || !out || index < 0) return 0;
  const pni_pair *pair = receiver ? pni_pair_find(&light->object, &receiver->object) : NULL;
  const struct {
    const char *name;
    const pni_texture *texture;
  } all[] = {
      {"depth", &light->maps.depth},
      {"range", &light->maps.range},
      {"low", pair ? &pair->low : NULL},
      {"search", pair ? &pair->search : NULL},
      {"receivers", pair ? &pair->seen.layers : NULL},
      {"covered", pair ? &pair->covered : NULL},
      {"bound", pair ? &pair->bound : NULL},
      {"visibility", pair ? &pair->image : NULL},
  };
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    if (!all[i].texture || !all[i].texture->id || index-- > 0) continue;
    if (name) *name = all[i].name;
    pni_texture_image(all[i].texture, out);
    return 1;
  }
  return 0;
}

static int add_times(pni_gpu *gpu, pni_clock *clock, bool wait, pn_time *out, int capacity, int count) {
  pni_clock_read(gpu, clock, wait);
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
  pni_gpu *gpu = pni_light_gpu(light);
  int count = add_times(gpu, &light->clock, wait != 0, out, capacity, 0);
  for (pni_pair *pair = light->object.context->pairs; pair; pair = pair->next)
    if (pair->light == &light->object) count = add_times(gpu, &pair->clock, wait != 0, out, capacity, count);
  return count;
}
