/* pn_prepare: what a light will need is compiled by drawing it: a scene of two triangles and a small view go through
 * the same calls as the host's frames will, without a ground and with one. */
#include <string.h>

#include "gl/host.h"
#include "light.h"

/* ---- the textures of the view ------------------------------------------------------------------------------------ */

/* Sides of the view. Drivers compile for the state of a texture too, and whether its sides are powers of two is part
 * of that: so they are, or are not, those of the images that the view's bounds are reduced into in steps included (2
 * and 3). */
enum { POWER = 32, NO_POWER = 33 };

typedef struct {
  pn_context *context;
  pn_receiver_desc view;
  pni_texture depth, normal, mask, alpha;
  pn_casters *casters;
  pn_receiver *receiver;
  pn_light *light;
} rehearsal;

static pn_result make_texture(pni_gpu *gpu, pni_texture *t, pni_format format, int size, const void *texels) {
  pn_result result = pni_texture_shape(gpu, t, "rehearsal", format, size, size, 0, 1);
  if (result == PN_OK) pni_texture_write(gpu, t, texels, (size_t)size * (size_t)size);
  return result;
}

static bool power_of_two(int size) { return size > 0 && (size & (size - 1)) == 0; }

static pn_result make_textures(rehearsal *r, const pn_receiver_desc *like) {
  enum { TEXELS = NO_POWER * NO_POWER };
  pni_gpu *gpu = &r->context->gpu;
  float depth[TEXELS], normal[4 * TEXELS];
  uint8_t ones[4 * TEXELS];
  int size = power_of_two(like->width) && power_of_two(like->height) ? POWER : NO_POWER;
  for (int i = 0; i < TEXELS; i++) depth[i] = 0.5f;
  for (int i = 0; i < 4 * TEXELS; i++) normal[i] = i % 4 == 2 ? 1.0f : 0.5f;
  memset(ones, 255, sizeof ones);
  pn_result result = make_texture(gpu, &r->depth, PNI_DEPTH32F, size, depth);
  if (result == PN_OK && like->normal_texture) result = make_texture(gpu, &r->normal, PNI_RGBA32F, size, normal);
  if (result == PN_OK && like->mask_texture) result = make_texture(gpu, &r->mask, PNI_R8, size, ones);
  if (result == PN_OK) result = make_texture(gpu, &r->alpha, PNI_R8, 1, ones);
  return result;
}

/* The identity for both matrices: the camera looks along z at the plane z = 0, and x and y run from -1 to 1. */
static void describe_view(rehearsal *r, const pn_receiver_desc *like) {
  pn_receiver_desc *d = &r->view;
  *d = (pn_receiver_desc){.depth_texture = r->depth.id,
                          .width = r->depth.width,
                          .height = r->depth.height,
                          .normal_texture = r->normal.id,
                          .normal_encoding = like->normal_encoding,
                          .mask_texture = r->mask.id,
                          .scale = like->scale,
                          .format = like->format};
  for (int i = 0; i < 4; i++) d->view[5 * i] = d->projection[5 * i] = 1;
}

/* ---- the scene --------------------------------------------------------------------------------------------------- */

static const float triangle[9] = {-0.2f, -0.1f, -1, 0.2f, -0.2f, -1, 0, 0.3f, -1};
static const float texcoords[6] = {0, 0, 1, 0, 0, 1};
static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/* In the plane that the view shows: a ground, without which no caster is drawn over a floor; and before it something
 * of the same mesh, or its box would tell that it shadows nothing. */
static const float ground[18] = {-0.9f, -0.9f, 0, 0.9f, -0.9f, 0, 0, 0.9f, 0,
                                 -0.2f, -0.1f, -1, 0.2f, -0.2f, -1, 0, 0.3f, -1};

static pn_result add_triangles(rehearsal *r, const float *corners, size_t count, pn_gl alpha) {
  pn_mesh mesh;
  pn_mesh_desc desc = {.positions = {.data = corners, .count = 3 * count}, .alpha_texture = alpha};
  if (alpha) desc.texcoords = (pn_span){.data = texcoords, .count = 3};
  pn_result result = pn_mesh_add(r->casters, &desc, &mesh);
  return result == PN_OK ? pn_instance_add(r->casters, mesh, identity, 0, NULL) : result;
}

