#include "receiver/receiver.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pair.h"

static pni_gpu *gpu_of(const pn_receiver *receiver) { return &receiver->object.context->gpu; }

/* ---- the object -------------------------------------------------------------------------------------------------- */

static void free_receiver(pni_object *object, bool abandon) {
  pn_receiver *receiver = (pn_receiver *)object;
  pni_gpu *gpu = gpu_of(receiver);
  pni_pairs_drop(&receiver->object, abandon);
  for (int i = 0; i < 4; i++) pni_texture_free(gpu, &receiver->bounds[i], abandon);
  pni_texture_free(gpu, &receiver->copy, abandon);
  pni_object_unlink(&receiver->object);
  pni_free(gpu, receiver);
}

pn_result pn_receiver_create(pn_context *context, pn_receiver **out) {
  if (!context) return PN_ERROR_ARGUMENT;
  if (!out)
    return pni_fail(&context->gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_receiver_create: out is NULL");
  *out = pni_object_create(context, free_receiver, sizeof **out);
  return *out ? PN_OK : PN_ERROR_OUT_OF_MEMORY;
}

void pn_receiver_destroy(pn_receiver **receiver) {
  if (!receiver || !*receiver) return;
  pn_context *context = (*receiver)->object.context;
  pni_enter(context);
  free_receiver(&(*receiver)->object, false);
  pni_leave(context, PN_OK);
  *receiver = NULL;
}

/* ---- what the source is ------------------------------------------------------------------------------------------ */

typedef struct {
  int depth_bits, stencil_bits, samples;
  bool is_float;
  float at[2]; /* where in a pixel its depth was taken */
} source_kind;

static GLint attachment_parameter(pni_gpu *gpu, GLenum target, GLenum point, GLenum name) {
  GLint value = 0;
  GL(gpu, GetFramebufferAttachmentParameteriv)(target, point, name, &value);
  return value;
}

static bool read_kind(pni_gpu *gpu, GLenum target, GLenum point, source_kind *kind) {
  if (attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_NONE) return false;
  kind->depth_bits = attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE);
  kind->stencil_bits = attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE);
  kind->is_float = attachment_parameter(gpu, target, point, GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE) == GL_FLOAT;
  return kind->depth_bits > 0;
}

/* Of the draw framebuffer: sample 0 lies beside the pixel's centre. */
static void read_samples(pni_gpu *gpu, source_kind *kind) {
  kind->at[0] = kind->at[1] = 0.5f;
  GL(gpu, GetIntegerv)(GL_SAMPLES, &kind->samples);
  if (kind->samples > 0) GL(gpu, GetMultisamplefv)(GL_SAMPLE_POSITION, 0, kind->at);
}

/* GL 3.3 cannot ask a texture for its target, and binding it to the wrong one is an error; attaching it to a
 * framebuffer tells what is needed. */
static pn_result inspect_texture(pni_gpu *gpu, pn_gl texture, source_kind *kind) {
  static const char *const wrong = "the depth texture is no 2D or 2D multisample texture with depth";
  if (!GL(gpu, IsTexture)(texture))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_SOURCE, "there is no texture %u", texture);
  GL(gpu, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, gpu->framebuffer);
  for (int i = 0; i < 2; i++)
    GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + (GLenum)i, GL_TEXTURE_2D, 0, 0);
  GLenum none = GL_NONE;
  GL(gpu, DrawBuffers)(1, &none);
  GL(gpu, FramebufferTexture)(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, texture, 0);
  bool sound = GL(gpu, CheckFramebufferStatus)(GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE &&
               read_kind(gpu, GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, kind) &&
               !attachment_parameter(gpu, GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_FRAMEBUFFER_ATTACHMENT_LAYERED);
  if (sound) read_samples(gpu, kind);
  GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
  return sound ? PN_OK : pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_DEPTH, "%s", wrong);
}

