/* save.h: raw buffers as EXR files in the folder of --save-dir. */
#ifndef PENUMBRA_APP_FILES_SAVE_H
#define PENUMBRA_APP_FILES_SAVE_H

#include <stdio.h>

#include "files/image.h"

/* Where buffers go; written paths are printed to people. */
struct save {
  const char *folder;
  FILE *people;
  int width, height;
};

/* Makes the folder where it is missing, and checks that it can be written. Exit status. */
int save_check(const char *folder);

/* After a failure: removes the folder that save_check made, if nothing is in it. */
void save_abandon(void);

int save_planes(const struct save *save, const char *name, const struct exr_plane *planes, int plane_count);
/* An image of its own size: layer after layer as Y, layer2.Y, layer3.Y, ... */
int save_layers(const struct save *save, const char *name, int width, int height, int layers, const float *values);
int save_vectors(const struct save *save, const char *name, const float *vectors); /* X, Y, Z */
int save_scalars(const struct save *save, const char *name, const float *values);  /* Y */

/* "NN-LABEL.exr" of the technique with this index; malloc'ed; NULL: out of memory. */
char *save_name(int index, const char *spec);
/* "NN-LABEL.KIND.exr" beside it. */
char *save_name_inside(const char *file, const char *kind);

#endif
