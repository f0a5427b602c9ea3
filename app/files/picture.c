#include "files/picture.h"

#include <stdlib.h>

#include "base/message.h"
#include "files/image.h"

static int write_png(const char *path, int width, int height, const float *rgb) {
  size_t count = (size_t)width * (size_t)height * 3;
  uint8_t *bytes = malloc(count);
  if (!bytes) return memory_error();
  srgb_bytes(rgb, count, bytes);
  int status = png_write(path, width, height, 3, bytes);
  free(bytes);
  return status;
}

int picture_write(const char *path, int width, int height, const float *rgb) {
  if (image_kind_of(path) == IMAGE_PNG) return write_png(path, width, height, rgb);
  const struct exr_plane planes[3] = {{"B", rgb + 2, 3}, {"G", rgb + 1, 3}, {"R", rgb, 3}};
  return exr_write(path, width, height, planes, 3);
}
