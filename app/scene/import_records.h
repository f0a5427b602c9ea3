/* import_records.h: what the import's process sends to the program's: meshes, instances, textures, counts. Both are the
 * same executable, so structs travel as they are. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_RECORDS_H
#define PENUMBRA_APP_SCENE_IMPORT_RECORDS_H

#include <stdint.h>

enum record_tag { RECORD_MESH = 0x50454e01, RECORD_INSTANCE, RECORD_TEXTURE, RECORD_WARNING, RECORD_ERROR, RECORD_END };

struct record {
  uint32_t tag;
  uint32_t vertex_count, triangle_count; /* mesh: followed by positions, texcoords where texture >= 0, indices */
  int32_t mesh, texture;                 /* instance: which mesh; mesh: which texture */
  float cutoff;
  double scene_from_object[16];
  int32_t width, height, wrap_u, wrap_v; /* texture: followed by width * height bytes */
  uint32_t text_size;                    /* warning, error: followed by the text, without a terminator */
};

#endif
