/* Meshes: checking what the host describes, dropping what has no area, bounds, buffers. */
#include "casters/mesh.h"

#include <math.h>
#include <string.h>

#include "gl/host.h"
#include "gl/host_texture.h"
#include "gl/inspect.h"
#include "space/rounding.h"

/* ---- checks ------------------------------------------------------------------------------------------------------ */

static bool span_given(const pn_span *span) { return span->buffer || span->data; }

typedef struct {
  const char *name;
  pn_message message;
  size_t element; /* bytes of one */
} span_kind;

static const span_kind positions_kind = {"positions", PN_MESSAGE_MESH_POSITIONS, 12};
static const span_kind texcoords_kind = {"texture coordinates", PN_MESSAGE_MESH_TEXCOORDS, 8};

/* Whether the host's buffer is as large as the span says. */
static pn_result check_inside(pni_gpu *gpu, const pn_span *span, const span_kind *kind) {
  size_t stride = span->stride ? span->stride : kind->element;
  size_t needed = span->offset + (span->count - 1) * stride + kind->element;
  size_t size = pni_buffer_size(gpu, span->buffer);
  if (size >= needed) return PN_OK;
  return pni_fail(gpu, PN_ERROR_ARGUMENT, kind->message,
                  "%s: buffer %u has %zu bytes, and %zu of %zu bytes every %zu, from byte %zu on, need %zu", kind->name,
                  span->buffer, size, span->count, kind->element, stride, span->offset, needed);
}

/* A span that can be read: one source, elements that fit their stride. */
static pn_result check_span(pni_gpu *gpu, const pn_span *span, const span_kind *kind) {
  if (!span->buffer == !span->data)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, kind->message, "%s: %s", kind->name,
                    span->data ? "buffer and data are both set" : "neither buffer nor data is set");
  if (span->count == 0) return pni_fail(gpu, PN_ERROR_ARGUMENT, kind->message, "%s: their count is 0", kind->name);
  if (span->buffer && !pni_buffer_exists(gpu, span->buffer))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, kind->message, "%s: there is no buffer %u", kind->name, span->buffer);
  if (span->stride && span->stride < kind->element)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, kind->message, "%s: a stride of %zu bytes is less than one's %zu",
                    kind->name, span->stride, kind->element);
  if (span->count > (size_t)1 << 31 || span->offset > (size_t)1 << 40 || span->stride > (size_t)1 << 20)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, kind->message,
                    "%s: count %zu, offset %zu or stride %zu is beyond 2^31, 2^40, 2^20", kind->name, span->count,
                    span->offset, span->stride);
  return span->buffer ? check_inside(gpu, span, kind) : PN_OK;
}

static pn_result check_indices(pni_gpu *gpu, const pn_mesh_desc *d) {
  size_t drawn = d->index_bytes ? d->indices.count : d->positions.count;
  span_kind kind = {"indices", PN_MESSAGE_MESH_INDICES, (size_t)d->index_bytes};
  if (d->index_bytes != 0 && d->index_bytes != 2 && d->index_bytes != 4)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_INDICES, "index_bytes %d is not 0, 2 or 4", d->index_bytes);
  if (!d->index_bytes && span_given(&d->indices))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_INDICES, "indices are given but index_bytes is 0");
  pn_result result = d->index_bytes ? check_span(gpu, &d->indices, &kind) : PN_OK;
  if (result != PN_OK) return result;
  if (d->index_bytes && d->indices.buffer && d->indices.stride && d->indices.stride != (size_t)d->index_bytes)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_INDICES, "indices in a GL buffer must be tightly packed");
  if (drawn % 3)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_INDICES, "%zu is not a number of triangles times three",
                    drawn);
  return PN_OK;
}

