/* setup.h: light and camera: the standard ones, and what follows from those that were chosen. */
#ifndef PENUMBRA_APP_SCENE_SETUP_H
#define PENUMBRA_APP_SCENE_SETUP_H

#include "scene/scene.h"

/* The contract's standard light and camera from B and H, and default sizes. */
void setup_standard(struct scene *scene);

/* Derives light.direction, u, v and half, checks light and camera, and warns where the light cannot light the
 * scene. Call it after options have changed the set-up. Returns the exit status. */
int setup_finish(struct scene *scene);

/* The light's part of it: direction, u, v and half. */
int light_finish(struct light *light);

/* The four corners of a rectangle in scene space; of a sun, the four directions towards its corners (unit length
 * not kept). */
void light_corners(const struct light *light, double corners[4][3]);

#endif
