/* builtin.h: the scenes made in code, by one table. */
#ifndef PENUMBRA_APP_SCENE_BUILTIN_H
#define PENUMBRA_APP_SCENE_BUILTIN_H

#include "scene/scene.h"

/* build fills an empty scene whose set-up is the standard one for B = the origin and H = 1, and may change it. 0,
 * or -1: out of memory. */
struct builtin {
  const char *name, *summary;
  int (*build)(struct scene *scene, int count);
  int count, count_max; /* default and largest N of builtin:NAME=N; 0: takes no N */
};

extern const struct builtin builtins[];
extern const int builtin_count;

/* builtin:NAME without its prefix, with floor and its own light and camera. Exit status; prints one line on failure. */
int builtin_build(const char *name, struct scene **out);

#endif
