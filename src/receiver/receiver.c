#include "receiver/receiver.h"

#include <math.h>

#include "gl/host.h"
#include "gl/inspect.h"
#include "gl/plan.h"

static pni_gpu *gpu_of(const pn_receiver *receiver) { return &receiver->object.context->gpu; }

/* ---- the object -------------------------------------------------------------------------------------------------- */

static void release_receiver(pni_object *object, bool abandon) {
  pn_receiver *receiver = (pn_receiver *)object;
  pni_gpu *gpu = gpu_of(receiver);
  for (int i = 0; i < 4; i++) pni_texture_free(gpu, &receiver->bounds[i], abandon);
  pni_texture_free(gpu, &receiver->slopes, abandon);
  pni_texture_free(gpu, &receiver->below, abandon);
  pni_texture_free(gpu, &receiver->planes, abandon);
  pni_texture_free(gpu, &receiver->copy, abandon);
}

pn_result pn_receiver_create(pn_context *context, pn_receiver **out) {
  if (!context) return PN_ERROR_ARGUMENT;
  if (!out)
    return pni_fail(&context->gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_receiver_create: out is NULL");
  *out = pni_object_create(context, release_receiver, sizeof **out);
  return *out ? PN_OK : PN_ERROR_OUT_OF_MEMORY;
}

void pn_receiver_destroy(pn_receiver **receiver) {
  if (!receiver || !*receiver) return;
  pni_object_destroy(&(*receiver)->object);
  *receiver = NULL;
}

/* ---- what the source is ------------------------------------------------------------------------------------------ */

static pn_result inspect(pni_gpu *gpu, const pn_receiver_desc *d, pni_depth_source *source) {
  pn_gl texture = d->depth_texture, framebuffer = d->depth_framebuffer;
  if (texture && !pni_texture_exists(gpu, texture))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_SOURCE, "there is no texture %u", texture);
  if (texture)
    return pni_inspect_depth(gpu, texture, source)
               ? PN_OK
               : pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_DEPTH,
                          "depth texture %u is no 2D or 2D multisample texture with depth, or has no level 0", texture);
  if (framebuffer && !pni_framebuffer_exists(gpu, framebuffer))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_SOURCE, "there is no framebuffer %u", framebuffer);
  if (pni_inspect_framebuffer(gpu, framebuffer, source)) return PN_OK;
  return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_DEPTH, "framebuffer %u is incomplete or has no depth",
                  framebuffer);
}

/* ---- checks ------------------------------------------------------------------------------------------------------ */

static pn_result check_values(pni_gpu *gpu, const pn_receiver_desc *d) {
  if ((d->depth_texture != 0) == (d->use_framebuffer != 0))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_SOURCE,
                    "%s of depth_texture and use_framebuffer is set", d->depth_texture ? "each" : "none");
  bool view = pni_floats_finite(d->view, 16);
  if (!view || !pni_floats_finite(d->projection, 16))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_MATRIX, "%s is not finite",
                    view ? "projection" : "view");
  const float *range = d->depth_range;
  bool none = range[0] == 0 && range[1] == 0;
  if (!none && !(range[0] >= 0 && range[0] <= 1 && range[1] >= 0 && range[1] <= 1 && range[0] != range[1]))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_RANGE,
                    "depth range %g, %g: two different numbers in [0, 1]", range[0], range[1]);
  if (!isfinite(d->position_error) || d->position_error < 0)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_POSITION, "position_error %g is negative or not finite",
                    d->position_error);
  if (d->scale != 0 && d->scale != 1 && d->scale != 2 && d->scale != 4)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_SCALE, "scale %d is not 1, 2 or 4", d->scale);
  if ((int)d->format < PN_FORMAT_R16F || d->format > PN_FORMAT_R8)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_FORMAT, "result format %d is unknown", (int)d->format);
  if (d->normal_texture && ((int)d->normal_encoding < 0 || d->normal_encoding > PN_NORMAL_OCTAHEDRON_UNSIGNED))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_NORMAL, "normal encoding %d is unknown",
                    (int)d->normal_encoding);
  if (d->x < 0 || d->y < 0 || d->width < 0 || d->height < 0 || (d->width == 0) != (d->height == 0) ||
      (d->use_framebuffer && d->width == 0))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_VIEW, "view %d x %d at %d, %d is not a rectangle",
                    d->width, d->height, d->x, d->y);
  return PN_OK;
}