static pn_result inspect_framebuffer(pni_gpu *gpu, pn_gl framebuffer, source_kind *kind) {
  if (framebuffer && !GL(gpu, IsFramebuffer)(framebuffer))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_SOURCE, "there is no framebuffer %u", framebuffer);
  GL(gpu, BindFramebuffer)(GL_READ_FRAMEBUFFER, framebuffer);
  GLenum status = GL(gpu, CheckFramebufferStatus)(GL_READ_FRAMEBUFFER);
  GLenum point = framebuffer ? GL_DEPTH_ATTACHMENT : GL_DEPTH;
  if (status != GL_FRAMEBUFFER_COMPLETE || !read_kind(gpu, GL_READ_FRAMEBUFFER, point, kind))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_DEPTH, "framebuffer %u is incomplete or has no depth",
                    framebuffer);
  GL(gpu, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, framebuffer);
  read_samples(gpu, kind);
  return PN_OK;
}

/* The sized format that has these bits: a depth blit wants the same on both sides. */
static GLenum kind_format(const source_kind *kind) {
  if (kind->is_float) return kind->stencil_bits ? GL_DEPTH32F_STENCIL8 : GL_DEPTH_COMPONENT32F;
  if (kind->stencil_bits) return GL_DEPTH24_STENCIL8;
  if (kind->depth_bits == 16) return GL_DEPTH_COMPONENT16;
  return kind->depth_bits == 32 ? GL_DEPTH_COMPONENT32 : GL_DEPTH_COMPONENT24;
}

/* ---- checks ------------------------------------------------------------------------------------------------------ */

static void texture_size(pni_gpu *gpu, GLenum target, pn_gl texture, int *width, int *height) {
  GL(gpu, ActiveTexture)(GL_TEXTURE0 + PNI_UNIT_DEPTH);
  GL(gpu, BindTexture)(target, texture);
  GL(gpu, GetTexLevelParameteriv)(target, 0, GL_TEXTURE_WIDTH, width);
  GL(gpu, GetTexLevelParameteriv)(target, 0, GL_TEXTURE_HEIGHT, height);
  GL(gpu, BindTexture)(target, 0);
}

static pn_result check_values(pni_gpu *gpu, const pn_receiver_desc *d) {
  if ((d->depth_texture != 0) == (d->use_framebuffer != 0))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_SOURCE,
                    "one of depth_texture and use_framebuffer must be set");
  if (!pni_floats_finite(d->view, 16) || !pni_floats_finite(d->projection, 16) || !isfinite(d->background_depth))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_MATRIX,
                    "view, projection or background depth is not finite");
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

static pn_result check_view(pni_gpu *gpu, pn_receiver_desc *d, GLenum target) {
  int limit = gpu->can.texture_size_max, width = limit, height = limit;
  if (d->depth_texture) texture_size(gpu, target, d->depth_texture, &width, &height);
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
  if (GL(gpu, IsTexture)(texture)) texture_size(gpu, GL_TEXTURE_2D, texture, &width, &height);
  int x = d->depth_texture ? d->x : 0, y = d->depth_texture ? d->y : 0;
  if (width >= x + d->width && height >= y + d->height) return PN_OK;
  return pni_fail(gpu, PN_ERROR_ARGUMENT, message, "the %s texture, %d x %d, does not cover the view", name, width,
                  height);
}

/* Normals are colours. */
static pn_result check_normals(pni_gpu *gpu, const pn_receiver_desc *d) {
  if (!d->normal_texture) return PN_OK;
  GLint bits = 0;
  GL(gpu, BindTexture)(GL_TEXTURE_2D, d->normal_texture);
  GL(gpu, GetTexLevelParameteriv)(GL_TEXTURE_2D, 0, GL_TEXTURE_RED_SIZE, &bits);
  GL(gpu, BindTexture)(GL_TEXTURE_2D, 0);
  if (bits > 0) return PN_OK;
  return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_NORMAL, "the normal texture has no colours");
}

