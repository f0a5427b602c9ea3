#include "scene/import_material.h"

#include <assimp/GltfMaterial.h>
#include <assimp/cimport.h>
#include <assimp/material.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "files/image.h"
#include "scene/scene.h"

/* Where a material's holes are: which texture, which of its values, scaled by what. */
struct alpha_source {
  struct aiString file;
  int luminance; /* an opacity map without an alpha channel of its own: its grey value is the opacity */
  int uv_channel;
  enum aiTextureMapMode wrap[2];
  float factor, cutoff;
};

static int texture_of(const struct aiMaterial *material, enum aiTextureType type, struct alpha_source *source) {
  unsigned uv = 0;
  enum aiTextureMapMode wrap[2] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
  if (aiGetMaterialTexture(material, type, 0, &source->file, NULL, &uv, NULL, NULL, wrap, NULL) != AI_SUCCESS) return 0;
  source->uv_channel = (int)uv;
  memcpy(source->wrap, wrap, sizeof wrap);
  return source->file.length > 0;
}

/* glTF's MASK materials, and opacity maps of older formats. Returns 0: opaque, 1: source describes the holes, 2:
 * the same without a texture, factor only. */
static int find_source(const struct aiMaterial *material, struct alpha_source *source) {
  memset(source, 0, sizeof *source);
  source->factor = 1;
  source->cutoff = 0.5f;
  struct aiString mode;
  if (aiGetMaterialString(material, AI_MATKEY_GLTF_ALPHAMODE, &mode) == AI_SUCCESS) {
    if (strcmp(mode.data, "MASK") != 0) return 0;
    ai_real cutoff;
    if (aiGetMaterialFloatArray(material, AI_MATKEY_GLTF_ALPHACUTOFF, &cutoff, NULL) == AI_SUCCESS && isfinite(cutoff))
      source->cutoff = cutoff;
    struct aiColor4D colour;
    if (aiGetMaterialColor(material, AI_MATKEY_BASE_COLOR, &colour) == AI_SUCCESS ||
        aiGetMaterialColor(material, AI_MATKEY_COLOR_DIFFUSE, &colour) == AI_SUCCESS)
      if (isfinite(colour.a)) source->factor = colour.a;
    return texture_of(material, aiTextureType_BASE_COLOR, source) || texture_of(material, aiTextureType_DIFFUSE, source)
               ? 1
               : 2;
  }
  if (!texture_of(material, aiTextureType_OPACITY, source)) return 0;
  source->luminance = 1;
  return 1;
}

static void *read_file(const char *path, size_t *size) {
  struct stat info;
  int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return NULL;
  void *bytes = NULL;
  if (fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0 && info.st_size < (off_t)1 << 30) {
    *size = (size_t)info.st_size;
    bytes = malloc(*size);
    if (bytes && read(fd, bytes, *size) != (ssize_t)*size) {
      free(bytes);
      bytes = NULL;
    }
  }
  close(fd);
  return bytes;
}

/* "%20" becomes a space: glTF names files by URI. */
static void decode_uri(char *text) {
  char *out = text;
  for (const char *in = text; *in; in++) {
    unsigned value;
    if (*in == '%' && in[1] && in[2] && sscanf(in + 1, "%2x", &value) == 1) {
      *out++ = (char)value;
      in += 2;
    } else {
      *out++ = *in == '\\' ? '/' : *in;
    }
  }
  *out = 0;
}

/* Reads a file named in the model: relative to the model's folder, as written, then decoded as a URI. */
static void *read_beside(const char *model, const char *name, size_t *size) {
  const char *slash = strrchr(model, '/');
  int folder = slash && name[0] != '/' ? (int)(slash - model) + 1 : 0;
  char path[4096];
  if (snprintf(path, sizeof path, "%.*s%s", folder, model, name) >= (int)sizeof path) return NULL;
  void *bytes = read_file(path, size);
  if (bytes) return bytes;
  decode_uri(path + folder);
  return read_file(path, size);
}

static int is_jpeg(const void *bytes, size_t size) { return size > 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0; }

enum loaded { LOADED, LOADED_OPAQUE, LOADED_NOT };

/* To RGBA, top row first. A JPEG has no alpha channel, so a base colour in one makes no holes and is not an error. */
static enum loaded decode(const void *bytes, size_t size, const struct alpha_source *source, int *width, int *height,
                          uint8_t **rgba, char *why, size_t why_size) {
  if (is_jpeg(bytes, size) && !source->luminance && source->factor >= source->cutoff) return LOADED_OPAQUE;
  if (is_jpeg(bytes, size)) snprintf(why, why_size, "an alpha map in JPEG is not read; convert it to PNG");
  else if (png_decode(bytes, size, width, height, rgba, why, why_size) == 0) return LOADED;
  return LOADED_NOT;
}

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