static pn_result check_view(pni_gpu *gpu, pn_receiver_desc *d, const pni_depth_source *source) {
  int width = source->width, height = source->height;
  if (d->depth_texture) pni_inspect_size(gpu, d->depth_texture, source->samples > 0, &width, &height);
  if (d->width == 0) {
    d->width = width - d->x;
    d->height = height - d->y;
  }
  if (d->width < 1 || d->height < 1 || d->width > width - d->x || d->height > height - d->y)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_VIEW, "view %d x %d at %d, %d reaches outside %d x %d",
                    d->width, d->height, d->x, d->y, width, height);
  return PN_OK;
}

/* Companion textures have the depth texture's layout, or the view's when depth comes from a framebuffer. */
static pn_result check_companion(pni_gpu *gpu, const pn_receiver_desc *d, pn_gl texture, pn_message message,
                                 const char *name) {
  if (!texture) return PN_OK;
  int width = 0, height = 0;
  if (!pni_texture_exists(gpu, texture))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, message, "there is no %s texture %u", name, texture);
  if (!pni_texture_is_2d(gpu, texture))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, message, "%s texture %u is no 2D texture", name, texture);
  pni_inspect_size(gpu, texture, false, &width, &height);
  int x = d->depth_texture ? d->x : 0, y = d->depth_texture ? d->y : 0;
  if (width >= x + d->width && height >= y + d->height) return PN_OK;
  return pni_fail(gpu, PN_ERROR_ARGUMENT, message, "%s texture %u has %d x %d texels, the view needs %d x %d", name,
                  texture, width, height, x + d->width, y + d->height);
}

/* Normals are colours. Half a step of a normalised integer on three axes; an octahedral map stretches it by at most
 * another factor. */
static pn_result check_normals(pni_gpu *gpu, const pn_receiver_desc *d, float *error) {
  *error = 0;
  if (!d->normal_texture) return PN_OK;
  bool octahedron = d->normal_encoding >= PN_NORMAL_OCTAHEDRON;
  pni_color_source color = pni_inspect_color(gpu, d->normal_texture);
  if (color.channels < (octahedron ? 2 : 3))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_NORMAL,
                    "the normal texture has %d channels that are no integers, its encoding takes %d", color.channels,
                    octahedron ? 2 : 3);
  float step = (float)(2.0 / (ldexp(1, color.bits) - 1));
  if (color.is_float) *error = color.bits >= 32 ? 1e-6f : color.bits >= 16 ? 1e-3f : 1.6e-2f;
  else *error = step * (octahedron ? 1.5f : 0.87f);
  return PN_OK;
}

static pn_result check_mask(pni_gpu *gpu, const pn_receiver_desc *d) {
  if (!d->mask_texture || pni_inspect_color(gpu, d->mask_texture).channels > 0) return PN_OK;
  return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_MASK,
                  "the mask texture has no red, or integers, which no sampler of it reads");
}

/* ---- matrices ---------------------------------------------------------------------------------------------------- */

/* NDC depth of a stored one is scale times it plus offset. */
static void depth_to_clip(const pn_receiver_desc *d, double *scale, double *offset) {
  bool whole = d->depth_range[0] == 0 && d->depth_range[1] == 0;
  double near = d->depth_range[0], far = whole ? 1 : d->depth_range[1];
  double depth = d->depth_zero_to_one ? 1 : 2;
  *scale = depth / (far - near);
  *offset = 1 - depth - near * *scale;
}

