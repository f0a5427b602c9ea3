/* import_axes.h: which axis of the file is up. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_AXES_H
#define PENUMBRA_APP_SCENE_IMPORT_AXES_H

#include <assimp/scene.h>

#include "scene/import_send.h"

/* Scene from file: y up as it is, z up turned so that z becomes y and y becomes -z. */
void turn_up(struct importer *importer, int up_is_z);

/* What the file itself says goes first (FBX, Collada); --up where it says nothing. Units are the file's. */
void choose_axes(struct importer *importer, const struct aiScene *model, int up_is_z);

#endif
