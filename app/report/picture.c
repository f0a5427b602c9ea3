#include "report/picture.h"

#include <cairo.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const uint8_t picture_background[3] = {58, 62, 68};
const uint8_t picture_uncounted[3] = {176, 178, 180};

/* ---- errors as colours ------------------------------------------------------------------------------------------- */

/* From white outwards, in equal steps of |error|: lightness falls evenly on both arms, and blue against red is told
 * apart by (almost) everyone. */
#define ARM 5
static const uint8_t arms[2][ARM][3] = {
    {{255, 255, 255}, {170, 207, 229}, {90, 160, 205}, {38, 106, 173}, {5, 48, 97}},
    {{255, 255, 255}, {249, 190, 160}, {226, 120, 92}, {186, 40, 50}, {103, 0, 31}},
};

void picture_error_colour(double error, uint8_t rgb[3]) {
  static const uint8_t broken[3] = {255, 0, 255};
  if (isnan(error)) {
    memcpy(rgb, broken, 3);
    return;
  }
  double at = fmin(fabs(error) / PICTURE_ERROR_FULL, 1) * (ARM - 1);
  int step = at >= ARM - 1 ? ARM - 2 : (int)at;
  const uint8_t(*arm)[3] = arms[error > 0];
  for (int i = 0; i < 3; i++) rgb[i] = (uint8_t)lround(arm[step][i] + (at - step) * (arm[step + 1][i] - arm[step][i]));
}

uint8_t *picture_error_map(const struct report *report, const float *result) {
  size_t count = (size_t)report->width * (size_t)report->height;
  uint8_t *rgb = malloc(3 * count);
  for (size_t i = 0; rgb && i < count; i++)
    if (report->background[i]) memcpy(rgb + 3 * i, picture_background, 3);
    else if (!report->mask[i]) memcpy(rgb + 3 * i, picture_uncounted, 3);
    else picture_error_colour((double)result[i] - (double)report->reference[i], rgb + 3 * i);
  return rgb;
}

/* ---- shrinking --------------------------------------------------------------------------------------------------- */

static double to_linear(int code) {
  double c = code / 255.0;
  return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

static uint8_t to_code(double linear) {
  double c = linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
  return (uint8_t)lround(fmin(fmax(c, 0), 1) * 255);
}

/* How much of source pixel i lies under target pixel `to`, in source pixels. */
static double overlap(int i, double lo, double hi) { return fmin(hi, i + 1) - fmax(lo, i); }

/* rows: height lines of to_width. Sums one line into them. */
static void shrink_line(const uint8_t *line, int width, int to_width, const double linear[256], float *out) {
  double ratio = (double)width / to_width;
  for (int x = 0; x < to_width; x++) {
    double lo = x * ratio, hi = fmin((x + 1) * ratio, width), sum[3] = {0, 0, 0};
    for (int i = (int)lo; i < width && i < hi; i++)
      for (int c = 0; c < 3; c++) sum[c] += overlap(i, lo, hi) * linear[line[3 * i + c]];
    for (int c = 0; c < 3; c++) out[3 * x + c] = (float)(sum[c] / (hi - lo));
  }
}

uint8_t *picture_shrink(const uint8_t *rgb, int width, int height, int to_width, int to_height) {
  double linear[256], ratio = (double)height / to_height;
  for (int i = 0; i < 256; i++) linear[i] = to_linear(i);
  size_t line = 3 * (size_t)to_width;
  float *lines = malloc((size_t)height * line * sizeof *lines);
  uint8_t *out = malloc((size_t)to_height * line);
  if (!lines || !out) {
    free(lines);
    free(out);
    return NULL;
  }
  for (int y = 0; y < height; y++)
    shrink_line(rgb + 3 * (size_t)y * (size_t)width, width, to_width, linear, lines + (size_t)y * line);
  for (int y = 0; y < to_height; y++) {
    double lo = y * ratio, hi = fmin((y + 1) * ratio, height);
    for (size_t x = 0; x < line; x++) {
      double sum = 0;
      for (int i = (int)lo; i < height && i < hi; i++) sum += overlap(i, lo, hi) * (double)lines[(size_t)i * line + x];
      out[(size_t)y * line + x] = to_code(sum / (hi - lo));
    }
  }
  free(lines);
  return out;
}

/* ---- PNG --------------------------------------------------------------------------------------------------------- */

struct buffer {
  uint8_t *bytes;
  size_t size, room;
};

static cairo_status_t append(void *user, const unsigned char *bytes, unsigned count) {
  struct buffer *buffer = user;
  if (buffer->size + count > buffer->room) {
    size_t room = 2 * buffer->room + count + 4096;
    uint8_t *larger = realloc(buffer->bytes, room);
    if (!larger) return CAIRO_STATUS_NO_MEMORY;
    buffer->bytes = larger;
    buffer->room = room;
  }
  memcpy(buffer->bytes + buffer->size, bytes, count);
  buffer->size += count;
  return CAIRO_STATUS_SUCCESS;
}

int picture_surface_png(cairo_surface_t *surface, uint8_t **png, size_t *size) {
  struct buffer buffer = {NULL, 0, 0};
  if (cairo_surface_write_to_png_stream(surface, append, &buffer) != CAIRO_STATUS_SUCCESS) {
    free(buffer.bytes);
    return 0;
  }
  *png = buffer.bytes;
  *size = buffer.size;
  return 1;
}

void picture_copy(cairo_surface_t *surface, int x, int y, const uint8_t *rgb, int width, int height) {
  cairo_surface_flush(surface);
  unsigned char *data = cairo_image_surface_get_data(surface);
  size_t stride = (size_t)cairo_image_surface_get_stride(surface);
  for (int row = 0; row < height; row++) {
    uint32_t *line = (uint32_t *)(void *)(data + (size_t)(y + row) * stride) + x;
    const uint8_t *source = rgb + 3 * (size_t)row * (size_t)width;
    for (int i = 0; i < width; i++)
      line[i] = (uint32_t)source[3 * i] << 16 | (uint32_t)source[3 * i + 1] << 8 | source[3 * i + 2];
  }
  cairo_surface_mark_dirty(surface);
}

int picture_png(const uint8_t *rgb, int width, int height, uint8_t **png, size_t *size) {
  cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
  int written = 0;
  if (cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS) {
    picture_copy(surface, 0, 0, rgb, width, height);
    written = picture_surface_png(surface, png, size);
  }
  cairo_surface_destroy(surface);
  return written;
}
