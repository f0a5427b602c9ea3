/* gltf.h: glTF 2.0, read by the program itself, because Assimp leaves much of it out without a word: quantized and
 * sparse vertices, texture transforms, instances, poses of joints and shapes, and which extensions a file needs. */
#ifndef PENUMBRA_APP_SCENE_GLTF_H
#define PENUMBRA_APP_SCENE_GLTF_H

#include "scene/import_send.h"

/* Sends everything of the file but the end, or refuses (import_send.h). 0: it is no glTF 2.0, and nothing was sent. */
int gltf_import(struct importer *importer, int up_is_z);

#endif
