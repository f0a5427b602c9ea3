/* import_pose.h: joints and shape keys in models that Assimp reads. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_POSE_H
#define PENUMBRA_APP_SCENE_IMPORT_POSE_H

#include <assimp/scene.h>

#include "scene/import_place.h"

struct place place_of_matrix(const struct aiMatrix4x4 *m);

/* Meshes are drawn as they were modelled; one line where the file poses them otherwise. */
void warn_about_poses(const struct importer *importer, const struct aiScene *model);

#endif
