/* From options to a scene with its set-up. */
#include <math.h>
#include <string.h>

#include "base/message.h"
#include "cli/options.h"
#include "scene/scene_json.h"
#include "scene/setup.h"
#include "scene/vector.h"

static const double degrees = 180 / 3.14159265358979323846;

/* A light that changes its kind and not its size keeps the angle under which the target sees it. */
static void change_shape(struct light *light, pn_light_shape shape) {
  if (light->shape == shape) return;
  double d[3];
  v3_sub(light->target, light->center, d);
  double distance = v3_length(d);
  for (int i = 0; i < 2; i++)
    light->size[i] = shape == PN_LIGHT_SUN ? fmin(2 * atan(0.5 * light->size[i] / distance) * degrees, 90)
                                           : 2 * distance * tan(0.5 * light->size[i] / degrees);
  light->shape = shape;
}

/* Lays the given set-up options over the scene's own. */
static void options_apply(const struct options *o, struct setup *setup) {
  const struct setup *from = &o->setup;
  if (o->given[OPTION_LIGHT]) change_shape(&setup->light, from->light.shape);
#define APPLY(option, field) \
  if (o->given[option]) memcpy(&setup->field, &from->field, sizeof setup->field)
  APPLY(OPTION_LIGHT_CENTER, light.center);
  APPLY(OPTION_LIGHT_TARGET, light.target);
  APPLY(OPTION_LIGHT_UP, light.up);
  APPLY(OPTION_LIGHT_SIZE, light.size);
  APPLY(OPTION_CAMERA_POSITION, camera.position);
  APPLY(OPTION_CAMERA_TARGET, camera.target);
  APPLY(OPTION_CAMERA_UP, camera.up);
  APPLY(OPTION_FOV, camera.fov);
  APPLY(OPTION_SIZE, size);
  APPLY(OPTION_MAP, map);
  APPLY(OPTION_FIT, fit);
  APPLY(OPTION_FIT, fit_bounds);
  APPLY(OPTION_VISIBILITY_SCALE, visibility_scale);
  APPLY(OPTION_NORMALS, normals_from_depth);
#undef APPLY
}

int options_scene(const struct options *o, const char *name, struct scene **out) {
  *out = NULL;
  struct scene_request request = {.name = name ? name : o->positionals[0]};
  cJSON *json = NULL;
  int status = o->setup_file ? setup_read(o->setup_file, &json) : STATUS_OK;
  if (!status && json) status = setup_request(o->setup_file, json, &request);
  if (o->given[OPTION_GROUND]) request.ground = o->ground;
  if (o->given[OPTION_UP]) request.up_is_z = o->up_is_z;
  if (o->given[OPTION_SPLIT]) request.split = 1;
  struct scene *scene = NULL;
  if (!status) status = scene_load(&request, &scene);
  if (!status && json) status = setup_apply_json(o->setup_file, json, &scene->setup);
  cJSON_Delete(json);
  if (!status) {
    options_apply(o, &scene->setup);
    status = setup_finish(scene);
  }
  if (status) scene_free(&scene);
  *out = scene;
  return status;
}
