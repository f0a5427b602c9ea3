#include "silhouettes/mesh_edges.h"

#include <string.h>

#include "gl/host.h"
#include "gl/plan.h"
#include "silhouettes/edges.h"

/* PNI_EDGE_ROW and PNI_POSITION_ROW; a test holds them together. */
const char pni_edge_defines[] = "PN_EDGE_ROW 4096\nPN_POSITION_ROW 4096\n";

/* ---- textures from memory and from buffers ----------------------------------------------------------------------- */

static int rows_of(size_t entries, size_t row) { return (int)((entries + row - 1) / row); }

static pn_result table(pni_gpu *gpu, pni_texture *t, const char *label, pni_format format, const void *data,
                       size_t count) {
  pn_result result = pni_texture_shape(gpu, t, label, format, PNI_EDGE_ROW, rows_of(count, PNI_EDGE_ROW), 0, 1);
  if (result == PN_OK) pni_texture_write(gpu, t, data, count);
  return result;
}

/* ---- reading the mesh back --------------------------------------------------------------------------------------- */

/* The buffer that holds the positions, and their layout in it. */
static pn_span positions_of(const pni_mesh_data *mesh) {
  if (mesh->own_positions.id) return (pn_span){mesh->own_positions.id, NULL, 0, 12, mesh->positions.count};
  pn_span span = mesh->positions;
  if (!span.stride) span.stride = 12;
  return span;
}

static void *read_buffer(pni_gpu *gpu, pn_gl buffer, size_t offset, size_t bytes) {
  void *out = pni_reallocate(gpu, NULL, bytes);
  if (out) pni_buffer_read(gpu, buffer, offset, bytes, out);
  return out;
}

static float *read_positions(pni_gpu *gpu, const pni_mesh_data *mesh) {
  pn_span span = positions_of(mesh);
  char *bytes = read_buffer(gpu, span.buffer, span.offset, (span.count - 1) * span.stride + 12);
  for (size_t i = 1; bytes && span.stride != 12 && i < span.count; i++)
    memmove(bytes + 12 * i, bytes + i * span.stride, 12);
  return (float *)(void *)bytes;
}

static uint32_t *read_indices(pni_gpu *gpu, const pni_mesh_data *mesh) {
  size_t count = mesh->draw_count;
  bool narrow = mesh->index_bytes == 2;
  if (mesh->index_bytes && !narrow) {
    pn_gl own = mesh->own_indices.id;
    return read_buffer(gpu, own ? own : mesh->indices.buffer, own ? 0 : mesh->indices.offset, count * 4);
  }
  uint32_t *out = pni_reallocate(gpu, NULL, count * sizeof *out);
  for (size_t i = 0; out && !narrow && i < count; i++) out[i] = (uint32_t)i;
  if (!out || !narrow) return out;
  uint16_t *read = read_buffer(gpu, mesh->indices.buffer, mesh->indices.offset, count * 2);
  for (size_t i = 0; read && i < count; i++) out[i] = read[i];
  if (!read) pni_free(gpu, out);
  bool done = read != NULL;
  pni_free(gpu, read);
  return done ? out : NULL;
}

/* Hosts delete buffers, or fill them anew with less. */
static pn_result check_buffers(pni_gpu *gpu, const pni_mesh_data *mesh) {
  pn_span p = positions_of(mesh);
  size_t indices = mesh->index_bytes && !mesh->own_indices.id ? mesh->draw_count * (size_t)mesh->index_bytes : 0;
  bool there =
      pni_buffer_exists(gpu, p.buffer) && pni_buffer_size(gpu, p.buffer) >= p.offset + (p.count - 1) * p.stride + 12;
  if (there && indices)
    there = pni_buffer_exists(gpu, mesh->indices.buffer) &&
            pni_buffer_size(gpu, mesh->indices.buffer) >= mesh->indices.offset + indices;
  if (there) return PN_OK;
  return pni_fail(gpu, PN_ERROR_NOT_READY, PN_MESSAGE_MESH_POSITIONS,
                  "a buffer of mesh %u is gone, or holds less than the mesh was described with", mesh->id);
}

/* ---- positions --------------------------------------------------------------------------------------------------- */

