/* Meshes: checking what the host describes, dropping what has no area, bounds, buffers. */
#include "casters/mesh.h"

#include <math.h>
#include <string.h>

#include "gl/host.h"
#include "gl/inspect.h"
#include "space/rounding.h"

/* ---- checks ------------------------------------------------------------------------------------------------------ */

static bool span_given(const pn_span *span) { return span->buffer || span->data; }

/* Whether the host's buffer is as large as the span says. */
static bool span_inside(pni_gpu *gpu, const pn_span *span, size_t element) {
  size_t stride = span->stride ? span->stride : element;
  if (!span->buffer || span->count == 0) return true;
  return pni_buffer_size(gpu, span->buffer) >= span->offset + (span->count - 1) * stride + element;
}

/* A span that can be read: one source, elements that fit their stride. */
static bool span_sound(pni_gpu *gpu, const pn_span *span, size_t element) {
  if (!span->buffer == !span->data) return false;
  if (span->buffer && !pni_buffer_exists(gpu, span->buffer)) return false;
  if (span->stride && span->stride < element) return false;
  return span->count <= (size_t)1 << 31 && span->offset <= (size_t)1 << 40 && span->stride <= (size_t)1 << 20 &&
         span_inside(gpu, span, element);
}

static pn_result check_indices(pni_gpu *gpu, const pn_mesh_desc *d) {
  size_t drawn = d->index_bytes ? d->indices.count : d->positions.count;
  bool size = d->index_bytes == 0 || d->index_bytes == 2 || d->index_bytes == 4;
  if (!size || (d->index_bytes && (!span_sound(gpu, &d->indices, (size_t)d->index_bytes) || d->indices.count == 0)))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_INDICES, "indices: index_bytes 0, 2 or 4, and one source");
  if (!d->index_bytes && span_given(&d->indices))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_INDICES, "indices are given but index_bytes is 0");
  if (d->index_bytes && d->indices.buffer && d->indices.stride && d->indices.stride != (size_t)d->index_bytes)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_INDICES, "indices in a GL buffer must be tightly packed");
  if (drawn % 3)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_INDICES, "%zu is not a number of triangles times three",
                    drawn);
  return PN_OK;
}

static pn_result check_alpha(pni_gpu *gpu, const pn_mesh_desc *d) {
  if (!d->alpha_texture && !span_given(&d->texcoords)) return PN_OK;
  if (!d->alpha_texture || !span_sound(gpu, &d->texcoords, 8) || d->texcoords.count < d->positions.count)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_TEXCOORDS,
                    "an alpha texture and two floats for each position come together");
  if (!pni_texture_is_2d(gpu, d->alpha_texture) || d->alpha_channel < 0 || d->alpha_channel > 3 ||
      !(d->alpha_cutoff >= 0) || !(d->alpha_cutoff <= 1))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_ALPHA, "alpha: a texture, channel 0..3, cutoff in [0, 1]");
  return PN_OK;
}

static bool equal3(const float a[3], const float b[3]) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

bool pni_box_sound(const float min[3], const float max[3]) {
  for (int i = 0; i < 3; i++)
    if (!isfinite(min[i]) || !isfinite(max[i]) || min[i] > max[i]) return false;
  return true;
}

pn_result pni_mesh_check(pni_gpu *gpu, const pn_mesh_desc *d) {
  if (d->positions.count == 0 || !span_sound(gpu, &d->positions, 12))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_POSITIONS,
                    "positions: either a GL buffer or memory, three floats each, at least one triangle");
  pn_result result = check_indices(gpu, d);
  if (result == PN_OK) result = check_alpha(gpu, d);
  if (result != PN_OK) return result;
  if (!pni_box_sound(d->bounds_min, d->bounds_max))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_BOUNDS, "bounds are inverted or not finite");
  if (d->positions.buffer && equal3(d->bounds_min, d->bounds_max))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_BOUNDS, "positions in a GL buffer need bounds");
  return PN_OK;
}

/* ---- reading spans ----------------------------------------------------------------------------------------------- */

static const char *span_at(const pn_span *span, size_t element, size_t index) {
  return (const char *)span->data + span->offset + index * (span->stride ? span->stride : element);
}

static void position_at(const pn_span *span, size_t index, float out[3]) { memcpy(out, span_at(span, 12, index), 12); }

