#include "exr_channel.h"

#include <string.h>

#include <openexr.h>

/* Where the chunk that begins at row y puts the channel. */
static bool aim(exr_decode_pipeline_t *pipeline, const char *channel, int width, float *rows) {
  bool found = false;
  for (int c = 0; c < pipeline->channel_count; c++) {
    exr_coding_channel_info_t *info = &pipeline->channels[c];
    info->decode_to_ptr = NULL;
    if (strcmp(info->channel_name, channel) != 0) continue;
    found = true;
    info->user_bytes_per_element = 4;
    info->user_data_type = EXR_PIXEL_FLOAT;
    info->user_pixel_stride = sizeof(float);
    info->user_line_stride = width * (int)sizeof(float);
    info->decode_to_ptr = (uint8_t *)rows;
  }
  return found;
}

bool exr_channel_read(const char *path, const char *channel, int width, int height, float *out) {
  exr_context_t context = NULL;
  if (exr_start_read(&context, path, NULL) != 0) return false;
  int rows = 0;
  bool good = exr_get_scanlines_per_chunk(context, 0, &rows) == 0 && rows > 0;
  exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
  for (int y = 0; y < height && good; y += rows) {
    exr_chunk_info_t chunk;
    good = exr_read_scanline_chunk_info(context, 0, y, &chunk) == 0 &&
           (y ? exr_decoding_update(context, 0, &chunk, &pipeline)
              : exr_decoding_initialize(context, 0, &chunk, &pipeline)) == 0 &&
           aim(&pipeline, channel, width, out + (size_t)y * (size_t)width) &&
           (y || exr_decoding_choose_default_routines(context, 0, &pipeline) == 0) &&
           exr_decoding_run(context, 0, &pipeline) == 0;
  }
  exr_decoding_destroy(context, &pipeline);
  exr_finish(&context);
  return good;
}
