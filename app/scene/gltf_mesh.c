#include "scene/gltf_mesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int attribute(const cJSON *object, const char *name, int set) {
  char whole[32];
  snprintf(whole, sizeof whole, "%s%d", name, set);
  return gltf_index(object, whole);
}

/* ---- poses ------------------------------------------------------------------------------------------------------- */

static void add_shapes(struct gltf *g, const cJSON *primitive, const struct gltf_pose *pose, float *positions,
                       size_t count) {
  const cJSON *targets = gltf_member(primitive, "targets"), *target = NULL;
  size_t i = 0;
  if (!cJSON_IsArray(targets)) return;
  cJSON_ArrayForEach(target, targets) {
    double weight = i < pose->weight_count ? pose->weights[i] : 0;
    int accessor = gltf_index(target, "POSITION");
    size_t have = 0;
    i++;
    if (weight == 0 || accessor < 0) continue;
    float *moves = gltf_floats(g, accessor, 3, &have);
    if (have != count) refuse(g->importer, "is damaged: a shape of %zu vertices on a mesh of %zu", have, count);
    for (size_t k = 0; k < 3 * count; k++) positions[k] = (float)(positions[k] + weight * (double)moves[k]);
    free(moves);
  }
}

/* sums: the weighted places of each vertex, and their weights. */
static void add_joints(struct gltf *g, const cJSON *attributes, int set, const struct gltf_pose *pose,
                       const float *positions, size_t count, double *sums) {
  size_t joint_count = 0, weight_count = 0;
  uint32_t *joints = gltf_integers(g, attribute(attributes, "JOINTS_", set), 4, &joint_count);
  float *weights = gltf_floats(g, attribute(attributes, "WEIGHTS_", set), 4, &weight_count);
  if (joint_count != count || weight_count != count)
    refuse(g->importer, "is damaged: joints of %zu vertices on a mesh of %zu", joint_count, count);
  for (size_t i = 0; i < 4 * count; i++) {
    double weight = weights[i], at[3];
    if (!(weight > 0)) continue;
    if (joints[i] >= pose->joint_count)
      refuse(g->importer, "is damaged: it refers to joint %u of %zu", joints[i], pose->joint_count);
    const float *p = &positions[i / 4 * 3];
    place_point(&pose->joints[joints[i]], (const double[3]){(double)p[0], (double)p[1], (double)p[2]}, at);
    for (int k = 0; k < 3; k++) sums[i / 4 * 4 + (size_t)k] += weight * at[k];
    sums[i / 4 * 4 + 3] += weight;
  }
  free(joints);
  free(weights);
}

static void move_by_joints(struct gltf *g, const cJSON *attributes, const struct gltf_pose *pose, float *positions,
                           size_t count) {
  if (!pose->joints || attribute(attributes, "JOINTS_", 0) < 0) return;
  double *sums = import_memory(count, 4 * sizeof *sums);
  for (int set = 0; attribute(attributes, "JOINTS_", set) >= 0; set++)
    add_joints(g, attributes, set, pose, positions, count, sums);
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < 3 && sums[4 * i + 3] > 0; k++)
      positions[3 * i + k] = (float)(sums[4 * i + k] / sums[4 * i + 3]);
  free(sums);
}

/* ---- triangles --------------------------------------------------------------------------------------------------- */

enum { MODE_TRIANGLES = 4, MODE_STRIP, MODE_FAN };

/* Every second triangle of a strip is turned, so that all face the same way. */
static void corners_of(int mode, size_t t, size_t out[3]) {
  size_t odd = t & 1;
  const size_t list[3] = {3 * t, 3 * t + 1, 3 * t + 2}, strip[3] = {t, t + 1 + odd, t + 2 - odd},
               fan[3] = {0, t + 1, t + 2};
  memcpy(out, mode == MODE_STRIP ? strip : mode == MODE_FAN ? fan : list, sizeof list);
}

