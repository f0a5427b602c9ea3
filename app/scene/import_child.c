#include "scene/import_child.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/import_material.h"
#include "scene/import_mesh.h"
#include "scene/scene.h"

/* In place of a mesh's number. */
enum { MESH_NOT_SENT = -2, MESH_EMPTY = -1, NODE_DEPTH_MAX = 4096 };

static const struct aiScene *read_model(const char *path) {
  struct aiPropertyStore *settings = aiCreatePropertyStore();
  aiSetImportPropertyInteger(settings, AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  aiSetImportPropertyInteger(settings, AI_CONFIG_PP_RVC_FLAGS,
                             aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                 aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS | aiComponent_LIGHTS |
                                 aiComponent_CAMERAS);
  aiSetImportPropertyInteger(settings, AI_CONFIG_FAVOUR_SPEED, 1);
  unsigned steps =
      aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_RemoveComponent | aiProcess_TransformUVCoords;
  const struct aiScene *model = aiImportFileExWithProperties(path, steps, NULL, settings);
  aiReleasePropertyStore(settings);
  return model;
}

/* From a node to the model, rows first as Assimp has them. In double, so that a node far away and a child that comes
 * back from there cancel. */
struct placement {
  double row[4][4];
};

static struct placement place_node(const struct placement *parent, const struct aiMatrix4x4 *m) {
  const float own[4][4] = {{m->a1, m->a2, m->a3, m->a4},
                           {m->b1, m->b2, m->b3, m->b4},
                           {m->c1, m->c2, m->c3, m->c4},
                           {m->d1, m->d2, m->d3, m->d4}};
  struct placement out = {{{0}}};
  for (int r = 0; r < 4; r++)
    for (int c = 0; c < 4; c++)
      for (int k = 0; k < 4; k++) out.row[r][c] += parent->row[r][k] * (double)own[k][c];
  return out;
}

/* --up z turns the file's z to y, and its y to -z. Returns 0 where it is not a finite affine matrix. */
static int to_columns(const struct placement *p, int up_is_z, double out[16]) {
  const double(*rows)[4] = p->row;
  for (int column = 0; column < 4; column++) {
    out[4 * column + 0] = rows[0][column];
    out[4 * column + 1] = up_is_z ? rows[2][column] : rows[1][column];
    out[4 * column + 2] = up_is_z ? -rows[1][column] : rows[2][column];
    out[4 * column + 3] = column == 3;
  }
  for (int i = 0; i < 16; i++)
    if (!isfinite(out[i]) || fabs(out[i]) > COORDINATE_MAX) return 0;
  return rows[3][0] == 0 && rows[3][1] == 0 && rows[3][2] == 0 && rows[3][3] == 1;
}

/* A transform that flattens everything leaves no area to block light with. */
static int flattens(const double m[16]) {
  double x = 0, y = 0, z = 0;
  for (int i = 0; i < 3; i++) {
    x += m[i] * m[i];
    y += m[4 + i] * m[4 + i];
    z += m[8 + i] * m[8 + i];
  }
  return (x == 0) + (y == 0) + (z == 0) > 1;
}

static void send_instance(struct importer *importer, unsigned mesh_index, const struct placement *transform,
                          int up_is_z) {
  if (mesh_index >= importer->model->mNumMeshes) return;
  struct record r = {.tag = RECORD_INSTANCE};
  if (!to_columns(transform, up_is_z, r.scene_from_object) || flattens(r.scene_from_object)) {
    importer->dropped_instances++;
    return;
  }
  const struct aiMesh *mesh = importer->model->mMeshes[mesh_index];
  int *sent = &importer->sent[mesh_index];
  if (*sent == MESH_NOT_SENT) {
    static const struct material_alpha opaque = {.texture = -1};
    int known = importer->alphas && mesh->mMaterialIndex < importer->model->mNumMaterials;
    *sent = send_mesh(importer, mesh, known ? &importer->alphas[mesh->mMaterialIndex] : &opaque);
  }
  if (*sent == MESH_EMPTY) return;
  r.mesh = *sent;
  send_bytes(importer->fd, &r, sizeof r);
  importer->instance_count++;
}

static void send_node(struct importer *importer, const struct aiNode *node, const struct placement *parent, int up_is_z,
                      int depth) {
  if (depth > NODE_DEPTH_MAX) return;
  struct placement transform = place_node(parent, &node->mTransformation);
  for (unsigned i = 0; i < node->mNumMeshes; i++) send_instance(importer, node->mMeshes[i], &transform, up_is_z);
  for (unsigned i = 0; i < node->mNumChildren; i++)
    if (node->mChildren[i]) send_node(importer, node->mChildren[i], &transform, up_is_z, depth + 1);
}

/* "dropped 3 triangles without area, ...": everything that was left out, or "". */
static void describe_dropped(const struct importer *importer, char *text, size_t size) {
  const struct {
    uint64_t count;
    const char *one, *many;
  } rows[] = {
      {importer->dropped_nan, "triangle with a coordinate that is not finite",
       "triangles with coordinates that are not finite"},
      {importer->dropped_far, "triangle with a coordinate beyond 1e15", "triangles with coordinates beyond 1e15"},
      {importer->dropped_area, "triangle without area", "triangles without area"},
      {importer->dropped_index, "triangle with a corner that does not exist",
       "triangles with corners that do not exist"},
      {importer->dropped_instances, "mesh placed with an unusable transform",
       "meshes placed with unusable transforms"}};
  *text = 0;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    if (!rows[i].count) continue;
    size_t length = strlen(text);
    snprintf(text + length, size - length, "%s%llu %s", length ? ", " : "dropped ", (unsigned long long)rows[i].count,
             rows[i].count == 1 ? rows[i].one : rows[i].many);
  }
}

