/* gltf_material.h: where glTF's materials have holes. */
#ifndef PENUMBRA_APP_SCENE_GLTF_MATERIAL_H
#define PENUMBRA_APP_SCENE_GLTF_MATERIAL_H

#include "scene/gltf_document.h"

/* The alpha of material index, its picture sent; -1: the default material. */
struct material_alpha gltf_alpha(struct gltf *g, int index);

/* Whether its opacity counts at all: not OPAQUE. */
int gltf_has_alpha(struct gltf *g, int index);

#endif
