#include "scene/import_material.h"

#include <assimp/cimport.h>
#include <assimp/material.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A path without its folders, whichever way its slashes lean. */
static const char *last_part(const char *path) {
  const char *last = path;
  for (; *path; path++)
    if (*path == '/' || *path == '\\') last = path + 1;
  return last;
}

/* "*3", or the name of a file that the model carries with it. */
static const struct aiTexture *find_embedded(const struct aiScene *model, const char *name) {
  if (name[0] == '*') {
    unsigned long index = strtoul(name + 1, NULL, 10);
    return index < model->mNumTextures ? model->mTextures[index] : NULL;
  }
  for (unsigned i = 0; i < model->mNumTextures; i++) {
    const char *known = model->mTextures[i]->mFilename.data;
    if (*known && strcmp(last_part(known), last_part(name)) == 0) return model->mTextures[i];
  }
  return NULL;
}

static enum texture_wrap wrap_of(enum aiTextureMapMode mode) {
  return mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? WRAP_CLAMP
         : mode == aiTextureMapMode_Mirror                                ? WRAP_MIRROR
                                                                          : WRAP_REPEAT;
}

/* An opacity map of the older formats. */
static int find_picture(const struct aiScene *model, const struct aiMaterial *material, struct alpha_source *source,
                        int *uv_channel) {
  unsigned uv = 0;
  struct aiString file;
  enum aiTextureMapMode wrap[2] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
  if (aiGetMaterialTexture(material, aiTextureType_OPACITY, 0, &file, NULL, &uv, NULL, NULL, wrap, NULL) != AI_SUCCESS)
    return 0;
  *uv_channel = (int)uv;
  snprintf(source->name, sizeof source->name, "%s", file.data);
  for (int i = 0; i < 2; i++) source->wrap[i] = wrap_of(wrap[i]);
  source->luminance = 1;
  const struct aiTexture *embedded = find_embedded(model, source->name);
  if (embedded) {
    source->bytes = embedded->pcData;
    source->width = embedded->mWidth;
    source->height = embedded->mHeight;
    source->size = embedded->mHeight ? 0 : embedded->mWidth;
  }
  return file.length > 0;
}

void send_alpha_of(struct importer *importer, const struct alpha_source *source, int textured, const char *name,
                   struct material_alpha *out) {
  /* The highest alpha that there can be is factor. */
  out->invisible = source->factor < source->cutoff;
  snprintf(out->name, sizeof out->name, "%.40s", name);
  if (out->invisible || !textured || source->cutoff <= 0) return;
  out->texture = send_texture(importer, source);
  out->cutoff = source->cutoff;
}

static void send_material(struct importer *importer, const struct aiScene *model, const struct aiMaterial *material,
                          struct material_alpha *out) {
  struct alpha_source source = {.factor = 1, .cutoff = 0.5f};
  struct aiString name = {0};
  ai_real opacity = 1;
  *out = (struct material_alpha)MATERIAL_OPAQUE;
  aiGetMaterialString(material, AI_MATKEY_NAME, &name);
  if (aiGetMaterialFloatArray(material, AI_MATKEY_OPACITY, &opacity, NULL) == AI_SUCCESS && isfinite(opacity))
    source.factor = fminf(opacity, 1);
  out->blended = source.factor >= source.cutoff && source.factor < 1;
  int textured = find_picture(model, material, &source, &out->uv_channel);
  send_alpha_of(importer, &source, textured, name.data, out);
}

struct material_alpha *send_materials(struct importer *importer, const struct aiScene *model) {
  struct material_alpha *alphas = import_memory(model->mNumMaterials, sizeof *alphas);
  for (unsigned i = 0; i < model->mNumMaterials; i++) send_material(importer, model, model->mMaterials[i], &alphas[i]);
  return alphas;
}
