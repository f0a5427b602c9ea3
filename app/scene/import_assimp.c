#include "scene/import_assimp.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/import_axes.h"
#include "scene/import_files.h"
#include "scene/import_material.h"
#include "scene/import_mesh.h"
#include "scene/import_peek.h"
#include "scene/import_place.h"
#include "scene/import_pose.h"

static const struct aiScene *read_model(struct importer *importer) {
  struct aiPropertyStore *settings = aiCreatePropertyStore();
  aiSetImportPropertyInteger(settings, AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  aiSetImportPropertyInteger(settings, AI_CONFIG_PP_RVC_FLAGS,
                             aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                 aiComponent_ANIMATIONS | aiComponent_LIGHTS | aiComponent_CAMERAS);
  aiSetImportPropertyInteger(settings, AI_CONFIG_FAVOUR_SPEED, 1);
  aiSetImportPropertyInteger(settings, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1); /* triangles that no file has */
  unsigned steps =
      aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_RemoveComponent | aiProcess_TransformUVCoords;
  struct aiFileIO files = import_files(importer);
  const struct aiScene *model = aiImportFileExWithProperties(importer->path, steps, &files, settings);
  aiReleasePropertyStore(settings);
  return model;
}

/* ".glb" where Assimp has an importer for it: then the file is not what its name says; else NULL. */
static const char *known_extension(const char *path) {
  const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
  return dot && aiIsExtensionSupported(dot) ? dot : NULL;
}

/* The importer's own words, without line ends. */
static _Noreturn void refuse_as_assimp_does(const struct importer *importer) {
  const char *text = aiGetErrorString();
  if (!text || !*text) text = "no importer can read it";
  char line[300];
  size_t length = 0;
  for (; *text && length < sizeof line - 1; text++)
    if (!(*text == '\n' || *text == '\r') || (length && line[length - 1] != ' '))
      line[length++] = *text == '\n' || *text == '\r' ? ' ' : *text;
  while (length && line[length - 1] == ' ') length--;
  line[length] = 0;
  if (strstr(line, "No meshes remaining"))
    refuse(importer, "holds no triangles, only points or lines; a model needs triangles or polygons");
  if (strstr(line, "bad_alloc") || strstr(line, "bad_array_new_length"))
    refuse(importer, "importing it takes more memory than a file of its size should need; it is probably damaged");
  const char *extension = known_extension(importer->path);
  if (extension && strstr(line, "No suitable reader"))
    refuse(importer, "cannot be imported: it is damaged, or not a %.20s file", extension);
  refuse(importer, "cannot be imported: %s", line);
}

/* ---- the tree of nodes ------------------------------------------------------------------------------------------- */

struct walk {
  struct importer *importer;
  const struct aiScene *model;
  struct material_alpha *alphas;
  struct sent_mesh *sent; /* one for each of the model's meshes */
};

static void place_mesh(struct walk *walk, unsigned index, const struct place *place) {
  if (index >= walk->model->mNumMeshes) return;
  static const struct material_alpha opaque = MATERIAL_OPAQUE;
  const struct aiMesh *mesh = walk->model->mMeshes[index];
  struct sent_mesh *sent = &walk->sent[index];
  if (!sent->tried)
    *sent =
        send_mesh(walk->importer, mesh,
                  mesh->mMaterialIndex < walk->model->mNumMaterials ? &walk->alphas[mesh->mMaterialIndex] : &opaque);
  if (sent->triangles) send_instance(walk->importer, sent->number, sent->triangles, place);
}

/* Without recursion: a tree may be as deep as it has nodes. */
static void place_nodes(struct walk *walk) {
  struct waiting {
    const struct aiNode *node;
    struct place parent;
  } *waiting = import_memory(1, sizeof *waiting);
  size_t count = 1, room = 1;
  waiting[0].node = walk->model->mRootNode;
  waiting[0].parent = place_identity();
  while (count) {
    struct waiting at = waiting[--count];
    struct place own = place_of_matrix(&at.node->mTransformation), place = place_product(&at.parent, &own);
    for (unsigned i = 0; i < at.node->mNumMeshes; i++) place_mesh(walk, at.node->mMeshes[i], &place);
    if (count + at.node->mNumChildren > room) {
      room = 2 * (count + at.node->mNumChildren);
      waiting = realloc(waiting, room * sizeof *waiting);
      if (!waiting) exit(1);
    }
    for (unsigned i = at.node->mNumChildren; i-- > 0;)
      if (at.node->mChildren[i]) waiting[count++] = (struct waiting){at.node->mChildren[i], place};
  }
  free(waiting);
}

void import_through_assimp(struct importer *importer, int up_is_z) {
  peek(importer);
  struct walk walk = {.importer = importer, .model = read_model(importer)};
  if (!walk.model || !walk.model->mRootNode) refuse_as_assimp_does(importer);
  choose_axes(importer, walk.model, up_is_z);
  if (*import_files_missing())
    send_warning(importer, "%s: the file is missing; its materials are left out: everything is opaque",
                 import_files_missing());
  warn_about_poses(importer, walk.model);
  walk.alphas = send_materials(importer, walk.model);
  walk.sent = import_memory(walk.model->mNumMeshes, sizeof *walk.sent);
  place_nodes(&walk);
}
