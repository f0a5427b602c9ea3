/* import_send.h: between the files of the import's own process: what it knows, and how it speaks to its parent. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_SEND_H
#define PENUMBRA_APP_SCENE_IMPORT_SEND_H

#include <assimp/scene.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/import_records.h"

/* What a material's holes come from. texture -1: opaque. invisible: below its cutoff everywhere. */
struct material_alpha {
  int texture, uv_channel, invisible;
  float cutoff;
};

struct importer {
  int fd;
  const char *path;
  const struct aiScene *model;
  int *sent;                     /* one for each of the model's meshes: its number in the scene */
  struct material_alpha *alphas; /* one for each material */
  int mesh_count, texture_count, instance_count;
  uint64_t dropped_nan, dropped_far, dropped_area, dropped_index, dropped_instances;
};

/* Writes to the parent; ends the process where the parent has gone. */
void send_bytes(int fd, const void *bytes, size_t size);
void send_text(int fd, enum record_tag tag, const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
