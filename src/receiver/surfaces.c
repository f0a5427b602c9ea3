/* The view as passes read it: depth, what is made of it once a frame, matrices. */
#include <math.h>
#include <stdio.h>

#include "receiver/receiver.h"

static pni_gpu *gpu_of(const pn_receiver *receiver) { return &receiver->object.context->gpu; }

/* ---- depth ------------------------------------------------------------------------------------------------------- */

float pni_receiver_background(const pn_receiver *receiver) { return receiver->desc.reversed_depth ? 0 : 1; }

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

static void set_textures(pn_receiver *receiver) {
  pni_gpu *gpu = gpu_of(receiver);
  const pn_receiver_desc *d = &receiver->desc;
  if (receiver->copied) pni_set_texture(gpu, "pn_depth", &receiver->copy);
  else pni_set_host_texture(gpu, "pn_depth", d->depth_texture, PNI_SAMPLE_NEAREST);
  if (d->normal_texture) pni_set_host_texture(gpu, "pn_normal", d->normal_texture, PNI_SAMPLE_NEAREST);
  if (receiver->has_planes) pni_set_texture(gpu, "pn_planes", &receiver->planes);
  if (d->mask_texture) pni_set_host_texture(gpu, "pn_mask", d->mask_texture, PNI_SAMPLE_NEAREST);
}

/* What receiver/depth.glsl reads. */
static void set_depth(pn_receiver *receiver, int scale) {
  pni_gpu *gpu = gpu_of(receiver);
  const pn_receiver_desc *d = &receiver->desc;
  const float quantum[4] = {receiver->depth_error[0], receiver->depth_error[1], pni_receiver_background(receiver),
                            receiver->normal_error};
  int x = receiver->copied ? 0 : d->x, y = receiver->copied ? 0 : d->y;
  pni_set_ints(gpu, "pn_view", x, y, d->width, d->height);
  pni_set_ints(gpu, "pn_offset", d->depth_texture ? d->x : 0, d->depth_texture ? d->y : 0, scale, scale / 2);
  pni_set_floats(gpu, "pn_quantum", quantum);
  set_textures(receiver);
}

/* ---- planes ------------------------------------------------------------------------------------------------------ */

pn_result pni_receiver_surfaces(pn_receiver *receiver) {
  pni_gpu *gpu = gpu_of(receiver);
  const pn_receiver_desc *d = &receiver->desc;
  if (d->normal_texture || receiver->has_planes) return PN_OK;
  pn_result result =
      pni_texture_shape(gpu, &receiver->planes, "receiver planes", PNI_RGBA32F, d->width, d->height, 0, 1);
  if (result != PN_OK) return result;
  pni_pass pass = {.name = "receiver planes",
                   .program = {.fragment = "receiver/planes.frag.glsl"},
                   .color = {pni_image_of(&receiver->planes, 0, 0)},
                   .width = d->width,
                   .height = d->height};
  result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK || gpu->plan.on) return result;
  set_depth(receiver, 1);
  pni_draw_screen(gpu);
  receiver->has_planes = true;
  return PN_OK;
}

/* ---- where surfaces are ------------------------------------------------------------------------------------------ */

/* The camera's centre in the light's frame: (0, 0, 1, 0) of clip space, where all rays meet, w = 1; or, for parallel
 * rays, the direction to it, away from the background, w = 0. */
static void find_eye(const pn_receiver *receiver, const pni_matrix *light_from_scene, float eye[4]) {
  const float *range = receiver->desc.depth_range;
  bool flipped = range[0] > range[1];
  double centre[4] = {0, 0, (pni_receiver_background(receiver) > 0.5f) != flipped ? -1 : 1, 0}, h[4];
  pni_matrix light_from_clip = pni_matrix_multiply(light_from_scene, &receiver->scene_from_clip);
  pni_matrix_apply(&light_from_clip, centre, h);
  double size = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
  bool parallel = fabs(h[3]) <= 1e-9 * size;
  for (int i = 0; i < 3; i++) eye[i] = (float)(parallel ? h[i] / size : h[i] / h[3]);
  eye[3] = parallel ? 0.0f : 1.0f;
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

/* How far, in scene units, surfaces and casters may lie apart by what floats lose far from the origin: by axes of the
 * light's frame; and along z per z. */
static void set_rounding(const pn_receiver *receiver, const pni_rounding *rounding) {
  float given = receiver->desc.position_error, lost[4];
  double host = given > 0 ? given : receiver->view_rounding + rounding->host;
  for (int i = 0; i < 3; i++) lost[i] = (float)(host + rounding->map[i]);
  lost[3] = (float)rounding->map_per_z;
  pni_set_floats(gpu_of(receiver), "pn_lost", lost);
}

/* Where the light is, for planes that depth does not tell. */
static void set_shining(const pn_receiver *receiver, const pni_frame *frame, const pni_emission *emission) {
  const float shining[4] = {(float)emission->extent[0], (float)emission->extent[1], 0,
                            frame->projection == PNI_PARALLEL ? 0.0f : 1.0f};
  pni_set_floats(gpu_of(receiver), "pn_shining", shining);
}

void pni_receiver_uniforms(pn_receiver *receiver, const pni_frame *frame, const pni_emission *emission,
                           const pni_rounding *rounding, int scale) {
  pni_gpu *gpu = gpu_of(receiver);
  pni_matrix light_from_scene = pni_light_from_scene(frame), pixel_from_light;
  pni_matrix light_from_pixel = pni_matrix_multiply(&light_from_scene, &receiver->scene_from_pixel);
  if (!pni_matrix_invert(&light_from_pixel, &pixel_from_light)) pixel_from_light = pni_matrix_identity();
  float matrix[16], eye[4], normal[9];
  pni_matrix_to_floats(&light_from_pixel, matrix);
  pni_set_matrix4(gpu, "pn_light_from_pixel", matrix);
  pni_matrix_to_floats(&pixel_from_light, matrix);
  pni_set_matrix4(gpu, "pn_pixel_from_light", matrix);
  light_from_normal(&receiver->desc, &light_from_scene, normal);
  pni_set_matrix3(gpu, "pn_light_from_normal", normal);
  find_eye(receiver, &light_from_scene, eye);
  pni_set_floats(gpu, "pn_eye", eye);
  if (emission) set_shining(receiver, frame, emission);
  set_rounding(receiver, rounding);
  set_depth(receiver, scale);
}
