/* The client's model files: Wavefront OBJ, positions and faces. */
#ifndef HOST_MODEL_H
#define HOST_MODEL_H

#include "scene.h"

/* One mesh with every face of the file, polygons cut into fans. 0 with a line on stderr when it cannot be read. */
int model_load(const char *path, mesh *out);

/* Everything in the scene as it is posed, in scene space. */
int model_save(const char *path, const scene *world);

#endif
