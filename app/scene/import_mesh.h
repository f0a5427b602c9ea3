/* import_mesh.h: triangles. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_MESH_H
#define PENUMBRA_APP_SCENE_IMPORT_MESH_H

#include "scene/import_send.h"

/* Compacts a mesh (vertices at the same place shared, triangles without area or with impossible corners dropped)
 * and sends it. Returns its number in the scene, or -1 where no triangle is left. */
int send_mesh(struct importer *importer, const struct aiMesh *mesh, const struct material_alpha *alpha);

#endif