/* Angle by which a normal of that texture may be off, radians. */
static float normal_error(pni_gpu *gpu, const pn_receiver_desc *d) {
  GLint bits = 0, type = 0;
  GL(gpu, BindTexture)(GL_TEXTURE_2D, d->normal_texture);
  GL(gpu, GetTexLevelParameteriv)(GL_TEXTURE_2D, 0, GL_TEXTURE_RED_SIZE, &bits);
  GL(gpu, GetTexLevelParameteriv)(GL_TEXTURE_2D, 0, GL_TEXTURE_RED_TYPE, &type);
  GL(gpu, BindTexture)(GL_TEXTURE_2D, 0);
  if (type == GL_FLOAT) return bits >= 32 ? 1e-6f : bits >= 16 ? 1e-3f : 1.6e-2f;
  /* Half a step of a normalised integer on three axes; an octahedral map stretches it by at most another factor. */
  float step = (float)(2.0 / (ldexp(1, bits) - 1));
  return step * (d->normal_encoding >= PN_NORMAL_OCTAHEDRON ? 1.5f : 0.87f);
}

/* ---- matrices ---------------------------------------------------------------------------------------------------- */

static bool invert_view(const pn_receiver_desc *d, const float at[2], pni_matrix *scene_from_clip,
                        pni_matrix *scene_from_pixel) {
  pni_matrix view = pni_matrix_from_floats(d->view), projection = pni_matrix_from_floats(d->projection);
  pni_matrix clip_from_scene = pni_matrix_multiply(&projection, &view);
  if (!pni_matrix_invert(&clip_from_scene, scene_from_clip)) return false;
  double depth = d->depth_zero_to_one ? 1 : 2;
  double x = 2 * (at[0] - 0.5) / d->width - 1, y = 2 * (at[1] - 0.5) / d->height - 1;
  pni_matrix clip_from_pixel = {
      {2.0 / d->width, 0, 0, 0, 0, 2.0 / d->height, 0, 0, 0, 0, depth, 0, x, y, 1 - depth, 1}};
  *scene_from_pixel = pni_matrix_multiply(scene_from_clip, &clip_from_pixel);
  return true;
}

/* Where stored depths are dense depends on the format, which may cut off instead of rounding; on top of that,
 * interpolation in float is off by two units of a depth near 1. */
static void depth_error(const source_kind *kind, bool reversed, float quantum[4]) {
  double steps = kind->is_float ? 24 : kind->depth_bits > 24 ? 24 : kind->depth_bits;
  quantum[0] = (float)((kind->is_float ? 0 : ldexp(1, -(int)steps)) + 2 * 0x1p-24);
  quantum[1] = 0;
  if (kind->is_float && reversed) { /* floats are dense at 0, where reversed depth keeps its far distances */
    quantum[0] = 1e-30f;
    quantum[1] = 0x1p-21f;
  }
}

/* ---- copies ------------------------------------------------------------------------------------------------------ */

static pn_result copy_framebuffer(pn_receiver *receiver, const pn_receiver_desc *d, const source_kind *kind) {
  pni_gpu *gpu = gpu_of(receiver);
  pn_result result = pni_texture_shape(gpu, &receiver->copy, kind_format(kind), d->width, d->height, 0, 1);
  if (result != PN_OK) return result;
  pni_pass pass = {.depth = {receiver->copy.id, GL_TEXTURE_2D, 0, 0},
                   .width = d->width,
                   .height = d->height,
                   .depth_use = PNI_DEPTH_WRITE};
  result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK) return result;
  GL(gpu, BindFramebuffer)(GL_READ_FRAMEBUFFER, d->depth_framebuffer);
  GL(gpu, BlitFramebuffer)
  (d->x, d->y, d->x + d->width, d->y + d->height, 0, 0, d->width, d->height, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  return PN_OK;
}

