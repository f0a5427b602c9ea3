/* import_material.h: what of a material matters to shadows: where its holes are. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_MATERIAL_H
#define PENUMBRA_APP_SCENE_IMPORT_MATERIAL_H

#include <assimp/scene.h>

#include "scene/import_texture.h"

/* The alpha of each of the model's materials, whose pictures are sent. */
struct material_alpha *send_materials(struct importer *importer, const struct aiScene *model);

/* For any format: a material whose holes are in a picture (textured) or whose opacity is the same everywhere. cutoff:
 * from which opacity on it blocks light. A name is said where nothing of the material is left. */
void send_alpha_of(struct importer *importer, const struct alpha_source *source, int textured, const char *name,
                   struct material_alpha *out);

#endif
