#include "image_file.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <openexr.h>

static exr_result_t read_chunk(exr_context_t file, exr_decode_pipeline_t *pipe, int *started, const char *channel,
                               int top, int width, int height, int y, float *out) {
  exr_chunk_info_t chunk;
  exr_result_t result = exr_read_scanline_chunk_info(file, 0, y + top, &chunk);
  if (result) return result;
  result = *started ? exr_decoding_update(file, 0, &chunk, pipe) : exr_decoding_initialize(file, 0, &chunk, pipe);
  for (int c = 0; !result && c < pipe->channel_count; c++) {
    exr_coding_channel_info_t *info = &pipe->channels[c];
    info->decode_to_ptr = NULL;
    if (strcmp(info->channel_name, channel) != 0) continue;
    info->user_bytes_per_element = 4;
    info->user_data_type = EXR_PIXEL_FLOAT;
    info->user_pixel_stride = 4;
    /* Rows go upwards here, downwards in the file. */
    info->user_line_stride = -4 * width;
    info->decode_to_ptr = (uint8_t *)(out + (size_t)(height - 1 - y) * (size_t)width);
  }
  if (!result && !*started) result = exr_decoding_choose_default_routines(file, 0, pipe);
  *started = 1;
  return result ? result : exr_decoding_run(file, 0, pipe);
}

float *exr_channel(const char *path, const char *channel, int *width, int *height) {
  exr_context_t file = NULL;
  exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
  exr_attr_box2i_t window;
  int32_t lines = 1;
  float *out = NULL;
  exr_result_t result = exr_start_read(&file, path, &options);
  if (!result) result = exr_get_data_window(file, 0, &window);
  if (!result) result = exr_get_scanlines_per_chunk(file, 0, &lines);
  if (!result) {
    *width = window.max.x - window.min.x + 1;
    *height = window.max.y - window.min.y + 1;
    out = calloc((size_t)*width * (size_t)*height, sizeof *out);
    exr_decode_pipeline_t pipe = EXR_DECODE_PIPELINE_INITIALIZER;
    int started = 0;
    for (int y = 0; out && !result && y < *height; y += lines) {
      result = read_chunk(file, &pipe, &started, channel, window.min.y, *width, *height, y, out);
    }
    exr_decoding_destroy(file, &pipe);
  }
  exr_finish(&file);
  if (!result && out) return out;
  fprintf(stderr, "%s: cannot be read: %s\n", path, exr_get_default_error_message(result));
  free(out);
  return NULL;
}

unsigned char *ppm_pixels(const char *path, int *width, int *height) {
  FILE *file = fopen(path, "rb");
  unsigned char *out = NULL;
  if (!file) return NULL;
  if (fscanf(file, "P6 %d %d 255", width, height) == 2 && fgetc(file) != EOF && *width > 0 && *height > 0) {
    size_t bytes = 3 * (size_t)*width * (size_t)*height;
    out = malloc(bytes);
    if (out && fread(out, 1, bytes, file) != bytes) {
      free(out);
      out = NULL;
    }
  }
  fclose(file);
  return out;
}
