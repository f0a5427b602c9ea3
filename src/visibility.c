/* From maps to visibility buffers: into images of the library or of the host, and what can be looked at on the way. */
#include <string.h>

#include "gl/device.h"
#include "gl/host.h"
#include "gl/inspect.h"
#include "gl/plan.h"
#include "light.h"

/* ---- visibility -------------------------------------------------------------------------------------------------- */

static pn_result draw_visibility(pn_light *light, pn_receiver *receiver, pni_pair *pair, pni_target target) {
  const pni_technique_class *technique = light->technique;
  bool empty = light->maps.fit.empty;
  pni_job job;
  pn_result result = pni_light_job(light, &job);
  if (result == PN_OK) result = pni_kept_get(job.gpu, &pair->kept, &technique->pair_kind, &job.pair_state);
  if (result != PN_OK) return result;
  job.clock = &pair->clock;
  job.receiver = receiver;
  job.low = &pair->low;
  job.search = &pair->search;
  job.levels = &pair->levels;
  job.target = target;
  if (!job.gpu->plan.on) pair->asked = !empty;
  if (empty) {
    pni_pass pass = pni_job_pass(&job, NULL, (pni_program_key){0});
    result = pni_fill(job.gpu, "nothing casts", &pass, 1);
    pni_job_mark(&job, "visibility");
    return result;
  }
  result = pni_light_bind_block(light);
  if (result == PN_OK) result = pni_receiver_surfaces(receiver);
  return result == PN_OK ? technique->draw(&job) : result;
}

/* Where a result goes. */
typedef struct {
  pni_target host; /* no texture: into the pair's image, of that format */
  pni_format format;
} destination;

static pn_result make_visibility(pn_light *light, pn_receiver *receiver, pni_pair *pair, const destination *to) {
  const pn_receiver_desc *view = &receiver->desc;
  if (to->host.image.texture) return draw_visibility(light, receiver, pair, to->host);
  pn_result result =
      pni_texture_shape(pni_light_gpu(light), &pair->image, "visibility", to->format, view->width, view->height, 0, 1);
  pni_target target = {pni_image_of(&pair->image, 0, 0), 0};
  return result == PN_OK ? draw_visibility(light, receiver, pair, target) : result;
}

/* A failure leaves the pair's result, and what another technique kept with it. */
static pn_result plan_visibility(pn_light *light, pn_receiver *receiver, pni_pair *pair, const destination *to) {
  pni_gpu *gpu = pni_light_gpu(light);
  pni_kept before = pair->kept;
  bool other = before.state && before.kind != &light->technique->pair_kind;
  if (other) pair->kept = (pni_kept){0};
  pni_plan_begin(gpu, pair->drawn);
  pn_result result = pni_plan_end(gpu, make_visibility(light, receiver, pair, to));
  if (!other) return result;
  pni_kept_free(gpu, result == PN_OK ? &before : &pair->kept, false);
  if (result != PN_OK) pair->kept = before;
  return result;
}

static pn_result timed_visibility(pn_light *light, pn_receiver *receiver, pni_pair *pair, const destination *to) {
  pni_gpu *gpu = pni_light_gpu(light);
  pn_result result = pni_receiver_open(receiver);
  if (result != PN_OK) return result;
  result = plan_visibility(light, receiver, pair, to);
  if (result == PN_OK) {
    if (!to->host.image.texture) pair->drawn = false;
    pni_clock_start(gpu, &pair->clock);
    result = make_visibility(light, receiver, pair, to);
    pni_clock_end(gpu, &pair->clock);
  }
  pni_receiver_close(receiver);
  return result;
}

static pn_result check_pair(pn_light *light, pn_receiver *receiver) {
  pni_gpu *gpu = pni_light_gpu(light);
  if (!receiver) return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "receiver is NULL");
  if (receiver->object.context != light->object.context)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "the receiver is of another context");
  if (!receiver->set)
    return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_RECEIVER_UNSET, "pn_receiver_set comes first");
  if (!light->maps.ready) return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "pn_maps_update comes first");
  return PN_OK;
}

static pni_format result_format(pn_format format) {
  return format == PN_FORMAT_R32F ? PNI_R32F : format == PN_FORMAT_R8 ? PNI_R8 : PNI_R16F;
}

pn_result pn_visibility(pn_light *light, pn_receiver *receiver) {
  if (!light) return PN_ERROR_ARGUMENT;
  pn_result result = check_pair(light, receiver);
  if (result != PN_OK) return result;
  pni_pair *pair = pni_pair_get(&light->object, &receiver->object);
  if (!pair) return PN_ERROR_OUT_OF_MEMORY;
  destination to = {.format = result_format(receiver->desc.format)};
  pni_enter(light->object.context);
  result = pni_gpu_check_lost(pni_light_gpu(light));
  if (result == PN_OK) result = timed_visibility(light, receiver, pair, &to);
  if (result == PN_OK) pair->drawn = true;
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
  pni_texture_describe(&pair->image, out);
  return PN_OK;
}

pn_result pn_soft_shadow_map_image(pn_light *light, pn_receiver *receiver, pn_soft_shadow_map *out) {
  if (!light) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = pni_light_gpu(light);
  if (!receiver || !out)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT,
                    "pn_soft_shadow_map_image: receiver or out is NULL");
  pni_pair *pair = pni_pair_find(&light->object, &receiver->object);
  bool some = pair && pair->asked && pair->kept.state && light->technique->soft_shadow_map &&
              pair->kept.kind == &light->technique->pair_kind &&
              light->technique->soft_shadow_map(pair->kept.state, out);
  if (!some)
    return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "the pair's last result has no soft shadow map");
  return PN_OK;
}

