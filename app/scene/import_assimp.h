/* import_assimp.h: models of all formats that are not read by this program itself, through Assimp. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_ASSIMP_H
#define PENUMBRA_APP_SCENE_IMPORT_ASSIMP_H

#include "scene/import_send.h"

/* Sends everything of the file but the end, or refuses. */
void import_through_assimp(struct importer *importer, int up_is_z);

#endif
