#include "scene/load.h"

#include <string.h>

#include "base/message.h"
#include "scene/builtin.h"
#include "scene/ground.h"
#include "scene/import.h"
#include "scene/setup.h"

/* With --split what casts does not receive. */
static int split(struct scene *scene) {
  int receivers = 0;
  for (int i = 0; i < scene->instance_count; i++) {
    struct instance *instance = &scene->instances[i];
    if (instance->casts) instance->receives = 0;
    receivers += instance->receives;
  }
  scene->setup.split = 1;
  if (receivers) return STATUS_OK;
  return input_error("--split: %s has no ground of its own to receive shadows; add --ground on, or leave --split out",
                     scene->name);
}

/* A built-in scene brings its own floor or walls: off takes them away, on adds a ground only where there is none. */
static int apply_ground(struct scene *scene, enum ground ground, int builtin) {
  int receivers = 0, kept = 0;
  for (int i = 0; i < scene->instance_count; i++) receivers += !scene->instances[i].casts;
  if (builtin && ground == GROUND_OFF) {
    for (int i = 0; i < scene->instance_count; i++)
      if (scene->instances[i].casts) scene->instances[kept++] = scene->instances[i];
    scene->instance_count = kept;
  }
  int wanted = ground == GROUND_ON || (ground == GROUND_DEFAULT && !builtin);
  return wanted && !receivers ? ground_add(scene) : STATUS_OK;
}

int scene_load(const struct scene_request *request, struct scene **out) {
  *out = NULL;
  if (!*request->name) return input_error("SCENE is empty: give a model file or builtin:NAME");
  static const char prefix[] = "builtin:";
  int builtin = strncmp(request->name, prefix, sizeof prefix - 1) == 0;
  struct scene *scene = NULL;
  int status = builtin ? builtin_build(request->name + sizeof prefix - 1, &scene)
                       : import_model(request->name, request->up_is_z, &scene);
  if (status) return status;
  scene_measure(scene);
  if (!(scene_extent(scene) > 0) || scene_extent(scene) > COORDINATE_MAX) {
    status = input_error("%s: the model's extent is %g, which cannot be drawn", request->name, scene_extent(scene));
  } else {
    if (!builtin) setup_standard(scene);
    status = apply_ground(scene, request->ground, builtin);
  }
  if (!status && request->split) status = split(scene);
  if (status) {
    scene_free(&scene);
    return status;
  }
  scene_measure(scene);
  scene->setup.ground = request->ground;
  scene->setup.up_is_z = request->up_is_z;
  *out = scene;
  return STATUS_OK;
}