static pn_result copy_indices(pni_gpu *gpu, const pn_mesh_desc *d, uint32_t *out) {
  size_t count = d->index_bytes ? d->indices.count : d->positions.count;
  for (size_t i = 0; i < count; i++) {
    out[i] = (uint32_t)i;
    if (d->index_bytes == 4) memcpy(&out[i], span_at(&d->indices, 4, i), 4);
    if (d->index_bytes == 2) {
      uint16_t narrow;
      memcpy(&narrow, span_at(&d->indices, 2, i), 2);
      out[i] = narrow;
    }
    if (out[i] >= d->positions.count)
      return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_INDICES, "index %u, but there are %zu positions", out[i],
                      d->positions.count);
  }
  return PN_OK;
}

/* ---- triangles and boxes ----------------------------------------------------------------------------------------- */

static bool has_area(float p[3][3]) {
  double a[3], b[3];
  for (int i = 0; i < 3; i++) {
    if (!isfinite(p[0][i]) || !isfinite(p[1][i]) || !isfinite(p[2][i])) return false;
    a[i] = (double)p[1][i] - p[0][i];
    b[i] = (double)p[2][i] - p[0][i];
  }
  return a[1] * b[2] != a[2] * b[1] || a[2] * b[0] != a[0] * b[2] || a[0] * b[1] != a[1] * b[0];
}

static void box_start(pni_box *box) {
  for (int i = 0; i < 3; i++) {
    box->min[i] = INFINITY;
    box->max[i] = -INFINITY;
  }
}

static void box_add(pni_box *box, const float p[3]) {
  for (int i = 0; i < 3; i++) {
    box->min[i] = fminf(box->min[i], p[i]);
    box->max[i] = fmaxf(box->max[i], p[i]);
  }
}

static size_t run_length(size_t triangles) {
  size_t run = (triangles + PNI_BOXES_MAX - 1) / PNI_BOXES_MAX;
  return run > PNI_BOX_TRIANGLES ? run : PNI_BOX_TRIANGLES;
}

/* Keeps the triangles that have area, in order, and boxes over runs of them. */
static size_t filter_triangles(pni_mesh_data *mesh, const pn_span *positions, uint32_t *kept) {
  size_t total = mesh->kept_count / 3, run = run_length(total), count = 0;
  mesh->box_count = 0;
  mesh->box_triangles = run;
  for (size_t t = 0; t < total; t++) {
    const uint32_t *index = mesh->kept_indices + 3 * t;
    float p[3][3];
    for (int c = 0; c < 3; c++) position_at(positions, index[c], p[c]);
    if (!has_area(p)) continue;
    if (count % run == 0) box_start(&mesh->boxes[mesh->box_count++]);
    for (int c = 0; c < 3; c++) box_add(&mesh->boxes[mesh->box_count - 1], p[c]);
    memcpy(kept + 3 * count, index, 12);
    count++;
  }
  return count;
}

/* Positions in memory, indices in the host's buffer: boxes over runs of vertices. */
static void box_vertices(pni_mesh_data *mesh, const pn_span *positions) {
  size_t run = run_length(positions->count);
  mesh->box_count = 0;
  mesh->box_triangles = 0;
  for (size_t i = 0; i < positions->count; i++) {
    float p[3];
    position_at(positions, i, p);
    if (i % run == 0) box_start(&mesh->boxes[mesh->box_count++]);
    if (isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])) box_add(&mesh->boxes[mesh->box_count - 1], p);
  }
  int used = 0;
  for (int i = 0; i < mesh->box_count; i++)
    if (mesh->boxes[i].min[0] <= mesh->boxes[i].max[0]) mesh->boxes[used++] = mesh->boxes[i];
  mesh->box_count = used;
}

/* Around all boxes. */
static void box_whole(pni_mesh_data *mesh) {
  box_start(&mesh->whole);
  for (int i = 0; i < mesh->box_count; i++) {
    box_add(&mesh->whole, mesh->boxes[i].min);
    box_add(&mesh->whole, mesh->boxes[i].max);
  }
}

/* The float product that places the mesh then works with numbers as small as the mesh. */
static void find_center(pni_mesh_data *mesh) {
  for (int i = 0; i < 3; i++)
    mesh->center[i] = mesh->box_count > 0 ? pni_far_middle(mesh->whole.min[i], mesh->whole.max[i]) : 0;
}

/* ---- buffers ----------------------------------------------------------------------------------------------------- */

