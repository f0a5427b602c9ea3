/* import_send.h: between the files of the import's own process: what it knows, and how it speaks to its parent. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_SEND_H
#define PENUMBRA_APP_SCENE_IMPORT_SEND_H

#include <stddef.h>
#include <stdint.h>

#include "scene/import_records.h"

/* What a material's holes come from. texture -1: opaque. invisible: below its cutoff everywhere. blended: in part.
 * transform: where texture coordinates (v upwards) are read, two rows of three. */
struct material_alpha {
  char name[48];
  int texture, uv_channel, invisible, blended;
  float cutoff;
  double transform[6];
};
#define MATERIAL_OPAQUE \
  { \
    .texture = -1, .transform = { 1, 0, 0, 0, 1, 0 } \
  }

struct sent_texture; /* import_texture.c */

struct importer {
  int fd;
  const char *path;
  double turn[9]; /* scene from file, rows: which axis is up */
  int mesh_count, texture_count, instance_count;
  uint64_t triangles_held, triangles_placed; /* of meshes sent, each once; of instances */
  uint64_t texels;
  struct sent_texture *textures; /* those that were sent or could not be read */
  int blended;                   /* meshes whose opacity is between none and all */
  uint64_t dropped_nan, dropped_far, dropped_area, dropped_index, dropped_instances;
  char transparent[48];  /* the material of the first mesh that is not there to be seen, */
  int transparent_count; /* and how many such meshes there are */
};

/* Writes to the parent; ends the process where the parent has gone. */
void send_bytes(int fd, const void *bytes, size_t size);
void send_text(int fd, enum record_tag tag, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* The file is not used: sends the line that says why and ends the process. */
_Noreturn void refuse(const struct importer *importer, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The file is used, without what the line names. */
#define send_warning(importer, ...) send_text((importer)->fd, RECORD_WARNING, __VA_ARGS__)

/* Memory that was got, or the end of the process; never NULL. */
void *import_memory(size_t count, size_t element);

#endif