static pn_result copy_multisample(pn_receiver *receiver, const pn_receiver_desc *d) {
  pni_gpu *gpu = gpu_of(receiver);
  pni_program_key key = {"shaders/screen.vert.glsl", "receiver/copy.frag.glsl", NULL, ""};
  const pni_program *program;
  pn_result result = pni_program_get(gpu, &key, &program);
  if (result == PN_OK)
    result = pni_texture_shape(gpu, &receiver->copy, GL_DEPTH_COMPONENT32F, d->width, d->height, 0, 1);
  if (result != PN_OK) return result;
  pni_pass pass = {.depth = {receiver->copy.id, GL_TEXTURE_2D, 0, 0},
                   .width = d->width,
                   .height = d->height,
                   .depth_use = PNI_DEPTH_WRITE};
  result = pni_screen_begin(gpu, &pass, program);
  if (result != PN_OK) return result;
  /* Multisample textures have no sampling parameters, and no sampler object applies to them. */
  pni_bind_texture(gpu, PNI_UNIT_WORK, GL_TEXTURE_2D_MULTISAMPLE, d->depth_texture, true);
  GLint view[4] = {d->x, d->y, d->width, d->height};
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_view"), 1, view);
  pni_draw_screen(gpu);
  return PN_OK;
}

/* ---- set --------------------------------------------------------------------------------------------------------- */

static pn_result set_receiver(pn_receiver *receiver, pn_receiver_desc d) {
  pni_gpu *gpu = gpu_of(receiver);
  source_kind kind = {0};
  pn_result result = d.depth_texture ? inspect_texture(gpu, d.depth_texture, &kind)
                                     : inspect_framebuffer(gpu, d.depth_framebuffer, &kind);
  GLenum target = kind.samples > 0 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D;
  if (result == PN_OK) result = check_view(gpu, &d, target);
  if (result == PN_OK) result = check_companion(gpu, &d, d.normal_texture, PN_MESSAGE_RECEIVER_NORMAL, "normal");
  if (result == PN_OK) result = check_companion(gpu, &d, d.mask_texture, PN_MESSAGE_RECEIVER_MASK, "mask");
  if (result == PN_OK) result = check_normals(gpu, &d);
  pni_matrix scene_from_clip, scene_from_pixel;
  if (result == PN_OK && !invert_view(&d, kind.at, &scene_from_clip, &scene_from_pixel))
    result = pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_RECEIVER_MATRIX, "projection times view has no inverse");
  if (result != PN_OK) return result;
  bool multisample = d.depth_texture && kind.samples > 0;
  if (d.use_framebuffer) result = copy_framebuffer(receiver, &d, &kind);
  if (multisample) result = copy_multisample(receiver, &d);
  if (result != PN_OK) return result;
  receiver->copied = d.use_framebuffer || multisample;
  receiver->desc = d;
  receiver->scene_from_clip = scene_from_clip;
  receiver->scene_from_pixel = scene_from_pixel;
  depth_error(&kind, d.background_depth < 0.5f, receiver->quantum);
  receiver->quantum[2] = d.background_depth;
  receiver->quantum[3] = d.normal_texture ? normal_error(gpu, &d) : 0;
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

/* ---- for the passes that read it --------------------------------------------------------------------------------- */

void pni_receiver_low_size(const pn_receiver *receiver, int *width, int *height) {
  int scale = receiver->desc.scale;
  *width = (receiver->desc.width + scale - 1) / scale;
  *height = (receiver->desc.height + scale - 1) / scale;
}

void pni_receiver_defines(const pn_receiver *receiver, char out[PNI_RECEIVER_DEFINES]) {
  const pn_receiver_desc *d = &receiver->desc;
  snprintf(out, PNI_RECEIVER_DEFINES, "PN_NORMALS %d\nPN_MASK %d\n",
           d->normal_texture ? (int)d->normal_encoding + 1 : 0, d->mask_texture != 0);
}

/* The camera's centre in the light's frame: (0, 0, 1, 0) of clip space, where all rays meet, w = 1; or, for parallel
 * rays, the direction to it, away from the background, w = 0. */
