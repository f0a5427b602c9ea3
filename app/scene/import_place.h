/* import_place.h: where meshes stand. Matrices map column vectors, are column-major and in double, so that a node far
 * away and a child that comes back from there cancel. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_PLACE_H
#define PENUMBRA_APP_SCENE_IMPORT_PLACE_H

#include "scene/import_send.h"

struct place {
  double m[16];
};

struct place place_identity(void);
struct place place_product(const struct place *a, const struct place *b);
void place_point(const struct place *a, const double p[3], double out[3]);

/* Places a mesh that was sent, of this many triangles. An unusable place is counted; too many are refused. */
void send_instance(struct importer *importer, int mesh, uint64_t triangles, const struct place *file_from_object);

#endif
