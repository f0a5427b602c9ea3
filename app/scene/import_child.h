/* import_child.h: between the files of the import's own process. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_CHILD_H
#define PENUMBRA_APP_SCENE_IMPORT_CHILD_H

#include <assimp/material.h>
#include <assimp/scene.h>
#include <stdint.h>

#include "scene/import.h"

struct importer {
  int fd;
  const char *path;
  const struct aiScene *model;
  struct sent_mesh *sent;        /* one for each of the model's meshes */
  struct material_alpha *alphas; /* one for each material */
  int mesh_count, texture_count, instance_count;
  uint64_t dropped_nan, dropped_far, dropped_area, dropped_index, dropped_instances;
};

/* Writes to the parent; ends the process where the parent has gone. */
void send_bytes(int fd, const void *bytes, size_t size);
void send_text(int fd, enum record_tag tag, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* What a material's holes come from. texture -1: opaque. invisible: below its cutoff everywhere. */
struct material_alpha {
  int texture, uv_channel, invisible;
  float cutoff;
};

/* Reads the alpha of every material and sends the textures it needs; what cannot be read is opaque, with a warning. */
void send_materials(struct importer *importer);

/* Compacts a mesh (vertices at the same place shared, triangles without area or with impossible corners dropped)
 * and sends it. Returns its number in the scene, or -1 where no triangle is left. */
int send_mesh(struct importer *importer, const struct aiMesh *mesh, const struct material_alpha *alpha);

#endif