static bool invert_view(const pn_receiver_desc *d, const float at[2], pni_matrix *scene_from_clip,
                        pni_matrix *scene_from_pixel) {
  pni_matrix view = pni_matrix_from_floats(d->view), projection = pni_matrix_from_floats(d->projection);
  pni_matrix clip_from_scene = pni_matrix_multiply(&projection, &view);
  if (!pni_matrix_invert(&clip_from_scene, scene_from_clip)) return false;
  double scale, offset;
  depth_to_clip(d, &scale, &offset);
  double x = 2 * (at[0] - 0.5) / d->width - 1, y = 2 * (at[1] - 0.5) / d->height - 1;
  pni_matrix clip_from_pixel = {{2.0 / d->width, 0, 0, 0, 0, 2.0 / d->height, 0, 0, 0, 0, scale, 0, x, y, offset, 1}};
  *scene_from_pixel = pni_matrix_multiply(scene_from_clip, &clip_from_pixel);
  return true;
}

/* Where stored depths are dense depends on the format, which may cut off instead of rounding; on top of that,
 * interpolation in float is off by two units of a depth near 1. */
static void find_depth_error(const pni_depth_source *kind, bool reversed, float out[2]) {
  double steps = kind->is_float ? 24 : kind->depth_bits > 24 ? 24 : kind->depth_bits;
  out[0] = (float)((kind->is_float ? 0 : ldexp(1, -(int)steps)) + 2 * 0x1p-24);
  out[1] = 0;
  if (kind->is_float && reversed) { /* floats are dense at 0, where reversed depth keeps its far distances */
    out[0] = 1e-30f;
    out[1] = 0x1p-21f;
  }
}

/* ---- the host's textures ----------------------------------------------------------------------------------------- */

/* In pixels of its textures, where the view ends. */
static void view_end(const pn_receiver_desc *d, int *width, int *height) {
  *width = (d->depth_texture ? d->x : 0) + d->width;
  *height = (d->depth_texture ? d->y : 0) + d->height;
}

pn_result pni_receiver_open(pn_receiver *receiver) {
  static const char *const names[3] = {"depth", "normal", "mask"};
  const pn_receiver_desc *d = &receiver->desc;
  const pn_gl textures[3] = {receiver->copied ? 0 : d->depth_texture, d->normal_texture, d->mask_texture};
  int width, height;
  view_end(d, &width, &height);
  for (int i = 0; i < 3; i++) {
    pni_host_texture *held = &receiver->held[i];
    if (!textures[i]) continue;
    bool there = pni_host_texture_open(gpu_of(receiver), textures[i], false, held);
    if (there && held->width >= width && held->height >= height && (i > 0 || held->depth_bits > 0)) continue;
    pni_receiver_close(receiver);
    return pni_fail(gpu_of(receiver), PN_ERROR_NOT_READY, PN_MESSAGE_RECEIVER_SOURCE,
                    "the %s texture %u is gone, or no longer what pn_receiver_set saw: it must come first", names[i],
                    textures[i]);
  }
  return PN_OK;
}

void pni_receiver_close(pn_receiver *receiver) {
  for (int i = 3; i-- > 0;) pni_host_texture_close(gpu_of(receiver), &receiver->held[i]);
}

/* ---- set --------------------------------------------------------------------------------------------------------- */

static pn_result copy_framebuffer(pn_receiver *receiver, const pn_receiver_desc *d, const pni_depth_source *source) {
  pni_gpu *gpu = gpu_of(receiver);
  pn_result result =
      pni_texture_shape(gpu, &receiver->copy, "receiver depth", pni_depth_format(source), d->width, d->height, 0, 1);
  return result == PN_OK ? pni_copy_depth(gpu, d->depth_framebuffer, d->x, d->y, &receiver->copy) : result;
}

static pn_result copy_multisample(pn_receiver *receiver, const pn_receiver_desc *d) {
  pni_gpu *gpu = gpu_of(receiver);
  pn_result result = pni_texture_shape(gpu, &receiver->copy, "receiver depth", PNI_DEPTH32F, d->width, d->height, 0, 1);
  if (result != PN_OK) return result;
  pni_pass pass = {.name = "sample 0 of depth",
                   .program = {.fragment = "receiver/copy.frag.glsl"},
                   .depth = pni_image_of(&receiver->copy, 0, 0),
                   .width = d->width,
                   .height = d->height,
                   .depth_use = PNI_DEPTH_WRITE};
  result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK || gpu->plan.on) return result;
  /* Multisample textures have no sampling parameters, and no sampler object applies to them. */
  pni_set_host_texture(gpu, "pn_samples", d->depth_texture, PNI_SAMPLE_OWN);
  pni_set_ints(gpu, "pn_view", d->x, d->y, d->width, d->height);
  pni_draw_screen(gpu);
  return PN_OK;
}

