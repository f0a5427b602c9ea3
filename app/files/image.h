/* image.h: pictures in files. Rows are top first everywhere. Files appear whole or not at all (output.h); a failure is
 * reported here, and the returned status is the program's exit status. */
#ifndef PENUMBRA_APP_FILES_IMAGE_H
#define PENUMBRA_APP_FILES_IMAGE_H

#include <stddef.h>
#include <stdint.h>

/* The largest width and height of a picture that is read or written. */
#define IMAGE_SIZE_MAX 16384

/* 8 bits a channel, as they go into the file (sRGB for colours). channels: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA. */
int png_write(const char *path, int width, int height, int channels, const uint8_t *pixels);

/* One float channel: pixel (x, y) is first[(y * width + x) * stride]. */
struct exr_plane {
  const char *name; /* "R", "Y", "X": written as given, in the alphabetical order that EXR wants */
  const float *first;
  int stride;
};

/* 32-bit float, ZIP-compressed scan lines. Values are stored as they are: NaN and infinity included. */
int exr_write(const char *path, int width, int height, const struct exr_plane *planes, int plane_count);

/* The path's kind by its ending, in any case. */
enum image_kind { IMAGE_UNKNOWN = 0, IMAGE_PNG, IMAGE_EXR };
enum image_kind image_kind_of(const char *path);

/* Decodes a PNG in memory to RGBA, 8 bits each, malloc'ed. Returns 0 on success; otherwise a static or caller-owned
 * explanation is in why and nothing was printed: a texture that cannot be read is the caller's warning to give. */
int png_decode(const void *bytes, size_t size, int *width, int *height, uint8_t **rgba, char *why, size_t why_size);

/* Linear value to its sRGB byte; values outside [0, 1] are clamped, NaN is 0. */
uint8_t srgb_byte(float linear);
void srgb_bytes(const float *linear, size_t count, uint8_t *out);

#endif
