#define _GNU_SOURCE
#include <errno.h>
#include <openexr.h>
#include <string.h>
#include <unistd.h>

#include "base/message.h"
#include "files/image.h"
#include "files/output.h"

/* The core library writes through this, so that the file is the temporary one of output.h. */
static int64_t write_at(exr_const_context_t context, void *user, const void *bytes, uint64_t size, uint64_t offset,
                        exr_stream_error_func_ptr_t error) {
  const struct output *output = user;
  (void)error;
  (void)context;
  uint64_t done = 0;
  while (done < size) {
    ssize_t n = pwrite(fileno(output->file), (const char *)bytes + done, size - done, (off_t)(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return -1;
    done += (uint64_t)n;
  }
  return (int64_t)size;
}

/* Failures are reported by this file, in the program's own words. */
static void silent(exr_const_context_t context, exr_result_t code, const char *text) {
  (void)context;
  (void)code;
  (void)text;
}

static exr_result_t write_header(exr_context_t context, int width, int height, const struct exr_plane *planes,
                                 int count) {
  int part = 0;
  exr_result_t r = exr_add_part(context, "penumbra", EXR_STORAGE_SCANLINE, &part);
  if (!r) r = exr_initialize_required_attr_simple(context, part, width, height, EXR_COMPRESSION_ZIP);
  for (int i = 0; i < count && !r; i++)
    r = exr_add_channel(context, part, planes[i].name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
  return r ? r : exr_write_header(context);
}

/* Points the pipeline's channels at the rows of this chunk. */
static void set_channels(exr_encode_pipeline_t *pipeline, int first_row, int width, const struct exr_plane *planes,
                         int count) {
  for (int c = 0; c < pipeline->channel_count; c++) {
    exr_coding_channel_info_t *channel = &pipeline->channels[c];
    for (int i = 0; i < count; i++) {
      if (strcmp(planes[i].name, channel->channel_name) != 0) continue;
      int stride = planes[i].stride;
      channel->encode_from_ptr =
          (const uint8_t *)(planes[i].first + (size_t)first_row * (size_t)width * (size_t)stride);
      channel->user_pixel_stride = stride * 4;
      channel->user_line_stride = stride * 4 * width;
      channel->user_bytes_per_element = 4;
      channel->user_data_type = EXR_PIXEL_FLOAT;
    }
  }
}

/* Readers take a chunk that is as long as its pixels for one that is not packed; the library packs it all the same
 * where packing neither saves nor costs a byte. */
static exr_result_t (*pack)(exr_encode_pipeline_t *);
static exr_result_t pack_or_leave(exr_encode_pipeline_t *pipeline) {
  exr_result_t r = pack(pipeline);
  if (!r && pipeline->compressed_bytes == pipeline->packed_bytes)
    memcpy(pipeline->compressed_buffer, pipeline->packed_buffer, (size_t)pipeline->packed_bytes);
  return r;
}

static exr_result_t choose_routines(exr_const_context_t context, exr_encode_pipeline_t *pipeline) {
  exr_result_t r = exr_encoding_choose_default_routines(context, 0, pipeline);
  if (r || !pipeline->compress_fn) return r;
  pack = pipeline->compress_fn; /* the same function each time */
  pipeline->compress_fn = pack_or_leave;
  return r;
}

static exr_result_t write_rows(exr_context_t context, int width, int height, const struct exr_plane *planes,
                               int count) {
  exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
  int32_t chunk_rows = 0;
  exr_result_t r = exr_get_scanlines_per_chunk(context, 0, &chunk_rows);
  for (int row = 0; row < height && !r; row += chunk_rows) {
    exr_chunk_info_t chunk;
    r = exr_write_scanline_chunk_info(context, 0, row, &chunk);
    if (r) break;
    r = row == 0 ? exr_encoding_initialize(context, 0, &chunk, &pipeline)
                 : exr_encoding_update(context, 0, &chunk, &pipeline);
    if (r) break;
    set_channels(&pipeline, row, width, planes, count);
    if (row == 0) r = choose_routines(context, &pipeline);
    if (!r) r = exr_encoding_run(context, 0, &pipeline);
  }
  exr_encoding_destroy(context, &pipeline);
  return r;
}

int exr_write(const char *path, int width, int height, const struct exr_plane *planes, int plane_count) {
  struct output output;
  int status = output_open(&output, path);
  if (status) return status;
  exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
  setup.user_data = &output;
  setup.write_fn = write_at;
  setup.error_handler_fn = silent;
  exr_context_t context = NULL;
  errno = 0;
  exr_result_t r = exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &setup);
  if (!r) r = write_header(context, width, height, planes, plane_count);
  if (!r) r = write_rows(context, width, height, planes, plane_count);
  int saved = errno;
  exr_result_t finished = context ? exr_finish(&context) : EXR_ERR_SUCCESS;
  if (!r) {
    r = finished;
    saved = errno;
  }
  errno = saved;
  if (r) return output_fail(&output, errno ? NULL : exr_get_error_code_as_string(r));
  return output_commit(&output);
}