/* ---- into the host's texture ------------------------------------------------------------------------------------- */

/* What is read while visibility is drawn must not be drawn into. */
static const char *read_as(pn_light *light, pn_receiver *receiver, pn_gl texture) {
  const pn_receiver_desc *view = &receiver->desc;
  pn_image image;
  if (texture == view->depth_texture) return "the receiver's depth";
  if (texture == view->normal_texture) return "the receiver's normals";
  if (texture == view->mask_texture) return "the receiver's mask";
  for (int i = 0; pn_debug_image(light, receiver, i, NULL, &image); i++)
    if (image.texture == texture) return "the library's own";
  return NULL;
}

static pn_result fail_target(pni_gpu *gpu, pn_gl texture, const char *what) {
  return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RESULT_TARGET, "target texture %u %s", texture, what);
}

static pn_result host_target(pn_light *light, pn_receiver *receiver, const pn_target *target, pni_target *out) {
  pni_gpu *gpu = pni_light_gpu(light);
  const pn_receiver_desc *view = &receiver->desc;
  pni_target_kind kind;
  if (!target->texture || !pni_texture_exists(gpu, target->texture))
    return fail_target(gpu, target->texture, "does not exist");
  const char *read = read_as(light, receiver, target->texture);
  if (read)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RESULT_TARGET, "target texture %u is %s", target->texture, read);
  if (!pni_inspect_target(gpu, target->texture, &kind))
    return fail_target(gpu, target->texture, "is no 2D texture or 2D array that can be drawn into");
  if (!kind.channels) return fail_target(gpu, target->texture, "has no colours, or integers");
  if (kind.width < view->width || kind.height < view->height)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RESULT_TARGET,
                    "target texture %u has %d x %d texels, the view %d x %d", target->texture, kind.width, kind.height,
                    view->width, view->height);
  if (target->layer < 0 || target->layer >= kind.layers)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RESULT_TARGET, "target texture %u has no layer %d: layers 0..%d",
                    target->texture, target->layer, kind.layers - 1);
  if (target->channels & ~kind.channels)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RESULT_TARGET,
                    "target texture %u has the channels 0x%x, not all of 0x%x", target->texture,
                    (unsigned)kind.channels, (unsigned)target->channels);
  *out = (pni_target){{target->texture, kind.array, 0, target->layer}, target->channels};
  return PN_OK;
}

pn_result pn_visibility_into(pn_light *light, pn_receiver *receiver, const pn_target *into) {
  if (!light) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = pni_light_gpu(light);
  if (!into)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_visibility_into: the target is NULL");
  pn_result result = check_pair(light, receiver);
  if (result != PN_OK) return result;
  pni_pair *pair = pni_pair_get(&light->object, &receiver->object);
  if (!pair) return PN_ERROR_OUT_OF_MEMORY;
  destination to = {0};
  pni_enter(light->object.context);
  result = pni_gpu_check_lost(gpu);
  if (result == PN_OK) result = host_target(light, receiver, into, &to.host);
  if (result == PN_OK) result = timed_visibility(light, receiver, pair, &to);
  return pni_leave(light->object.context, result);
}

/* ---- looking inside ---------------------------------------------------------------------------------------------- */

typedef struct {
  int left; /* images to pass over */
  const char **name;
  pn_image *out;
} image_search;

/* Whether that is the image which is looked for. */
static bool take_image(image_search *s, const pni_texture *texture, const char *name) {
  if (!texture->id || s->left-- > 0) return false;
  if (s->name) *s->name = name;
  pni_texture_describe(texture, s->out);
  return true;
}

static bool take_kept(image_search *s, const pni_kept *kept) {
  const char *name = NULL;
  const pni_texture *texture;
  for (int i = 0; (texture = pni_kept_image(kept, i, &name)); i++)
    if (take_image(s, texture, name)) return true;
  return false;
}

int pn_debug_image(pn_light *light, pn_receiver *receiver, int index, const char **name, pn_image *out) {
  if (!light || !out || index < 0) return 0;
  const pni_pair *pair = receiver ? pni_pair_find(&light->object, &receiver->object) : NULL;
  image_search s = {index, name, out};
  if (take_image(&s, &light->maps.depth, "depth") || take_image(&s, &light->maps.range, "range")) return 1;
  if (take_kept(&s, &light->kept)) return 1;
  if (!pair) return 0;
  return take_image(&s, &pair->low, "low") || take_image(&s, &pair->search, "search") ||
         take_image(&s, &pair->levels, "levels") || take_kept(&s, &pair->kept) ||
         take_image(&s, &pair->image, "visibility");
}

static int add_times(pni_gpu *gpu, pni_clock *clock, bool wait, pn_time *out, int capacity, int count) {
  pni_clock_read(gpu, clock, wait);
  for (int i = 0; i < clock->count; i++) {
    int at = 0;
    while (at < count && at < capacity && strcmp(out[at].stage, clock->times[i].stage)) at++;
    if (at < count && at < capacity) {
      out[at].milliseconds += clock->times[i].milliseconds;
      continue;
    }
    if (count < capacity) out[count] = clock->times[i];
    count++;
  }
  return count;
}

int pn_times(pn_light *light, pn_time *out, int capacity, int wait) {
  if (!light || capacity < 0 || (capacity > 0 && !out)) return 0;
  pni_gpu *gpu = pni_light_gpu(light);
  int count = add_times(gpu, &light->clock, wait != 0, out, capacity, 0);
  for (pni_object *o = light->object.context->objects; o; o = o->next) {
    pni_pair *pair = pni_pair_of(o, &light->object);
    if (pair) count = add_times(gpu, &pair->clock, wait != 0, out, capacity, count);
  }
  return count;
}
