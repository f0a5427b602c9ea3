/* ground.h: the plane below a model. */
#ifndef PENUMBRA_APP_SCENE_GROUND_H
#define PENUMBRA_APP_SCENE_GROUND_H

#include "scene/scene.h"

/* A plane at the lowest point, 5 H wide, around B; it only receives. Exit status. */
int ground_add(struct scene *scene);

#endif