static pn_light_desc light_fitted(pn_fit fit) {
  return (pn_light_desc){
      .center = {0, 0, -2}, .direction = {0, 0, 1}, .half_u = 0.5f, .half_v = 0.5f, .fit = fit, .map_width = 8};
}

static pn_result make_scene(rehearsal *r, const pni_technique_class *technique, const double *values) {
  pn_light_desc light = light_fitted(PN_FIT_VISIBLE);
  pn_result result = pn_casters_create(r->context, &r->casters);
  if (result == PN_OK) result = add_triangles(r, triangle, 1, 0);
  if (result == PN_OK) result = add_triangles(r, triangle, 1, r->alpha.id);
  if (result == PN_OK) result = pn_receiver_create(r->context, &r->receiver);
  if (result == PN_OK) result = pn_receiver_set(r->receiver, &r->view);
  if (result == PN_OK) result = pn_light_create(r->context, &r->light);
  if (result == PN_OK) result = pn_light_set(r->light, &light);
  if (result != PN_OK) return result;
  r->light->technique = technique;
  memcpy(r->light->values, values, sizeof r->light->values);
  if (technique->sketch) technique->sketch(r->light->values);
  return PN_OK;
}

static pn_result draw_once(rehearsal *r) {
  pn_result result = pn_maps_update(r->light, r->casters, PN_GROUPS_ALL, &r->receiver, 1);
  return result == PN_OK ? pn_visibility(r->light, r->receiver) : result;
}

/* Some techniques then look at the view themselves. */
static pn_result draw_fitted_to_casters(rehearsal *r) {
  pn_light_desc light = light_fitted(PN_FIT_CASTERS);
  pn_result result = pn_light_set(r->light, &light);
  return result == PN_OK ? draw_once(r) : result;
}

static void end(rehearsal *r) {
  pn_light_destroy(&r->light);
  pn_receiver_destroy(&r->receiver);
  pn_casters_destroy(&r->casters);
  pni_texture *all[] = {&r->depth, &r->normal, &r->mask, &r->alpha};
  pni_enter(r->context);
  for (int i = 0; i < 4; i++) pni_texture_free(&r->context->gpu, all[i], false);
  pni_leave(r->context, PN_OK);
}

static pn_result rehearse(pn_context *context, const pni_technique_class *technique, const double *values,
                          const pn_receiver_desc *like) {
  rehearsal r = {.context = context};
  pni_enter(context);
  pn_result result = pni_leave(context, make_textures(&r, like));
  describe_view(&r, like);
  if (result == PN_OK) result = make_scene(&r, technique, values);
  if (result == PN_OK) result = draw_once(&r);
  if (result == PN_OK) result = add_triangles(&r, ground, 2, 0);
  if (result == PN_OK) result = draw_once(&r);
  if (result == PN_OK) result = draw_fitted_to_casters(&r);
  end(&r);
  return result;
}

/* ---- with the host's wishes put aside ---------------------------------------------------------------------------- */

pn_result pn_prepare(pn_context *context, const char *spec, const pn_receiver_desc *like) {
  if (!context) return PN_ERROR_ARGUMENT;
  static const pn_receiver_desc usual[2] = {{.normal_texture = 1}, {0}};
  pni_gpu *gpu = &context->gpu;
  const pni_technique_class *technique;
  double values[PNI_PARAMETERS_MAX];
  pni_explanation why;
  pn_result result = pni_spec_read(spec ? spec : PN_TECHNIQUE_DEFAULT, &technique, values, &why);
  if (result != PN_OK) return pni_fail(gpu, result, why.message, "%s", why.text);
  bool timing = gpu->timing;
  int debug = gpu->debug;
  gpu->timing = false;
  gpu->debug = 0;
  gpu->only_errors = true; /* what there is to say of two triangles is of no interest */
  for (int i = 0; i < (like ? 1 : 2) && result == PN_OK; i++)
    result = rehearse(context, technique, values, like ? like : &usual[i]);
  gpu->only_errors = false;
  gpu->debug = debug;
  gpu->timing = timing;
  return result;
}
