/* import_texture.h: pictures with holes. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_TEXTURE_H
#define PENUMBRA_APP_SCENE_IMPORT_TEXTURE_H

#include "scene/import_send.h"
#include "scene/scene.h"

/* Where a material's holes are: which picture, which of its values, scaled by what. */
struct alpha_source {
  char name[1024];   /* a file beside the model, or what the model calls the picture that it carries */
  const void *bytes; /* the picture that it carries: a file's bytes, or texels, BGRA, where height is not 0; or NULL */
  size_t size;
  uint32_t width, height;
  int luminance; /* an opacity map without an alpha channel of its own: its grey value is the opacity */
  enum texture_wrap wrap[2];
  float factor, cutoff;
};

/* Sends the picture, each once however many materials share it, and returns its number; -1: it has no holes, or cannot
 * be read, which was said. */
int send_texture(struct importer *importer, const struct alpha_source *source);

#endif