static void make_faces(struct gltf *g, const cJSON *primitive, int mode, struct aiMesh *mesh) {
  size_t count = mesh->mNumVertices;
  uint32_t *indices = NULL;
  if (gltf_member(primitive, "indices")) indices = gltf_integers(g, gltf_index(primitive, "indices"), 1, &count);
  size_t triangles = mode == MODE_TRIANGLES ? count / 3 : count > 2 ? count - 2 : 0;
  unsigned *corners = import_memory(triangles, 3 * sizeof *corners);
  mesh->mFaces = import_memory(triangles, sizeof *mesh->mFaces);
  for (size_t t = 0; t < triangles; t++) {
    size_t c[3];
    corners_of(mode, t, c);
    for (int k = 0; k < 3; k++) corners[3 * t + (size_t)k] = indices ? indices[c[k]] : (unsigned)c[k];
    mesh->mFaces[t] = (struct aiFace){3, &corners[3 * t]};
  }
  mesh->mNumFaces = (unsigned)triangles;
  free(indices);
}

/* Texture coordinates, v upwards as everywhere in the program. */
static struct aiVector3D *read_texcoords(struct gltf *g, const cJSON *attributes, int channel, size_t count) {
  size_t have = 0;
  if (attribute(attributes, "TEXCOORD_", channel) < 0) return NULL;
  float *uv = gltf_floats(g, attribute(attributes, "TEXCOORD_", channel), 2, &have);
  if (have != count)
    refuse(g->importer, "is damaged: texture coordinates of %zu vertices on a mesh of %zu", have, count);
  struct aiVector3D *out = import_memory(count, sizeof *out);
  for (size_t i = 0; i < count; i++) out[i] = (struct aiVector3D){uv[2 * i], 1 - uv[2 * i + 1], 0};
  free(uv);
  return out;
}

static void look_at_colours(struct gltf *g, const cJSON *attributes) {
  size_t count = 0, holes = 0;
  int index = gltf_index(attributes, "COLOR_0");
  if (index < 0) return;
  const char *type = gltf_string(gltf_item(g, GLTF_ACCESSORS, index), "type");
  if (!type || strcmp(type, "VEC4") != 0) return;
  float *colours = gltf_floats(g, index, 4, &count);
  for (size_t i = 0; i < count; i++) holes += colours[4 * i + 3] < 1;
  free(colours);
  if (holes && !g->vertex_opacity++)
    send_warning(g->importer, "opacity in vertex colours is left out: only materials and pictures make holes");
}

struct sent_mesh gltf_send_primitive(struct gltf *g, const cJSON *primitive, const struct gltf_pose *pose,
                                     const struct material_alpha *alpha, int has_alpha) {
  const cJSON *attributes = gltf_member(primitive, "attributes");
  int mode = (int)gltf_number(primitive, "mode", MODE_TRIANGLES), at = gltf_index(attributes, "POSITION");
  if (gltf_extension(primitive, "KHR_draco_mesh_compression") &&
      (at < 0 || !gltf_member(gltf_item(g, GLTF_ACCESSORS, at), "bufferView")))
    refuse(g->importer, "needs KHR_draco_mesh_compression, which is not supported");
  if (mode < MODE_TRIANGLES || mode > MODE_FAN || at < 0) return (struct sent_mesh){.tried = 1};
  struct aiMesh mesh = {0};
  size_t count = 0;
  float *positions = gltf_floats(g, at, 3, &count);
  add_shapes(g, primitive, pose, positions, count);
  move_by_joints(g, attributes, pose, positions, count);
  mesh.mNumVertices = (unsigned)count;
  mesh.mVertices = import_memory(count, sizeof *mesh.mVertices);
  for (size_t i = 0; i < count; i++)
    mesh.mVertices[i] = (struct aiVector3D){positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
  free(positions);
  int textured = alpha->texture >= 0 && alpha->uv_channel < AI_MAX_NUMBER_OF_TEXTURECOORDS;
  if (textured) mesh.mTextureCoords[alpha->uv_channel] = read_texcoords(g, attributes, alpha->uv_channel, count);
  if (has_alpha) look_at_colours(g, attributes);
  make_faces(g, primitive, mode, &mesh);
  struct sent_mesh sent = send_mesh(g->importer, &mesh, alpha);
  if (mesh.mNumFaces) free(mesh.mFaces[0].mIndices);
  free(mesh.mFaces);
  free(mesh.mVertices);
  if (textured) free(mesh.mTextureCoords[alpha->uv_channel]);
  return sent;
}
