/* import.h: model files, through Assimp. It runs in a process of its own (import_process.h), because it may take any
 * time and memory over a hostile file, or crash. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_H
#define PENUMBRA_APP_SCENE_IMPORT_H

#include "scene/scene.h"

/* The model file, without ground and set-up. On any thread, also on several at once, whether or not GL has started;
 * import_serve must have been called. Exit status; prints one line on failure. */
int import_model(const char *path, int up_is_z, struct scene **out);

#endif