static void find_eye(const pn_receiver *receiver, const pni_matrix *light_from_scene, float eye[4]) {
  double centre[4] = {0, 0, receiver->desc.background_depth > 0.5f ? -1 : 1, 0}, h[4];
  pni_matrix light_from_clip = pni_matrix_multiply(light_from_scene, &receiver->scene_from_clip);
  pni_matrix_apply(&light_from_clip, centre, h);
  double size = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
  bool parallel = fabs(h[3]) <= 1e-9 * size;
  for (int i = 0; i < 3; i++) eye[i] = (float)(parallel ? h[i] / size : h[i] / h[3]);
  eye[3] = parallel ? 0.0f : 1.0f;
}

static void bind_textures(pn_receiver *receiver) {
  pni_gpu *gpu = gpu_of(receiver);
  const pn_receiver_desc *d = &receiver->desc;
  pni_bind_texture(gpu, PNI_UNIT_DEPTH, GL_TEXTURE_2D, receiver->copied ? receiver->copy.id : d->depth_texture, false);
  if (d->normal_texture) pni_bind_texture(gpu, PNI_UNIT_NORMAL, GL_TEXTURE_2D, d->normal_texture, false);
  if (d->mask_texture) pni_bind_texture(gpu, PNI_UNIT_MASK, GL_TEXTURE_2D, d->mask_texture, false);
}

/* Normals are vectors: the transpose of the inverse, which for a view (rotation, perhaps mirrored, uniformly scaled)
 * is the inverse up to scale. */
static void light_from_normal(const pn_receiver_desc *d, const pni_matrix *light_from_scene, float out[9]) {
  pni_matrix m = *light_from_scene;
  if (d->normal_in_view) {
    pni_matrix view = pni_matrix_from_floats(d->view), transposed = pni_matrix_identity();
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++) transposed.m[4 * c + r] = view.m[4 * r + c];
    m = pni_matrix_multiply(light_from_scene, &transposed);
  }
  for (int c = 0; c < 3; c++)
    for (int r = 0; r < 3; r++) out[3 * c + r] = (float)m.m[4 * c + r];
}

void pni_receiver_bind(pn_receiver *receiver, const pni_program *program, const pni_frame *frame, int scale) {
  pni_gpu *gpu = gpu_of(receiver);
  const pn_receiver_desc *d = &receiver->desc;
  pni_matrix light_from_scene = pni_light_from_scene(frame), pixel_from_light;
  pni_matrix light_from_pixel = pni_matrix_multiply(&light_from_scene, &receiver->scene_from_pixel);
  if (!pni_matrix_invert(&light_from_pixel, &pixel_from_light)) pixel_from_light = pni_matrix_identity();
  float matrix[16], eye[4], normal[9];
  pni_matrix_to_floats(&light_from_pixel, matrix);
  GL(gpu, UniformMatrix4fv)(pni_uniform(program, "pn_light_from_pixel"), 1, GL_FALSE, matrix);
  pni_matrix_to_floats(&pixel_from_light, matrix);
  GL(gpu, UniformMatrix4fv)(pni_uniform(program, "pn_pixel_from_light"), 1, GL_FALSE, matrix);
  light_from_normal(d, &light_from_scene, normal);
  GL(gpu, UniformMatrix3fv)(pni_uniform(program, "pn_light_from_normal"), 1, GL_FALSE, normal);
  find_eye(receiver, &light_from_scene, eye);
  GL(gpu, Uniform4fv)(pni_uniform(program, "pn_eye"), 1, eye);
  GLint view[4] = {receiver->copied ? 0 : d->x, receiver->copied ? 0 : d->y, d->width, d->height};
  GLint offset[4] = {d->depth_texture ? d->x : 0, d->depth_texture ? d->y : 0, scale, scale / 2};
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_view"), 1, view);
  GL(gpu, Uniform4iv)(pni_uniform(program, "pn_offset"), 1, offset);
  GL(gpu, Uniform4fv)(pni_uniform(program, "pn_quantum"), 1, receiver->quantum);
  bind_textures(receiver);
}