static pn_result check_alpha(pni_gpu *gpu, const pn_mesh_desc *d) {
  if (!d->alpha_texture && !span_given(&d->texcoords)) return PN_OK;
  if (!d->alpha_texture)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_TEXCOORDS, "texture coordinates without an alpha texture");
  if (!span_given(&d->texcoords))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_TEXCOORDS, "an alpha texture without texture coordinates");
  pn_result result = check_span(gpu, &d->texcoords, &texcoords_kind);
  if (result != PN_OK) return result;
  if (d->texcoords.count < d->positions.count)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_TEXCOORDS, "%zu texture coordinates for %zu positions",
                    d->texcoords.count, d->positions.count);
  if (d->alpha_channel < 0 || d->alpha_channel > 3)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_ALPHA, "alpha channel %d is not 0..3", d->alpha_channel);
  if (!(d->alpha_cutoff >= 0) || !(d->alpha_cutoff <= 1))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_ALPHA, "alpha cutoff %g is not in [0, 1]", d->alpha_cutoff);
  if (!pni_texture_exists(gpu, d->alpha_texture))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_ALPHA, "there is no texture %u", d->alpha_texture);
  if (!pni_texture_is_2d(gpu, d->alpha_texture) || pni_inspect_color(gpu, d->alpha_texture).channels == 0)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_ALPHA,
                    "alpha texture %u is no 2D texture with colours that are no integers", d->alpha_texture);
  return PN_OK;
}

static bool equal3(const float a[3], const float b[3]) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

bool pni_box_sound(const float min[3], const float max[3]) {
  for (int i = 0; i < 3; i++)
    if (!isfinite(min[i]) || !isfinite(max[i]) || min[i] > max[i]) return false;
  return true;
}

pn_result pni_mesh_check(pni_gpu *gpu, const pn_mesh_desc *d) {
  pn_result result = check_span(gpu, &d->positions, &positions_kind);
  if (result == PN_OK) result = check_indices(gpu, d);
  if (result == PN_OK) result = check_alpha(gpu, d);
  if (result != PN_OK) return result;
  if (!pni_box_sound(d->bounds_min, d->bounds_max))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_BOUNDS, "bounds are inverted or not finite");
  if (d->positions.buffer && equal3(d->bounds_min, d->bounds_max))
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_BOUNDS, "positions in a GL buffer need bounds");
  return PN_OK;
}

pn_result pni_mesh_check_moved(pni_gpu *gpu, const pni_mesh_data *mesh, const pn_span *positions) {
  if (mesh->positions.buffer)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_POSITIONS,
                    "new positions of a mesh whose own are in a GL buffer: NULL says that its contents changed");
  if (positions->buffer)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_POSITIONS, "new positions must be in memory");
  if (positions->count != mesh->positions.count)
    return pni_fail(gpu, PN_ERROR_ARGUMENT, PN_MESSAGE_MESH_POSITIONS, "%zu new positions of a mesh that has %zu",
                    positions->count, mesh->positions.count);
  return check_span(gpu, positions, &positions_kind);
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

/* A mesh in one pose: the triangles that have area, in order, and boxes over runs of them. */
typedef struct {
  uint32_t *kept;
  size_t count; /* triangles */
  pni_box boxes[PNI_BOXES_MAX + 1];
  int box_count;
  pni_buffer indices; /* where they are as many as before there is none: the mesh's own holds them */
} posed;

static void filter_triangles(const pni_mesh_data *mesh, const pn_span *positions, posed *out) {
  size_t total = mesh->kept_count / 3, run = run_length(total);
  for (size_t t = 0; t < total; t++) {
    const uint32_t *index = mesh->kept_indices + 3 * t;
    float p[3][3];
    for (int c = 0; c < 3; c++) position_at(positions, index[c], p[c]);
    if (!has_area(p)) continue;
    if (out->count % run == 0) box_start(&out->boxes[out->box_count++]);
    for (int c = 0; c < 3; c++) box_add(&out->boxes[out->box_count - 1], p[c]);
    memcpy(out->kept + 3 * out->count, index, 12);
    out->count++;
  }
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

/* The span's elements tightly packed: *packed, to be freed, or the span's own memory. */
static pn_result pack_span(pni_gpu *gpu, const pn_span *span, size_t element, char **packed, const void **out) {
  *packed = NULL;
  *out = span_at(span, element, 0);
  if (!span->stride || span->stride == element) return PN_OK;
  *packed = pni_reallocate(gpu, NULL, span->count * element);
  if (!*packed) return PN_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < span->count; i++) memcpy(*packed + i * element, span_at(span, element, i), element);
  *out = *packed;
  return PN_OK;
}

