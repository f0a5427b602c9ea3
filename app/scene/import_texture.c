#include "scene/import_texture.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/image.h"
#include "scene/import_files.h"

/* Of all pictures together: a byte each in the program and on the GPU. */
enum { TEXELS_MAX = 1 << 28 };

struct sent_texture {
  struct sent_texture *next;
  struct alpha_source source;
  int number;
};

static int is_same(const struct alpha_source *a, const struct alpha_source *b) {
  return strcmp(a->name, b->name) == 0 && a->bytes == b->bytes && a->luminance == b->luminance &&
         a->cutoff == b->cutoff && a->wrap[0] == b->wrap[0] && a->wrap[1] == b->wrap[1] && a->factor == b->factor;
}

static int is_jpeg(const void *bytes, size_t size) { return size > 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0; }

enum loaded { LOADED, LOADED_OPAQUE, LOADED_NOT };

struct picture {
  int width, height;
  uint8_t *rgba;
  char why[200];
};

/* To RGBA, top row first. A JPEG has no alpha channel, so a base colour in one makes no holes and is not an error. */
static enum loaded decode(const void *bytes, size_t size, const struct alpha_source *source, struct picture *out) {
  if (is_jpeg(bytes, size) && !source->luminance && source->factor >= source->cutoff) return LOADED_OPAQUE;
  if (is_jpeg(bytes, size)) snprintf(out->why, sizeof out->why, "an alpha map in JPEG is not read; convert it to PNG");
  else if (png_decode(bytes, size, &out->width, &out->height, &out->rgba, out->why, sizeof out->why) == 0)
    return LOADED;
  return LOADED_NOT;
}

static enum loaded copy_texels(const struct alpha_source *source, struct picture *out) {
  if (source->width > IMAGE_SIZE_MAX || source->height > IMAGE_SIZE_MAX) return LOADED_NOT;
  size_t count = (size_t)source->width * source->height;
  const uint8_t *bgra = source->bytes;
  out->rgba = import_memory(4 * count, 1);
  for (size_t i = 0; i < count; i++)
    memcpy(out->rgba + 4 * i, (const uint8_t[4]){bgra[4 * i + 2], bgra[4 * i + 1], bgra[4 * i], bgra[4 * i + 3]}, 4);
  out->width = (int)source->width;
  out->height = (int)source->height;
  return LOADED;
}

static enum loaded load(const struct importer *importer, const struct alpha_source *source, struct picture *out) {
  snprintf(out->why, sizeof out->why, "it cannot be decoded");
  if (source->bytes && source->height) return copy_texels(source, out);
  if (source->bytes) return decode(source->bytes, source->size, source, out);
  size_t size = 0;
  void *bytes = read_beside(importer, source->name, &size);
  if (!bytes) {
    snprintf(out->why, sizeof out->why, "the file is missing or cannot be read");
    return LOADED_NOT;
  }
  enum loaded result = decode(bytes, size, source, out);
  free(bytes);
  return result;
}

/* Sends alpha * factor, bottom row first. */
static void send_alpha(struct importer *importer, const struct alpha_source *source, const struct picture *picture) {
  size_t width = (size_t)picture->width, height = (size_t)picture->height, count = width * height;
  int any_alpha = 0;
  for (size_t i = 0; i < count && !any_alpha; i++) any_alpha = picture->rgba[4 * i + 3] != 255;
  size_t channel = source->luminance && !any_alpha ? 1 : 3;
  uint8_t *alpha = import_memory(count, 1);
  for (size_t y = 0; y < height; y++)
    for (size_t x = 0; x < width; x++) {
      float value = picture->rgba[4 * (y * width + x) + channel] * source->factor;
      alpha[(height - 1 - y) * width + x] = (uint8_t)fminf(fmaxf(value, 0) + 0.5f, 255);
    }
  struct record r = {.tag = RECORD_TEXTURE,
                     .width = picture->width,
                     .height = picture->height,
                     .wrap_u = source->wrap[0],
                     .wrap_v = source->wrap[1]};
  send_bytes(importer->fd, &r, sizeof r);
  send_bytes(importer->fd, alpha, count);
  free(alpha);
}

static int send_new(struct importer *importer, const struct alpha_source *source) {
  struct picture picture = {0};
  enum loaded loaded = load(importer, source, &picture);
  uint64_t texels = (uint64_t)picture.width * (uint64_t)picture.height;
  if (loaded == LOADED && importer->texels + texels > TEXELS_MAX) {
    snprintf(picture.why, sizeof picture.why, "with it the model's pictures have more than %d texels", TEXELS_MAX);
    loaded = LOADED_NOT;
  }
  if (loaded == LOADED_NOT)
    send_warning(importer, "texture %.150s: %s; its material is drawn opaque", source->name, picture.why);
  if (loaded == LOADED) send_alpha(importer, source, &picture);
  free(picture.rgba);
  if (loaded != LOADED) return -1;
  importer->texels += texels;
  return importer->texture_count++;
}

int send_texture(struct importer *importer, const struct alpha_source *source) {
  for (const struct sent_texture *t = importer->textures; t; t = t->next) {
    int same_picture = strcmp(t->source.name, source->name) == 0 && t->source.bytes == source->bytes;
    if (is_same(&t->source, source) || (same_picture && t->number < 0)) return t->number; /* told once */
  }
  struct sent_texture *t = import_memory(1, sizeof *t);
  t->source = *source;
  t->number = send_new(importer, source);
  t->next = importer->textures;
  importer->textures = t;
  return t->number;
}
