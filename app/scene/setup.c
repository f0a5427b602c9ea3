#include "scene/setup.h"

#include <math.h>
#include <string.h>

#include "base/message.h"
#include "scene/vector.h"

static const double pi = 3.14159265358979323846;

void setup_standard(struct scene *scene) {
  double h = scene_extent(scene), b[3];
  b[0] = 0.5 * (scene->bounds_min[0] + scene->bounds_max[0]);
  b[1] = scene->bounds_min[1];
  b[2] = 0.5 * (scene->bounds_min[2] + scene->bounds_max[2]);
  struct setup *setup = &scene->setup;
  struct light *light = &setup->light;
  light->shape = PN_LIGHT_RECTANGLE;
  v3_set(light->center, b[0], b[1] + 3 * h, b[2]);
  v3_set(light->target, b[0], b[1], b[2]);
  v3_set(light->up, 0, 0, -1);
  light->size[0] = light->size[1] = h;
  struct camera *camera = &setup->camera;
  v3_set(camera->position, b[0], b[1] + 1.8 * h, b[2] + 2.6 * h);
  v3_set(camera->target, b[0], b[1] + 0.38 * h, b[2]);
  v3_set(camera->up, 0, 1, 0);
  camera->fov = 48.5;
  setup->size[0] = 1024;
  setup->size[1] = 768;
  setup->map[0] = setup->map[1] = 512;
  setup->visibility_scale = 1;
  setup->fit = PN_FIT_VISIBLE;
}

/* As the light's frame: where up is parallel to the view direction, another axis takes its place. */
static int camera_check(const struct camera *camera) {
  double view[3], side[3];
  v3_sub(camera->target, camera->position, view);
  if (!(v3_normalize(view) > 0))
    return input_error("--camera-target is the camera's own position: the two must differ");
  v3_cross(view, camera->up, side);
  if (!(v3_length(camera->up) > 0)) return input_error("--camera-up is zero: give a direction, such as 0,1,0");
  return STATUS_OK;
}

int light_finish(struct light *light) {
  double d[3];
  if (light->shape == PN_LIGHT_SUN && !(light->size[0] <= 90 && light->size[1] <= 90))
    return input_error("--light-size: a sun is at most 90 degrees wide");
  v3_sub(light->target, light->center, d);
  if (!(v3_normalize(d) > 0)) return input_error("--light-target is the light's own centre: the two must differ");
  if (!(v3_length(light->up) > 0)) return input_error("--light-up is zero: give a direction, such as 0,0,-1");
  /* The library's own frame, so that program and library mean the same u and v; unit length regained in double. */
  float direction[3], up[3], out[3], u[3], v[3];
  double unit_up[3];
  memcpy(unit_up, light->up, sizeof unit_up);
  v3_normalize(unit_up);
  for (int i = 0; i < 3; i++) {
    direction[i] = (float)d[i];
    up[i] = (float)unit_up[i];
  }
  if (pn_light_frame(direction, up, out, u, v) != PN_OK) return input_error("the light's direction is not usable");
  for (int i = 0; i < 3; i++) {
    light->direction[i] = d[i];
    light->u[i] = u[i];
  }
  v3_add_scaled(light->u, -v3_dot(light->u, d), d, light->u);
  v3_normalize(light->u);
  v3_cross(light->u, light->direction, light->v);
  for (int i = 0; i < 2; i++)
    light->half[i] = light->shape == PN_LIGHT_SUN ? tan(light->size[i] * pi / 360) : 0.5 * light->size[i];
  return STATUS_OK;
}

static int box_holds_caster(const struct scene *scene, const double box[6]) {
  for (int i = 0; i < scene->instance_count; i++) {
    double low[3], high[3];
    int meets = scene->instances[i].casts;
    if (meets) instance_bounds(scene, &scene->instances[i], low, high);
    for (int k = 0; k < 3 && meets; k++) meets = low[k] <= box[3 + k] && high[k] >= box[k];
    if (meets) return 1;
  }
  return 0;
}

static void warn_about_fit(const struct scene *scene) {
  const double *box = scene->setup.fit_bounds;
  int flat = 0;
  if (scene->setup.fit != PN_FIT_GIVEN) return;
  for (int k = 0; k < 3; k++) flat += !(box[3 + k] > box[k]);
  if (flat > 1) warning("--fit: the box has no extent: the depth map covers next to nothing");
  else if (!box_holds_caster(scene, box)) warning("--fit: nothing that casts is in the box: nothing casts a shadow");
}

/* Whether all of the light is below the plane that receives, or a sun shines upwards onto it from below. */
static int lies_below_ground(const struct scene *scene) {
  const struct light *light = &scene->setup.light;
  double corners[4][3], low[3] = {0}, high[3] = {0};
  int grounds = 0;
  for (int i = 0; i < scene->instance_count; i++)
    if (!scene->instances[i].casts && !grounds++) instance_bounds(scene, &scene->instances[i], low, high);
  if (grounds != 1 || low[1] != high[1]) return 0; /* none, or walls too */
  if (light->shape == PN_LIGHT_SUN) return light->direction[1] >= sin(fmax(light->size[0], light->size[1]) * pi / 360);
  light_corners(light, corners);
  for (int i = 0; i < 4; i++)
    if (corners[i][1] > low[1]) return 0;
  return 1;
}

static void warn_about_light(const struct scene *scene) {
  const struct light *light = &scene->setup.light;
  if (light->shape == PN_LIGHT_SUN) {
    if (lies_below_ground(scene)) warning("the sun shines from below the ground and lights nothing of it");
    return;
  }
  int inside = 1, in_front = 0;
  for (int k = 0; k < 3; k++)
    inside &= light->center[k] > scene->bounds_min[k] && light->center[k] < scene->bounds_max[k];
  for (int i = 0; i < 8; i++) {
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = (i >> k & 1 ? scene->bounds_max[k] : scene->bounds_min[k]) - light->center[k];
    in_front |= v3_dot(d, light->direction) > 0;
  }
  if (!in_front) warning("the whole model lies behind the light, which shines away from it: nothing casts a shadow");
  else if (inside)
    warning("the light's centre lies inside the model's bounds: what is behind the light casts no shadow");
  else if (lies_below_ground(scene)) warning("the light is below the ground and lights nothing of it");
}

int setup_finish(struct scene *scene) {
  struct setup *setup = &scene->setup;
  int status = camera_check(&setup->camera);
  if (!status) status = light_finish(&setup->light);
  if (status) return status;
  warn_about_light(scene);
  warn_about_fit(scene);
  return STATUS_OK;
}

void light_corners(const struct light *light, double corners[4][3]) {
  for (int i = 0; i < 4; i++) {
    double a = (i == 0 || i == 3 ? -1 : 1) * light->half[0], b = (i < 2 ? -1 : 1) * light->half[1];
    for (int k = 0; k < 3; k++) {
      /* A sun's direction towards its corner: against the way it shines, tilted by the tangents. */
      double base = light->shape == PN_LIGHT_SUN ? -light->direction[k] : light->center[k];
      corners[i][k] = base + a * light->u[k] + b * light->v[k];
    }
  }
}
