/* pn_maps_update: what casts, fitted and drawn. */
#include <math.h>
#include <string.h>

#include "gl/device.h"
#include "gl/host.h"
#include "gl/plan.h"
#include "light.h"
#include "maps/maps.h"
#include "maps/origin.h"
#include "maps/range.h"
#include "maps/trim.h"

/* Where A_n = A_u |n_u| + A_v |n_v| is laid off along n, it comes to |n_i| A_n along an axis: with an angle a between
 * the two, A_i cos^2 a + A_j sin a cos a, (A_i + |A|) / 2 at most. */
static pni_emission reaching(const pni_emission *e, const pni_maps_want *want) {
  pni_emission out = *e;
  double diagonal = hypot(e->extent[0], e->extent[1]);
  for (int i = 0; i < 2 && want->reach_turned; i++) out.extent[i] = 0.5 * (e->extent[i] + diagonal);
  return out;
}

/* What PN_FIT_FRUSTUM looks at; for PN_FIT_VISIBLE too it comes first, because it costs nothing and may settle the
 * matter. */
static pn_result find_frusta(pn_light *light, pn_receiver *const *receivers, int count) {
  bool wanted = light->desc.fit == PN_FIT_VISIBLE || light->desc.fit == PN_FIT_FRUSTUM;
  light->has_visible = wanted && count > 0;
  light->visible = pni_region_empty();
  for (int i = 0; i < count && light->has_visible; i++) {
    if (!receivers[i]->set)
      return pni_fail(pni_light_gpu(light), PN_ERROR_NOT_READY, PN_MESSAGE_RECEIVER_UNSET,
                      "visible receiver %d was never set", i);
    pni_receiver_frustum(receivers[i], &light->frame, &light->visible);
  }
  return PN_OK;
}

/* What PN_FIT_VISIBLE looks at: the surfaces themselves. */
typedef struct {
  pni_patch_list patches;
  pni_grid *grid;
} surfaces;

static pn_result find_surfaces(pn_light *light, pn_receiver *const *receivers, int count, surfaces *seen) {
  pni_gpu *gpu = pni_light_gpu(light);
  pn_result result = PN_OK;
  for (int i = 0; i < count && result == PN_OK; i++) {
    result = pni_receiver_open(receivers[i]);
    if (result != PN_OK) break;
    result = pni_receiver_patches(receivers[i], &light->frame, &light->reaching, &seen->patches);
    pni_receiver_close(receivers[i]);
  }
  if (result == PN_OK) result = pni_grid_make(gpu, &seen->patches, light->reaching.extent, &seen->grid);
  if (result == PN_OK) light->visible = seen->grid->region;
  return result;
}

static pni_fit_request fit_request(const pn_light *light, const pni_maps_want *want, const surfaces *seen,
                                   const pni_fit_kept *kept) {
  const pn_light_desc *d = &light->desc;
  return (pni_fit_request){.frame = &light->frame,
                           .emission = &light->reaching,
                           .near_distance = d->near_distance,
                           .range = d->range,
                           .width = d->map_width,
                           .height = d->map_height,
                           .given = d->fit == PN_FIT_GIVEN ? d->fit_bounds : NULL,
                           .visible = light->has_visible ? &light->visible : NULL,
                           .grid = seen ? seen->grid : NULL,
                           .kept = kept,
                           .reach = want->reach,
                           .reach_width = want->reach_width,
                           .receivers = want->receivers};
}

static void fit_light(pn_light *light, const pn_casters *casters, const pni_maps_want *want, const surfaces *seen,
                      const pni_fit_kept *kept) {
  pni_fit_request request = fit_request(light, want, seen, kept);
  pni_fit_maps(casters, light->groups, &request, &light->maps.fit);
  if (!light->maps.fit.clamped || light->warned_angle) return;
  light->warned_angle = true;
  pni_note(pni_light_gpu(light), PN_LOG_WARNING, PN_MESSAGE_LIGHT_ANGLE,
           "the map would open past 170 degrees; casters beyond are left out");
}

static pni_map_draw tile_draw(const pn_light *light, pn_casters *casters, const pni_maps_want *want, int tile) {
  const pni_fit_result *fit = &light->maps.fit;
  pni_fit_request request = fit_request(light, want, NULL, NULL);
  pni_map_draw draw = {.frame = &light->frame,
                       .casters = casters,
                       .groups = light->groups,
                       .w_near = fit->w_near,
                       .w_far = fit->w_far,
                       .range = pni_fit_range(&request)};
  memcpy(draw.bounds, fit->tile[tile], sizeof draw.bounds);
  if (fit->kept.has_floor && !want->receivers) draw.floor = fit->kept.floor;
  if (want->focus > 0) draw.later = pni_fit_focus(&request, fit, tile, want->focus);
  return draw;
}

