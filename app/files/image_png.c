#include <png.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/message.h"
#include "files/image.h"
#include "files/output.h"

static const int png_formats[] = {0, PNG_FORMAT_GRAY, PNG_FORMAT_GA, PNG_FORMAT_RGB, PNG_FORMAT_RGBA};

int png_write(const char *path, int width, int height, int channels, const uint8_t *pixels) {
  struct output output;
  int status = output_open(&output, path);
  if (status) return status;
  png_image image = {0};
  image.version = PNG_IMAGE_VERSION;
  image.width = (png_uint_32)width;
  image.height = (png_uint_32)height;
  image.format = (png_uint_32)png_formats[channels];
  if (!png_image_write_to_stdio(&image, output.file, 0, pixels, width * channels, NULL)) {
    /* libpng says "Write Error"; the stream's errno says why. */
    return output_fail(&output, ferror(output.file) ? NULL : image.message);
  }
  return output_commit(&output);
}

int png_decode(const void *bytes, size_t size, int *width, int *height, uint8_t **rgba, char *why, size_t why_size) {
  *rgba = NULL;
  png_image image = {0};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&image, bytes, size)) {
    snprintf(why, why_size, "%s", image.message);
    return -1;
  }
  if (image.width > IMAGE_SIZE_MAX || image.height > IMAGE_SIZE_MAX ||
      (uint64_t)image.width * image.height > 1u << 26) {
    snprintf(why, why_size, "%u x %u texels are too many", image.width, image.height);
    png_image_free(&image);
    return -1;
  }
  image.format = PNG_FORMAT_RGBA;
  *rgba = malloc(PNG_IMAGE_SIZE(image));
  if (!*rgba || !png_image_finish_read(&image, NULL, *rgba, 0, NULL)) {
    snprintf(why, why_size, "%s", *rgba ? image.message : "out of memory");
    png_image_free(&image);
    free(*rgba);
    *rgba = NULL;
    return -1;
  }
  *width = (int)image.width;
  *height = (int)image.height;
  return 0;
}