/* From buffer to texture without passing through here, where the layout is whole floats. */
static pn_result copy_positions(pni_gpu *gpu, const pni_mesh_data *mesh, pni_mesh_edges *e) {
  pn_span span = positions_of(mesh);
  bool floats = span.stride % 4 == 0 && span.offset % 4 == 0;
  size_t stride = floats ? span.stride / 4 : 3, count = (span.count - 1) * stride + 3;
  if (rows_of(count, PNI_POSITION_ROW) > gpu->can.texture_size_max) floats = false, stride = 3, count = 3 * span.count;
  pn_result result = pni_texture_shape(gpu, &e->positions, "mesh positions", PNI_R32F, PNI_POSITION_ROW,
                                       rows_of(count, PNI_POSITION_ROW), 0, 1);
  if (result != PN_OK) return result;
  if (floats) {
    pni_texture_write_from(gpu, &e->positions, span.buffer, span.offset, count);
  } else {
    float *read = read_positions(gpu, mesh);
    if (!read) return PN_ERROR_OUT_OF_MEMORY;
    pni_texture_write(gpu, &e->positions, read, count);
    pni_free(gpu, read);
  }
  e->stride = (int)stride;
  e->current = true;
  e->pose = mesh->pose;
  return PN_OK;
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static void report(pni_gpu *gpu, const pni_mesh_data *mesh, const pni_edge_list *list) {
  if (!list->open && !list->crowded && !list->opposed && !list->dropped) return;
  pni_note(gpu, PN_LOG_INFO, PN_MESSAGE_MESH_EDGES,
           "mesh %u, %zu edges: %zu open, %zu of three and more faces, %zu between faces wound against each other; "
           "%zu triangles without three corners",
           mesh->id, list->count, list->open, list->crowded, list->opposed, list->dropped);
}

static pn_result find_edges(pni_gpu *gpu, const pni_mesh_data *mesh, pni_edge_list *list) {
  bool kept = mesh->kept_indices != NULL; /* all triangles, those too that have area in other poses only */
  float *positions = read_positions(gpu, mesh);
  uint32_t *indices = kept ? mesh->kept_indices : read_indices(gpu, mesh);
  pn_result result = PN_ERROR_OUT_OF_MEMORY;
  if (positions && indices)
    result = pni_edges_find(gpu, positions, mesh->positions.count, indices, kept ? mesh->kept_count : mesh->draw_count,
                            list);
  pni_free(gpu, positions);
  if (!kept) pni_free(gpu, indices);
  if (result == PN_OK) report(gpu, mesh, list);
  return result;
}

static pn_result upload(pni_gpu *gpu, const pni_edge_list *list, pni_mesh_edges *e) {
  e->count = list->count;
  e->vertices = list->vertices;
  e->ring_most = (int)list->ring_most;
  if (!list->count) return PN_OK;
  int rows = rows_of(list->count, PNI_EDGE_ROW), points = rows_of(list->vertices, PNI_EDGE_ROW);
  pn_result result = table(gpu, &e->edges, "mesh edges", PNI_RGBA32UI, list->edges, list->count);
  if (result == PN_OK) result = table(gpu, &e->rings, "mesh rings", PNI_RG32UI, list->rings, list->vertices);
  if (result == PN_OK)
    result = table(gpu, &e->entries, "mesh ring entries", PNI_RG32UI, list->entries, 2 * list->count);
  if (result == PN_OK)
    result = pni_texture_shape(gpu, &e->points, "mesh points", PNI_RGBA32F, PNI_EDGE_ROW, points, 0, 1);
  if (result == PN_OK) result = pni_texture_shape(gpu, &e->sides, "mesh silhouettes", PNI_R8, PNI_EDGE_ROW, rows, 0, 1);
  return result;
}

static void release(pni_gpu *gpu, void *state, bool abandon) {
  pni_mesh_edges *e = state;
  pni_texture *all[] = {&e->positions, &e->edges, &e->rings, &e->entries, &e->points, &e->sides};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) pni_texture_free(gpu, all[i], abandon);
}

static const pni_kind kind = {.bytes = sizeof(pni_mesh_edges), .release = release};

static pn_result make_edges(pni_gpu *gpu, pni_mesh_data *mesh) {
  pni_edge_list list;
  void *edges;
  pn_result result = find_edges(gpu, mesh, &list);
  if (result != PN_OK) return result;
  result = pni_kept_get(gpu, &mesh->kept, &kind, &edges);
  if (result == PN_OK) result = upload(gpu, &list, edges);
  pni_edges_free(gpu, &list);
  if (result != PN_OK) pni_kept_free(gpu, &mesh->kept, false);
  return result;
}

pn_result pni_mesh_edges_get(pni_gpu *gpu, pni_mesh_data *mesh, pni_mesh_edges **out) {
  *out = NULL;
  if (!mesh->draw_count && !mesh->kept_indices) return PN_OK;
  bool keep = pni_plan_pause(gpu); /* they belong to the mesh */
  pni_mesh_edges *edges = mesh->kept.state;
  bool current = edges && (!edges->count || (edges->current && edges->pose == mesh->pose));
  pn_result result = current ? PN_OK : check_buffers(gpu, mesh);
  if (result == PN_OK && !edges) result = make_edges(gpu, mesh);
  edges = mesh->kept.state;
  bool some = result == PN_OK && edges->count;
  if (some && (!edges->current || edges->pose != mesh->pose)) result = copy_positions(gpu, mesh, edges);
  if (some && result == PN_OK) *out = edges;
  pni_plan_resume(gpu, keep);
  return result;
}
