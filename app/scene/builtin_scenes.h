/* builtin_scenes.h: what makes each built-in scene (see struct builtin); builtin.c has the table of them. */
#ifndef PENUMBRA_APP_SCENE_BUILTIN_SCENES_H
#define PENUMBRA_APP_SCENE_BUILTIN_SCENES_H

#include "scene/scene.h"

int build_square(struct scene *scene, int count);
int build_boxes(struct scene *scene, int count);
int build_cylinder(struct scene *scene, int count);
int build_balls(struct scene *scene, int count);
int build_silhouette(struct scene *scene, int count);
int build_silhouette_standing(struct scene *scene, int count);
int build_fence(struct scene *scene, int count);
int build_leaves(struct scene *scene, int count);
int build_room(struct scene *scene, int count);
int build_terrain(struct scene *scene, int count);
int build_copies(struct scene *scene, int count);

#endif