/* ".glb" where Assimp has an importer for it: then the file is not what its name says; else NULL. */
static const char *known_extension(const char *path) {
  const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
  return dot && aiIsExtensionSupported(dot) ? dot : NULL;
}

/* The importer's own words, without line ends. */
static void send_import_error(int fd, const char *path) {
  const char *text = aiGetErrorString();
  if (!text || !*text) text = "no importer can read it";
  char line[300];
  size_t length = 0;
  for (; *text && length < sizeof line - 1; text++)
    if (!(*text == '\n' || *text == '\r') || (length && line[length - 1] != ' '))
      line[length++] = *text == '\n' || *text == '\r' ? ' ' : *text;
  while (length && line[length - 1] == ' ') length--;
  line[length] = 0;
  if (strstr(line, "No meshes remaining")) {
    send_text(fd, RECORD_ERROR, "holds no triangles, only points or lines; a model needs triangles or polygons");
    return;
  }
  if (strstr(line, "bad_alloc") || strstr(line, "bad_array_new_length")) {
    send_text(fd, RECORD_ERROR,
              "importing it takes more memory than a file of its size should need; it is probably damaged");
    return;
  }
  const char *extension = known_extension(path);
  if (extension && strstr(line, "No suitable reader"))
    send_text(fd, RECORD_ERROR, "cannot be imported: it is damaged, or not a %.20s file", extension);
  else send_text(fd, RECORD_ERROR, "cannot be imported: %s", line);
}

void import_child(const char *path, int up_is_z, int fd) {
  struct importer importer = {.fd = fd, .path = path};
  importer.model = read_model(path);
  if (!importer.model || !importer.model->mRootNode) {
    send_import_error(fd, path);
    return;
  }
  unsigned count = importer.model->mNumMeshes;
  importer.sent = malloc((count + 1) * sizeof *importer.sent);
  if (!importer.sent) return;
  for (unsigned i = 0; i < count; i++) importer.sent[i] = MESH_NOT_SENT;
  send_materials(&importer);
  const struct placement identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  send_node(&importer, importer.model->mRootNode, &identity, up_is_z, 0);
  char dropped[300];
  describe_dropped(&importer, dropped, sizeof dropped);
  if (importer.instance_count == 0) {
    send_text(fd, RECORD_ERROR, "holds no usable triangles%s%s",
              *dropped ? ": " : "; a model needs triangles or polygons", dropped);
    return;
  }
  if (*dropped) send_text(fd, RECORD_WARNING, "%s", dropped);
  struct record end = {.tag = RECORD_END};
  send_bytes(fd, &end, sizeof end);
}
