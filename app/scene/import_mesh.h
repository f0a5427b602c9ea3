/* import_mesh.h: triangles. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_MESH_H
#define PENUMBRA_APP_SCENE_IMPORT_MESH_H

#include <assimp/mesh.h>

#include "scene/import_send.h"

/* number: in the scene; without triangles there is none. */
struct sent_mesh {
  int tried, number;
  uint32_t triangles;
};

/* Compacts a mesh (vertices at the same place shared, triangles without area or with impossible corners dropped)
 * and sends it. */
struct sent_mesh send_mesh(struct importer *importer, const struct aiMesh *mesh, const struct material_alpha *alpha);

#endif