static pn_result upload_span(pni_gpu *gpu, pni_buffer *to, const char *label, const pn_span *span, size_t element) {
  char *packed;
  const void *from;
  pn_result result = pack_span(gpu, span, element, &packed, &from);
  if (result == PN_OK) result = pni_buffer_fill(gpu, to, label, PNI_BUFFER_VERTICES, from, span->count * element);
  pni_free(gpu, packed);
  return result;
}

/* Positions as they come, packed, to those that the mesh keeps. */
static void center_positions(const pni_mesh_data *mesh, float *positions, size_t count) {
  for (int k = 0; k < 3; k++)
    for (size_t i = 0; i < count && mesh->center[k] != 0; i++)
      positions[3 * i + (size_t)k] = (float)(positions[3 * i + (size_t)k] - mesh->center[k]);
}

/* A copy, to be freed. */
static float *copy_positions(pni_gpu *gpu, const pn_span *span) {
  float *out = pni_reallocate(gpu, NULL, 12 * span->count);
  for (size_t i = 0; out && i < span->count; i++) position_at(span, i, out + 3 * i);
  return out;
}

static pn_result upload_centered(pni_gpu *gpu, pni_mesh_data *mesh, const pn_span *span) {
  static const char label[] = "mesh positions";
  const double *c = mesh->center;
  if (c[0] == 0 && c[1] == 0 && c[2] == 0) return upload_span(gpu, &mesh->own_positions, label, span, 12);
  float *kept = copy_positions(gpu, span);
  if (!kept) return PN_ERROR_OUT_OF_MEMORY;
  center_positions(mesh, kept, span->count);
  pn_result result = pni_buffer_fill(gpu, &mesh->own_positions, label, PNI_BUFFER_VERTICES, kept, 12 * span->count);
  pni_free(gpu, kept);
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

static pn_result upload_indices(pni_gpu *gpu, pni_buffer *to, const uint32_t *indices, size_t count) {
  return pni_buffer_fill(gpu, to, "mesh indices", PNI_BUFFER_INDICES, indices, count * sizeof *indices);
}

/* What can fail of a pose, beside the mesh. */
static pn_result make_pose(pni_gpu *gpu, const pni_mesh_data *mesh, const pn_span *positions, posed *out) {
  out->count = 0;
  out->box_count = 0;
  out->indices = (pni_buffer){0};
  out->kept = pni_reallocate(gpu, NULL, mesh->kept_count * sizeof *out->kept);
  if (!out->kept) return PN_ERROR_OUT_OF_MEMORY;
  filter_triangles(mesh, positions, out);
  size_t bytes = 3 * out->count * sizeof *out->kept;
  if (out->count == 0 || bytes == mesh->own_indices.bytes) return PN_OK;
  pn_result result = upload_indices(gpu, &out->indices, out->kept, 3 * out->count);
  if (result != PN_OK) {
    pni_buffer_free(gpu, &out->indices, false);
    pni_free(gpu, out->kept);
  }
  return result;
}

static void take_pose(pni_gpu *gpu, pni_mesh_data *mesh, posed *pose) {
  size_t total = mesh->kept_count / 3;
  if (pose->indices.id) {
    pni_buffer_free(gpu, &mesh->own_indices, false);
    mesh->own_indices = pose->indices;
    pni_vertices_indices(gpu, &mesh->vertices, mesh->own_indices.id);
  } else if (pose->count > 0) {
    upload_indices(gpu, &mesh->own_indices, pose->kept, 3 * pose->count);
  }
  pni_free(gpu, pose->kept);
  memcpy(mesh->boxes, pose->boxes, (size_t)pose->box_count * sizeof *mesh->boxes);
  mesh->box_count = pose->box_count;
  mesh->box_triangles = run_length(total);
  mesh->draw_count = 3 * pose->count;
  mesh->index_bytes = 4;
  if (pose->count < total)
    pni_note(gpu, PN_LOG_WARNING, PN_MESSAGE_MESH_DROPPED, "%zu of %zu triangles dropped: without area, or not finite",
             total - pose->count, total);
}

static pn_result take_triangles(pni_gpu *gpu, pni_mesh_data *mesh, const pn_mesh_desc *d) {
  mesh->kept_count = d->index_bytes ? d->indices.count : d->positions.count;
  mesh->kept_indices = pni_reallocate(gpu, NULL, mesh->kept_count * sizeof *mesh->kept_indices);
  if (!mesh->kept_indices) return PN_ERROR_OUT_OF_MEMORY;
  posed pose;
  pn_result result = copy_indices(gpu, d, mesh->kept_indices);
  if (result == PN_OK) result = make_pose(gpu, mesh, &d->positions, &pose);
  if (result == PN_OK) take_pose(gpu, mesh, &pose);
  return result;
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
  if (result == PN_OK) result = upload_indices(gpu, &mesh->own_indices, wide, d->indices.count);
  if (result == PN_OK) pni_vertices_indices(gpu, &mesh->vertices, mesh->own_indices.id);
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

/* Under GL's own default a texture without mipmaps would be read as black. */
static void look_at_alpha(pni_gpu *gpu, pni_mesh_data *mesh) {
  if (mesh->alpha_texture) mesh->alpha_complete = pni_host_texture_complete(gpu, mesh->alpha_texture);
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
  look_at_alpha(gpu, mesh);
  bool in_memory = d->positions.data && !d->indices.buffer;
  pn_result result = in_memory ? take_triangles(gpu, mesh, d) : bind_host_indices(gpu, mesh, d);
  if (result == PN_OK && d->positions.data && !in_memory) box_vertices(mesh, &d->positions);
  box_whole(mesh);
  if (result == PN_OK) result = upload_positions(gpu, mesh, d);
  if (result == PN_OK && boxed) given_box(mesh, d->bounds_min, d->bounds_max);
  if (result != PN_OK) pni_mesh_drop(gpu, mesh, false);
  return result;
}

/* As many positions as before: the buffer that holds them is large enough, and filling it cannot fail. */
static pn_result move_positions(pni_gpu *gpu, pni_mesh_data *mesh, const pn_span *positions) {
  posed pose;
  bool triangles = mesh->kept_indices != NULL;
  float *kept = copy_positions(gpu, positions);
  pn_result result = kept ? PN_OK : PN_ERROR_OUT_OF_MEMORY;
  if (result == PN_OK && triangles) result = make_pose(gpu, mesh, positions, &pose);
  if (result == PN_OK) {
    if (triangles) take_pose(gpu, mesh, &pose);
    else box_vertices(mesh, positions);
    box_whole(mesh);
    find_center(mesh);
    center_positions(mesh, kept, positions->count);
    pni_buffer_fill(gpu, &mesh->own_positions, "mesh positions", PNI_BUFFER_VERTICES, kept, 12 * positions->count);
  }
  pni_free(gpu, kept);
  return result;
}

pn_result pni_mesh_deform(pni_gpu *gpu, pni_mesh_data *mesh, const pn_span *positions, const float *bounds) {
  pn_result result = positions ? move_positions(gpu, mesh, positions) : PN_OK;
  if (result != PN_OK) return result;
  if (bounds) given_box(mesh, bounds, bounds + 3);
  mesh->pose++;
  return PN_OK;
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