/* The span's elements tightly packed into a buffer of ours. */
static pn_result upload_span(pni_gpu *gpu, pni_buffer *to, const char *label, const pn_span *span, size_t element) {
  size_t bytes = span->count * element;
  if (!span->stride || span->stride == element)
    return pni_buffer_fill(gpu, to, label, PNI_BUFFER_VERTICES, span_at(span, element, 0), bytes);
  char *packed = pni_reallocate(gpu, NULL, bytes);
  if (!packed) return PN_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < span->count; i++) memcpy(packed + i * element, span_at(span, element, i), element);
  pn_result result = pni_buffer_fill(gpu, to, label, PNI_BUFFER_VERTICES, packed, bytes);
  pni_free(gpu, packed);
  return result;
}

/* Positions as the mesh keeps them. */
static pn_result upload_centered(pni_gpu *gpu, pni_mesh_data *mesh, const pn_span *span) {
  static const char label[] = "mesh positions";
  const double *c = mesh->center;
  if (c[0] == 0 && c[1] == 0 && c[2] == 0) return upload_span(gpu, &mesh->own_positions, label, span, 12);
  float *packed = pni_reallocate(gpu, NULL, span->count * 12);
  if (!packed) return PN_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < span->count; i++) {
    float *p = packed + 3 * i;
    position_at(span, i, p);
    for (int k = 0; k < 3; k++) p[k] = (float)(p[k] - c[k]);
  }
  pn_result result = pni_buffer_fill(gpu, &mesh->own_positions, label, PNI_BUFFER_VERTICES, packed, span->count * 12);
  pni_free(gpu, packed);
  return result;
}

static void point_attribute(pni_gpu *gpu, const pni_mesh_data *mesh, int index, int floats, const pn_span *span,
                            const pni_buffer *own) {
  size_t packed = (size_t)floats * sizeof(float);
  size_t offset = own->id ? 0 : span->offset;
  size_t stride = own->id || !span->stride ? packed : span->stride;
  pni_vertices_attribute(gpu, &mesh->vertices, index, floats, own->id ? own->id : span->buffer, offset, stride);
}

static pn_result upload_positions(pni_gpu *gpu, pni_mesh_data *mesh, const pn_mesh_desc *d) {
  if (d->positions.data) {
    find_center(mesh);
    pn_result result = upload_centered(gpu, mesh, &d->positions);
    if (result != PN_OK) return result;
  }
  point_attribute(gpu, mesh, 0, 3, &d->positions, &mesh->own_positions);
  if (!d->alpha_texture) return PN_OK;
  if (d->texcoords.data) {
    pn_result result = upload_span(gpu, &mesh->own_texcoords, "mesh texture coordinates", &d->texcoords, 8);
    if (result != PN_OK) return result;
  }
  point_attribute(gpu, mesh, 1, 2, &d->texcoords, &mesh->own_texcoords);
  return PN_OK;
}

static pn_result upload_indices(pni_gpu *gpu, pni_mesh_data *mesh, const uint32_t *indices, size_t count) {
  pn_result result =
      pni_buffer_fill(gpu, &mesh->own_indices, "mesh indices", PNI_BUFFER_INDICES, indices, count * sizeof *indices);
  if (result == PN_OK) pni_vertices_indices(gpu, &mesh->vertices, mesh->own_indices.id);
  return result;
}

/* Filters the kept triangles against positions, and uploads what is left. */
static pn_result upload_triangles(pni_gpu *gpu, pni_mesh_data *mesh, const pn_span *positions) {
  uint32_t *kept = pni_reallocate(gpu, NULL, mesh->kept_count * sizeof *kept);
  if (!kept) return PN_ERROR_OUT_OF_MEMORY;
  size_t count = filter_triangles(mesh, positions, kept), total = mesh->kept_count / 3;
  pn_result result = PN_OK;
  if (count > 0) result = upload_indices(gpu, mesh, kept, 3 * count);
  pni_free(gpu, kept);
  if (result != PN_OK) return result;
  mesh->draw_count = 3 * count;
  mesh->index_bytes = 4;
  if (count < total)
    pni_note(gpu, PN_LOG_WARNING, PN_MESSAGE_MESH_DROPPED, "%zu of %zu triangles dropped: without area, or not finite",
             total - count, total);
  return PN_OK;
}

static pn_result take_triangles(pni_gpu *gpu, pni_mesh_data *mesh, const pn_mesh_desc *d) {
  mesh->kept_count = d->index_bytes ? d->indices.count : d->positions.count;
  mesh->kept_indices = pni_reallocate(gpu, NULL, mesh->kept_count * sizeof *mesh->kept_indices);
  if (!mesh->kept_indices) return PN_ERROR_OUT_OF_MEMORY;
  pn_result result = copy_indices(gpu, d, mesh->kept_indices);
  return result == PN_OK ? upload_triangles(gpu, mesh, &d->positions) : result;
}

