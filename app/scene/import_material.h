/* import_material.h: holes in materials. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_MATERIAL_H
#define PENUMBRA_APP_SCENE_IMPORT_MATERIAL_H

#include "scene/import_send.h"

/* Reads the alpha of every material and sends the textures it needs; what cannot be read is opaque, with a warning. */
void send_materials(struct importer *importer);

#endif