static pn_result draw_maps(pn_light *light, pn_casters *casters, const pni_maps_want *want) {
  pni_gpu *gpu = pni_light_gpu(light);
  pni_maps *maps = &light->maps;
  maps->rounding = pni_casters_rounding(casters, light->groups, &light->frame);
  pni_map_rounding(&maps->rounding, light->frame.projection, maps->fit.bounds, maps->fit.w_near);
  pn_result result = pni_maps_shape(gpu, maps, want, maps->fit.tiles, light->desc.map_width, light->desc.map_height);
  if (result != PN_OK || pni_want_layers(want) == 0) return result;
  pni_maps_describe(gpu, maps, &light->frame, &light->emission);
  for (int tile = 0; tile < maps->fit.tiles && result == PN_OK; tile++) {
    pni_map_draw draw = tile_draw(light, casters, want, tile);
    result = pni_maps_add(gpu, maps, &draw);
  }
  pni_clock_mark(gpu, &light->clock, "depth_map");
  if (result != PN_OK || !want->range.structure) return result;
  result = pni_light_bind_block(light);
  if (result == PN_OK) result = pni_range_build(gpu, maps);
  pni_clock_mark(gpu, &light->clock, "range");
  return result;
}

/* What the technique makes of the maps. Where nothing casts that is nothing, and what another technique kept goes all
 * the same. */
static pn_result update_technique(pn_light *light) {
  const pni_technique_class *technique = light->technique;
  pni_job job;
  pn_result result = pni_light_job(light, &job);
  if (result != PN_OK || !technique->update || light->maps.fit.empty) return result;
  result = pni_light_bind_block(light);
  if (result == PN_OK) result = technique->update(&job);
  pni_clock_mark(job.gpu, &light->clock, technique->stage);
  return result;
}

typedef struct {
  pn_light *light;
  pn_receiver *const *receivers;
  int count;
} view_list;

/* As far down as nothing seen lies below it. */
static pn_result lower_plane(void *user, double plane[3], bool *found) {
  const view_list *views = user;
  pn_result result = PN_OK;
  for (int i = 0; i < 2; i++) plane[i] = (float)plane[i];
  plane[2] = INFINITY;
  for (int i = 0; i < views->count && result == PN_OK; i++) {
    result = pni_receiver_open(views->receivers[i]);
    if (result != PN_OK) break;
    result = pni_receiver_offset(views->receivers[i], &views->light->frame, plane, &plane[2]);
    pni_receiver_close(views->receivers[i]);
  }
  *found = plane[2] < INFINITY;
  return result;
}

/* What shadows fall on where the maps show nothing. */
static pn_result find_ground(const surfaces *seen, view_list *views, pni_fit_result *fit) {
  fit->has_ground = pni_grid_plane(seen->grid, fit->ground);
  return fit->has_ground ? lower_plane(views, fit->ground, &fit->has_ground) : PN_OK;
}

/* A fit to the surfaces, and to what of the casters counts then. */
static pn_result fit_to_surfaces(pn_light *light, pn_casters *casters, const pni_maps_want *want,
                                 pn_receiver *const *receivers, int count, const surfaces *seen) {
  fit_light(light, casters, want, seen, NULL);
  if (light->maps.fit.empty) return PN_OK;
  pni_fit_result whole = light->maps.fit;
  pni_fit_kept kept = {0};
  view_list views = {light, receivers, count};
  pni_fit_request fit = fit_request(light, want, seen, NULL);
  pni_trim_request request = {.frame = &light->frame,
                              .casters = casters,
                              .groups = light->groups,
                              .range = pni_fit_range(&fit),
                              .fit = &whole,
                              .grid = seen->grid,
                              .lower = lower_plane,
                              .user = &views};
  pn_result result = pni_casters_check(casters, light->groups);
  if (result == PN_OK) result = pni_trim(pni_light_gpu(light), light->trim, &request, &kept);
  if (result == PN_OK) fit_light(light, casters, want, seen, &kept);
  if (result == PN_OK && want->receivers) result = find_ground(seen, &views, &light->maps.fit);
  return result;
}

static pn_result fit_to_view(pn_light *light, pn_casters *casters, pn_receiver *const *visible, int visible_count,
                             const pni_maps_want *want) {
  pn_result result = find_frusta(light, visible, visible_count);
  if (result != PN_OK) return result;
  fit_light(light, casters, want, NULL, NULL);
  if (light->desc.fit != PN_FIT_VISIBLE || !light->has_visible || light->maps.fit.empty) return PN_OK;
  surfaces seen = {{0}, NULL};
  result = find_surfaces(light, visible, visible_count, &seen);
  if (result == PN_OK) result = fit_to_surfaces(light, casters, want, visible, visible_count, &seen);
  pni_clock_mark(pni_light_gpu(light), &light->clock, "fit");
  pni_grid_free(pni_light_gpu(light), &seen.grid);
  pni_patches_free(pni_light_gpu(light), &seen.patches);
  return result;
}

/* ---- all or nothing ---------------------------------------------------------------------------------------------- */

/* What of a light an update changes, but for what plans bring back themselves. */
typedef struct {
  pni_maps maps;
  pni_frame frame;
  pni_region visible;
  bool has_visible;
  uint64_t casters;
  uint32_t groups;
} last_update;

