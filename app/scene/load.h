/* load.h: a scene from a model file (import.h) or builtin:NAME (builtin.h), with its ground and standard set-up. */
#ifndef PENUMBRA_APP_SCENE_LOAD_H
#define PENUMBRA_APP_SCENE_LOAD_H

#include "scene/scene.h"

/* What scene_load is told beside the name. Zeroed: the defaults. */
struct scene_request {
  const char *name; /* a file, or builtin:NAME or builtin:NAME=N */
  int up_is_z;
  enum ground ground; /* default: on for files, off for built-in scenes, which bring their own floor */
  int split;
};

/* Loads or builds the scene with its ground, its standard set-up (contract: B and H) applied. On failure *out is
 * NULL, one line was printed, and the exit status is returned. On any thread, also on several at once, once main has
 * called import_serve (scene/import_process.h). */
int scene_load(const struct scene_request *request, struct scene **out);

#endif
