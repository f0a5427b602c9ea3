/* builtin.h: the scenes made in code. */
#ifndef PENUMBRA_APP_SCENE_BUILTIN_H
#define PENUMBRA_APP_SCENE_BUILTIN_H

#include "scene.h"

/* build fills an empty scene whose set-up is the standard one for B = the origin and H = 1, and may change it. 0,
 * or -1: out of memory. */
struct builtin {
  const char *name, *summary;
  int (*build)(struct scene *scene, int count);
  int count, count_max; /* default and largest N of builtin:NAME=N; 0: takes no N */
};

extern const struct builtin builtins[];
extern const int builtin_count;

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

/* A floor at y = 0, 5 wide, that only receives. */
int builtin_floor(struct scene *scene);

#endif