static last_update remember(const pn_light *light) {
  return (last_update){light->maps, light->frame, light->visible, light->has_visible, light->casters, light->groups};
}

static void bring_back(pn_light *light, const last_update *last) {
  light->maps = last->maps;
  light->frame = last->frame;
  light->visible = last->visible;
  light->has_visible = last->has_visible;
  light->casters = last->casters;
  light->groups = last->groups;
}

static pn_result make_maps(pn_light *light, pn_casters *casters, const pni_maps_want *want) {
  pn_result result = light->maps.fit.empty ? PN_OK : draw_maps(light, casters, want);
  return result == PN_OK ? update_technique(light) : result;
}

/* Planned first: a failure leaves the maps of the last update, if there are any that can still be used. */
static pn_result update_maps(pn_light *light, pn_casters *casters, uint32_t groups, pn_receiver *const *visible,
                             int visible_count) {
  pni_gpu *gpu = pni_light_gpu(light);
  bool keep = light->maps.ready;
  last_update last = remember(light);
  pni_maps_want want;
  light->technique->want(light->values, &want);
  light->reaching = reaching(&light->emission, &want);
  light->groups = groups;
  light->casters = casters->object.serial;
  pni_frame_place(&light->frame, casters, groups);
  pn_result result = pni_gpu_check_lost(gpu);
  if (result == PN_OK) result = fit_to_view(light, casters, visible, visible_count, &want);
  if (result == PN_OK) {
    pni_plan_begin(gpu, keep);
    result = pni_plan_end(gpu, make_maps(light, casters, &want));
  }
  if (result != PN_OK) {
    if (keep) bring_back(light, &last);
    return result;
  }
  result = make_maps(light, casters, &want);
  light->maps.ready = result == PN_OK;
  return result;
}

static pn_result check_arguments(const pn_light *light, const pn_casters *casters, pn_receiver *const *visible,
                                 int visible_count) {
  pni_gpu *gpu = pni_light_gpu(light);
  const pn_context *context = light->object.context;
  if (!casters) return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_maps_update: casters is NULL");
  if (casters->object.context != context)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT,
                    "pn_maps_update: the casters are of another context");
  if (visible_count < 0 || (visible_count > 0 && !visible))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT,
                    "pn_maps_update: visible is NULL, or a number of %d", visible_count);
  for (int i = 0; i < visible_count; i++)
    if (!visible[i] || visible[i]->object.context != context)
      return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_maps_update: visible[%d] is %s", i,
                      visible[i] ? "of another context" : "NULL");
  if (!light->set) return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_LIGHT_UNSET, "pn_light_set comes first");
  return PN_OK;
}

pn_result pn_maps_update(pn_light *light, pn_casters *casters, uint32_t groups, pn_receiver *const *visible,
                         int visible_count) {
  if (!light) return PN_ERROR_ARGUMENT;
  pni_gpu *gpu = pni_light_gpu(light);
  pn_result result = check_arguments(light, casters, visible, visible_count);
  if (result != PN_OK) return result;
  pni_enter(light->object.context);
  pni_clock_start(gpu, &light->clock);
  result = update_maps(light, casters, groups, visible, visible_count);
  pni_clock_end(gpu, &light->clock);
  return pni_leave(light->object.context, result);
}

pn_result pn_light_maps(const pn_light *light, pn_maps_info *out) {
  if (!light) return PN_ERROR_ARGUMENT;
  if (!out)
    return pni_fail(pni_light_gpu(light), PN_ERROR_ARGUMENT, PN_MESSAGE_NULL_ARGUMENT, "pn_light_maps: out is NULL");
  const pni_maps *maps = &light->maps;
  if (!maps->ready)
    return pni_fail(pni_light_gpu(light), PN_ERROR_NOT_READY, PN_MESSAGE_MAPS_STALE, "pn_maps_update comes first");
  const double *b = maps->fit.bounds;
  double offset[3];
  pni_frame_offset(&light->frame, offset);
  *out = (pn_maps_info){
      .empty = maps->fit.empty,
      .tiles = maps->fit.tiles,
      .layers = maps->fit.empty ? 0 : pni_want_layers(&maps->want),
      .width = light->desc.map_width,
      .height = light->desc.map_height,
      .s0 = (float)(b[0] + offset[0]),
      .t0 = (float)(b[1] + offset[1]),
      .s1 = (float)(b[2] + offset[0]),
      .t1 = (float)(b[3] + offset[1]),
      .w_near = (float)(maps->fit.w_near + offset[2]),
      .w_far = (float)(maps->fit.w_far + offset[2]),
      .texel_s = maps->fit.empty ? 0 : maps->block.texel[0],
      .texel_t = maps->fit.empty ? 0 : maps->block.texel[1],
      .gpu_memory = maps->depth.bytes + maps->range.bytes + maps->peel[0].bytes + maps->peel[1].bytes,
  };
  return PN_OK;
}
