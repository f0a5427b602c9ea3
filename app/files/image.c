#include "files/image.h"

#include <math.h>
#include <string.h>
#include <strings.h>

enum image_kind image_kind_of(const char *path) {
  const char *dot = strrchr(path, '.');
  if (dot && strcasecmp(dot, ".png") == 0) return IMAGE_PNG;
  if (dot && strcasecmp(dot, ".exr") == 0) return IMAGE_EXR;
  return IMAGE_UNKNOWN;
}

uint8_t srgb_byte(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  float encoded = linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1 / 2.4f) - 0.055f;
  return (uint8_t)(encoded * 255 + 0.5f);
}

void srgb_bytes(const float *linear, size_t count, uint8_t *out) {
  for (size_t i = 0; i < count; i++) out[i] = srgb_byte(linear[i]);
}
