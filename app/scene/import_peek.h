/* import_peek.h: what Assimp would read wrongly without a word. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_PEEK_H
#define PENUMBRA_APP_SCENE_IMPORT_PEEK_H

#include "scene/import_send.h"

/* Refuses such a file. */
void peek(const struct importer *importer);

#endif