static pn_result copy_depth(pn_receiver *receiver, const pn_receiver_desc *d, const pni_depth_source *source) {
  return d->use_framebuffer ? copy_framebuffer(receiver, d, source) : copy_multisample(receiver, d);
}

/* Whether depth was drawn with the range that is set now nobody can tell. */
static void tell_range(pn_receiver *receiver, const pn_receiver_desc *d) {
  pni_gpu *gpu = gpu_of(receiver);
  const pni_host_state *host = gpu->host;
  if (!host || receiver->told_range || d->depth_range[0] != 0 || d->depth_range[1] != 0) return;
  if (host->depth_range[0] == 0 && host->depth_range[1] == 1) return;
  receiver->told_range = true;
  pni_note(gpu, PN_LOG_WARNING, PN_MESSAGE_RECEIVER_RANGE,
           "glDepthRange is %g, %g: if depth was drawn so, the description's depth_range has to say it",
           host->depth_range[0], host->depth_range[1]);
}

static pn_result set_receiver(pn_receiver *receiver, pn_receiver_desc d) {
  pni_gpu *gpu = gpu_of(receiver);
  pni_depth_source source = {0};
  float normal_error = 0;
  pni_matrix scene_from_clip, scene_from_pixel;
  tell_range(receiver, &d);
  pn_result result = inspect(gpu, &d, &source);
  if (result == PN_OK) result = check_view(gpu, &d, &source);
  if (result == PN_OK) result = check_companion(gpu, &d, d.normal_texture, PN_MESSAGE_RECEIVER_NORMAL, "normal");
  if (result == PN_OK) result = check_companion(gpu, &d, d.mask_texture, PN_MESSAGE_RECEIVER_MASK, "mask");
  if (result == PN_OK) result = check_normals(gpu, &d, &normal_error);
  if (result == PN_OK) result = check_mask(gpu, &d);
  if (result == PN_OK && !invert_view(&d, source.at, &scene_from_clip, &scene_from_pixel))
    result = pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_MATRIX, "projection times view has no inverse");
  if (result != PN_OK) return result;
  bool copied = d.use_framebuffer || source.samples > 0;
  if (copied) {
    pni_plan_begin(gpu, receiver->set);
    result = pni_plan_end(gpu, copy_depth(receiver, &d, &source));
    pni_host_texture samples = {0};
    if (result == PN_OK && d.depth_texture) pni_host_texture_open(gpu, d.depth_texture, true, &samples);
    if (result == PN_OK) result = copy_depth(receiver, &d, &source);
    pni_host_texture_close(gpu, &samples);
  }
  if (result != PN_OK) return result;
  receiver->copied = copied;
  receiver->desc = d;
  receiver->scene_from_clip = scene_from_clip;
  receiver->scene_from_pixel = scene_from_pixel;
  find_depth_error(&source, d.reversed_depth != 0, receiver->depth_error);
  receiver->normal_error = normal_error;
  pni_matrix view = pni_matrix_from_floats(d.view);
  receiver->view_rounding = pni_view_rounding(&view);
  receiver->has_planes = false;
  receiver->set = true;
  return PN_OK;
}

pn_result pn_receiver_set(pn_receiver *receiver, const pn_receiver_desc *desc) {
  if (!receiver) return PN_ERROR_ARGUMENT;
  if (!desc)
    return pni_fail(gpu_of(receiver), PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_receiver_set: desc is NULL");
  pn_result result = check_values(gpu_of(receiver), desc);
  if (result != PN_OK) return result;
  pn_receiver_desc d = *desc;
  if (d.scale == 0) d.scale = 1;
  pni_enter(receiver->object.context);
  result = set_receiver(receiver, d);
  return pni_leave(receiver->object.context, result);
}
