#include "scene/import_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "scene/scene.h"
#include "scene/vector.h"

static int is_finite(const struct aiVector3D *p) { return isfinite(p->x) && isfinite(p->y) && isfinite(p->z); }

static int is_near(const struct aiVector3D *p) {
  const float most = (float)COORDINATE_MAX;
  return fabsf(p->x) <= most && fabsf(p->y) <= most && fabsf(p->z) <= most;
}

static int has_area(const struct aiVector3D *p, const struct aiVector3D *q, const struct aiVector3D *r) {
  double a[3] = {(double)q->x - p->x, (double)q->y - p->y, (double)q->z - p->z};
  double b[3] = {(double)r->x - p->x, (double)r->y - p->y, (double)r->z - p->z};
  double n[3];
  v3_cross(a, b, n);
  /* Slivers whose normal is rounding noise count as without area. */
  return v3_length(n) > 1e-12 * (v3_dot(a, a) + v3_dot(b, b));
}

/* The triangle's three corners, or NULL with the reason counted. */
static const unsigned *usable(struct importer *importer, const struct aiMesh *mesh, const struct aiFace *face) {
  if (face->mNumIndices != 3) return NULL;
  const unsigned *i = face->mIndices;
  if (i[0] >= mesh->mNumVertices || i[1] >= mesh->mNumVertices || i[2] >= mesh->mNumVertices) {
    importer->dropped_index++;
    return NULL;
  }
  const struct aiVector3D *p = mesh->mVertices;
  if (!is_finite(&p[i[0]]) || !is_finite(&p[i[1]]) || !is_finite(&p[i[2]])) {
    importer->dropped_nan++;
    return NULL;
  }
  if (!is_near(&p[i[0]]) || !is_near(&p[i[1]]) || !is_near(&p[i[2]])) {
    importer->dropped_far++;
    return NULL;
  }
  if (!has_area(&p[i[0]], &p[i[1]], &p[i[2]])) {
    importer->dropped_area++;
    return NULL;
  }
  return i;
}

/* Vertices that coincide are shared: many formats store three a triangle. A hash table of vertex numbers + 1, open
 * addressing. */
struct welder {
  uint32_t *slots, mask;
  float *positions, *texcoords;
  uint32_t count;
};

static uint32_t hash_words(const float *values, int count, uint32_t h) {
  for (int i = 0; i < count; i++) {
    uint32_t word;
    memcpy(&word, &values[i], sizeof word);
    h = (h ^ word) * 0x9e3779b1u;
    h ^= h >> 15;
  }
  return h;
}

static uint32_t weld(struct welder *w, const float p[3], const float *uv) {
  uint32_t h = hash_words(p, 3, 1);
  if (uv) h = hash_words(uv, 2, h);
  for (uint32_t slot = h & w->mask;; slot = (slot + 1) & w->mask) {
    uint32_t known = w->slots[slot];
    if (!known) {
      w->slots[slot] = w->count + 1;
      memcpy(&w->positions[3 * (size_t)w->count], p, 3 * sizeof *p);
      if (uv) memcpy(&w->texcoords[2 * (size_t)w->count], uv, 2 * sizeof *uv);
      return w->count++;
    }
    if (memcmp(&w->positions[3 * (size_t)(known - 1)], p, 3 * sizeof *p) == 0 &&
        (!uv || memcmp(&w->texcoords[2 * (size_t)(known - 1)], uv, 2 * sizeof *uv) == 0))
      return known - 1;
  }
}

static void welder_init(struct welder *w, uint32_t vertices, int textured) {
  memset(w, 0, sizeof *w);
  w->mask = 1;
  while (w->mask < vertices + (vertices >> 1)) w->mask = w->mask * 2 + 1;
  w->slots = calloc((size_t)w->mask + 1, sizeof *w->slots);
  w->positions = malloc((size_t)vertices * 3 * sizeof(float) + 1);
  w->texcoords = textured ? malloc((size_t)vertices * 2 * sizeof(float) + 1) : NULL;
  if (!w->slots || !w->positions || (textured && !w->texcoords)) _exit(1);
}

static void copy_vertex(struct welder *w, const struct aiMesh *mesh, unsigned i, const struct material_alpha *alpha,
                        uint32_t *index) {
  const struct aiVector3D *v = &mesh->mVertices[i];
  const float p[3] = {v->x + 0.0f, v->y + 0.0f, v->z + 0.0f}; /* -0 becomes 0: the same place */
  if (!w->texcoords) {
    *index = weld(w, p, NULL);
    return;
  }
  const struct aiVector3D *t = &mesh->mTextureCoords[alpha->uv_channel][i];
  const double *m = alpha->transform;
  float uv[2];
  for (int k = 0; k < 2; k++) {
    uv[k] = (float)(m[3 * k] * (double)t->x + m[3 * k + 1] * (double)t->y + m[3 * k + 2]);
    if (!isfinite(uv[k])) uv[k] = 0;
  }
  *index = weld(w, p, uv);
}

struct sent_mesh send_mesh(struct importer *importer, const struct aiMesh *mesh, const struct material_alpha *alpha) {
  if (alpha->invisible) {
    if (!importer->transparent_count++) memcpy(importer->transparent, alpha->name, sizeof alpha->name);
    return (struct sent_mesh){.tried = 1};
  }
  importer->blended += alpha->blended;
  if (!mesh->mVertices || mesh->mNumFaces > UINT32_MAX / 3 || mesh->mNumVertices > UINT32_MAX / 2)
    return (struct sent_mesh){.tried = 1};
  int channel = alpha->uv_channel;
  int textured =
      alpha->texture >= 0 && channel >= 0 && channel < AI_MAX_NUMBER_OF_TEXTURECOORDS && mesh->mTextureCoords[channel];
  struct welder w;
  welder_init(&w, mesh->mNumVertices, textured);
  uint32_t *indices = malloc((size_t)mesh->mNumFaces * 3 * sizeof *indices + 1), triangles = 0;
  if (!indices) _exit(1);
  for (unsigned f = 0; f < mesh->mNumFaces; f++) {
    const unsigned *corners = usable(importer, mesh, &mesh->mFaces[f]);
    if (!corners) continue;
    for (int k = 0; k < 3; k++) copy_vertex(&w, mesh, corners[k], alpha, &indices[3 * (size_t)triangles + k]);
    triangles++;
  }
  if (triangles) {
    struct record r = {.tag = RECORD_MESH,
                       .vertex_count = w.count,
                       .triangle_count = triangles,
                       .texture = textured ? alpha->texture : -1,
                       .cutoff = alpha->cutoff};
    send_bytes(importer->fd, &r, sizeof r);
    send_bytes(importer->fd, w.positions, (size_t)w.count * 3 * sizeof(float));
    if (textured) send_bytes(importer->fd, w.texcoords, (size_t)w.count * 2 * sizeof(float));
    send_bytes(importer->fd, indices, (size_t)triangles * 3 * sizeof *indices);
  }
  free(w.slots);
  free(w.positions);
  free(w.texcoords);
  free(indices);
  importer->triangles_held += triangles;
  return (struct sent_mesh){.tried = 1, .number = triangles ? importer->mesh_count++ : -1, .triangles = triangles};
}
