#include "scene/builtin.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "base/names.h"
#include "scene/builtin_scenes.h"
#include "scene/setup.h"

const struct builtin builtins[] = {
    {"square", "a square parallel to the light over a plane: its shadow has a closed form", build_square, 0, 0},
    {"boxes", "two boxes above each other over a floor: occluder fusion", build_boxes, 0, 0},
    {"cylinder", "a cylinder standing on a floor: contact hardening", build_cylinder, 0, 0},
    {"balls", "3 x 3 x 3 balls: occluders hidden behind occluders", build_balls, 0, 0},
    {"silhouette", "the edges that decide the shadow are hidden from the light's centre; lifted", build_silhouette, 0,
     0},
    {"silhouette-standing", "the same, standing on the floor", build_silhouette_standing, 0, 0},
    {"fence", "thin bars and wire netting", build_fence, 0, 0},
    {"leaves", "leaves cut out by an alpha-tested texture", build_leaves, 0, 0},
    {"room", "a ceiling light in a closed, furnished room: casters beyond 120 degrees", build_room, 0, 0},
    {"terrain", "a large terrain under a low sun, which shadows itself", build_terrain, 0, 0},
    {"copies", "N copies of one mesh, for scaling; builtin:copies=N, default 16", build_copies, 16, 4096},
};
const int builtin_count = sizeof builtins / sizeof *builtins;

static const struct builtin *find(const char *name, size_t length) {
  for (int i = 0; i < builtin_count; i++)
    if (strlen(builtins[i].name) == length && strncmp(builtins[i].name, name, length) == 0) return &builtins[i];
  return NULL;
}

static int unknown(const char *name) {
  const char *names[64];
  for (int i = 0; i < builtin_count; i++) names[i] = builtins[i].name;
  char hint[80];
  return input_error("builtin:%s: no such scene; %s", name,
                     nearest_name(name, names, builtin_count, hint, sizeof hint) ? hint
                                                                                 : "penumbra list scenes names them");
}

/* "copies=64": N. Exit status. */
static int parse_count(const struct builtin *builtin, const char *text, int *count) {
  if (!builtin->count_max) return input_error("builtin:%s takes no number", builtin->name);
  char *end;
  long n = strtol(text, &end, 10);
  if (end == text || *end || n < 1 || n > builtin->count_max)
    return input_error("builtin:%s=%s: N must be a whole number from 1 to %d", builtin->name, text, builtin->count_max);
  *count = (int)n;
  return STATUS_OK;
}

/* The standard set-up for B = 0 and H = 1, whatever the scene will hold. */
static void unit_setup(struct scene *scene) {
  for (int k = 0; k < 3; k++) {
    scene->bounds_min[k] = k == 1 ? 0 : -0.5f;
    scene->bounds_max[k] = k == 1 ? 1 : 0.5f;
  }
  setup_standard(scene);
}

int builtin_build(const char *name, struct scene **out) {
  *out = NULL;
  const char *equals = strchr(name, '=');
  const struct builtin *builtin = find(name, equals ? (size_t)(equals - name) : strlen(name));
  if (!builtin) return unknown(name);
  int count = builtin->count;
  int status = equals ? parse_count(builtin, equals + 1, &count) : STATUS_OK;
  if (status) return status;
  char full[64];
  if (builtin->count_max) snprintf(full, sizeof full, "builtin:%s=%d", builtin->name, count);
  else snprintf(full, sizeof full, "builtin:%s", builtin->name);
  struct scene *scene = scene_new(full);
  if (!scene) return memory_error();
  unit_setup(scene);
  if (builtin->build(scene, count)) {
    scene_free(&scene);
    return memory_error();
  }
  scene_measure(scene);
  *out = scene;
  return STATUS_OK;
}