static pn_result bind_host_indices(pni_gpu *gpu, pni_mesh_data *mesh, const pn_mesh_desc *d) {
  mesh->index_bytes = d->index_bytes;
  mesh->draw_count = d->index_bytes ? d->indices.count : d->positions.count;
  if (!d->index_bytes) return PN_OK;
  if (!d->indices.data) {
    pni_vertices_indices(gpu, &mesh->vertices, d->indices.buffer);
    return PN_OK;
  }
  /* positions in a GL buffer: their values are unknown, only the count can be checked */
  uint32_t *wide = pni_reallocate(gpu, NULL, d->indices.count * sizeof *wide);
  if (!wide) return PN_ERROR_OUT_OF_MEMORY;
  pn_result result = copy_indices(gpu, d, wide);
  if (result == PN_OK) result = upload_indices(gpu, mesh, wide, d->indices.count);
  pni_free(gpu, wide);
  mesh->index_bytes = 4;
  return result;
}

static void describe(pni_mesh_data *mesh, const pn_mesh_desc *d) {
  mesh->positions = d->positions;
  mesh->indices = d->indices;
  mesh->texcoords = d->texcoords;
  mesh->positions.data = mesh->indices.data = mesh->texcoords.data = NULL;
  mesh->alpha_texture = d->alpha_texture;
  mesh->alpha_channel = d->alpha_channel;
  mesh->alpha_cutoff = d->alpha_cutoff > 0 ? d->alpha_cutoff : 0.5f;
  mesh->clockwise = d->clockwise != 0;
}

static void given_box(pni_mesh_data *mesh, const float min[3], const float max[3]) {
  memcpy(mesh->boxes[0].min, min, 12);
  memcpy(mesh->boxes[0].max, max, 12);
  mesh->box_count = 1;
  mesh->box_triangles = 0;
  box_whole(mesh);
}

pn_result pni_mesh_build(pni_gpu *gpu, const pn_mesh_desc *d, pni_mesh_data *mesh) {
  memset(mesh, 0, sizeof *mesh);
  describe(mesh, d);
  bool boxed = !equal3(d->bounds_min, d->bounds_max);
  mesh->boxes = pni_reallocate(gpu, NULL, (PNI_BOXES_MAX + 1) * sizeof *mesh->boxes);
  if (!mesh->boxes) return PN_ERROR_OUT_OF_MEMORY;
  pni_vertices_make(gpu, &mesh->vertices);
  bool in_memory = d->positions.data && !d->indices.buffer;
  pn_result result = in_memory ? take_triangles(gpu, mesh, d) : bind_host_indices(gpu, mesh, d);
  if (result == PN_OK && d->positions.data && !in_memory) box_vertices(mesh, &d->positions);
  box_whole(mesh);
  if (result == PN_OK) result = upload_positions(gpu, mesh, d);
  if (result == PN_OK && boxed) given_box(mesh, d->bounds_min, d->bounds_max);
  if (result != PN_OK) pni_mesh_drop(gpu, mesh, false);
  return result;
}

pn_result pni_mesh_deform(pni_gpu *gpu, pni_mesh_data *mesh, const pn_span *positions, const float *bounds) {
  pn_result result = PN_OK;
  if (positions) {
    if (mesh->kept_indices) result = upload_triangles(gpu, mesh, positions);
    else box_vertices(mesh, positions);
    box_whole(mesh);
    find_center(mesh);
    if (result == PN_OK) result = upload_centered(gpu, mesh, positions);
  }
  if (result == PN_OK && bounds) given_box(mesh, bounds, bounds + 3);
  mesh->pose++;
  return result;
}

void pni_mesh_drop(pni_gpu *gpu, pni_mesh_data *mesh, bool abandon) {
  pni_kept_free(gpu, &mesh->kept, abandon);
  pni_vertices_free(gpu, &mesh->vertices, abandon);
  pni_buffer_free(gpu, &mesh->own_positions, abandon);
  pni_buffer_free(gpu, &mesh->own_indices, abandon);
  pni_buffer_free(gpu, &mesh->own_texcoords, abandon);
  pni_free(gpu, mesh->kept_indices);
  pni_free(gpu, mesh->boxes);
  memset(mesh, 0, sizeof *mesh);
}