static enum loaded load_rgba(const struct importer *importer, const struct alpha_source *source, int *width,
                             int *height, uint8_t **rgba, char *why, size_t why_size) {
  const struct aiTexture *embedded = find_embedded(importer->model, source->file.data);
  if (embedded && embedded->mHeight > 0) { /* texels, not a file: BGRA */
    if (embedded->mWidth > IMAGE_SIZE_MAX || embedded->mHeight > IMAGE_SIZE_MAX) return LOADED_NOT;
    size_t count = (size_t)embedded->mWidth * embedded->mHeight;
    *rgba = malloc(4 * count + 1);
    if (!*rgba) _exit(1);
    for (size_t i = 0; i < count; i++) {
      const struct aiTexel *t = &embedded->pcData[i];
      memcpy(*rgba + 4 * i, (const uint8_t[4]){t->r, t->g, t->b, t->a}, 4);
    }
    *width = (int)embedded->mWidth;
    *height = (int)embedded->mHeight;
    return LOADED;
  }
  if (embedded) return decode(embedded->pcData, embedded->mWidth, source, width, height, rgba, why, why_size);
  size_t size = 0;
  void *bytes = read_beside(importer->path, source->file.data, &size);
  if (!bytes) {
    snprintf(why, why_size, "the file is missing or cannot be read");
    return LOADED_NOT;
  }
  enum loaded result = decode(bytes, size, source, width, height, rgba, why, why_size);
  free(bytes);
  return result;
}

static enum texture_wrap wrap_of(enum aiTextureMapMode mode) {
  return mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? WRAP_CLAMP
         : mode == aiTextureMapMode_Mirror                                ? WRAP_MIRROR
                                                                          : WRAP_REPEAT;
}

/* Sends alpha * factor, bottom row first. */
static void send_texture(struct importer *importer, const struct alpha_source *source, int width, int height,
                         const uint8_t *rgba) {
  size_t count = (size_t)width * (size_t)height;
  int any_alpha = 0;
  for (size_t i = 0; i < count && !any_alpha; i++) any_alpha = rgba[4 * i + 3] != 255;
  int channel = source->luminance && !any_alpha ? 1 : 3;
  uint8_t *alpha = malloc(count);
  if (!alpha) _exit(1);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      float value = rgba[4 * ((size_t)y * (size_t)width + (size_t)x) + (size_t)channel] * source->factor;
      alpha[(size_t)(height - 1 - y) * (size_t)width + (size_t)x] = (uint8_t)fminf(fmaxf(value, 0) + 0.5f, 255);
    }
  struct record r = {.tag = RECORD_TEXTURE,
                     .width = width,
                     .height = height,
                     .wrap_u = wrap_of(source->wrap[0]),
                     .wrap_v = wrap_of(source->wrap[1])};
  send_bytes(importer->fd, &r, sizeof r);
  send_bytes(importer->fd, alpha, count);
  free(alpha);
}

static void send_material(struct importer *importer, const struct aiMaterial *material, struct material_alpha *out) {
  *out = (struct material_alpha){.texture = -1};
  struct alpha_source source;
  int found = find_source(material, &source);
  if (found) out->invisible = source.cutoff > 1 || (found == 2 && source.factor < source.cutoff);
  if (found != 1 || out->invisible || source.cutoff <= 0) return;
  int width = 0, height = 0;
  uint8_t *rgba = NULL;
  char why[200] = "it cannot be decoded";
  enum loaded loaded = load_rgba(importer, &source, &width, &height, &rgba, why, sizeof why);
  if (loaded == LOADED_NOT)
    send_text(importer->fd, RECORD_WARNING, "texture %.150s: %s; its material is drawn opaque", source.file.data, why);
  if (loaded != LOADED) return;
  send_texture(importer, &source, width, height, rgba);
  free(rgba);
  out->texture = importer->texture_count++;
  out->uv_channel = source.uv_channel;
  out->cutoff = source.cutoff;
}

void send_materials(struct importer *importer) {
  unsigned count = importer->model->mNumMaterials;
  importer->alphas = calloc(count + 1, sizeof *importer->alphas);
  if (!importer->alphas) _exit(1);
  for (unsigned i = 0; i < count; i++) send_material(importer, importer->model->mMaterials[i], &importer->alphas[i]);
}
