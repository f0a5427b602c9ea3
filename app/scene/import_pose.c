#include "scene/import_pose.h"

#include <math.h>
#include <string.h>

struct place place_of_matrix(const struct aiMatrix4x4 *m) {
  return (struct place){
      {m->a1, m->b1, m->c1, m->d1, m->a2, m->b2, m->c2, m->d2, m->a3, m->b3, m->c3, m->d3, m->a4, m->b4, m->c4, m->d4}};
}

/* The next node in the tree's order, without recursion; NULL after the last. */
static const struct aiNode *next_node(const struct aiNode *node) {
  if (node->mNumChildren) return node->mChildren[0];
  for (const struct aiNode *up = node->mParent; up; node = up, up = up->mParent)
    for (unsigned i = 0; i + 1 < up->mNumChildren; i++)
      if (up->mChildren[i] == node) return up->mChildren[i + 1];
  return NULL;
}

static struct place place_of_node(const struct aiNode *node) {
  struct place place = place_identity();
  for (; node; node = node->mParent) {
    struct place own = place_of_matrix(&node->mTransformation);
    place = place_product(&own, &place);
  }
  return place;
}

static const struct aiNode *find_node(const struct aiScene *model, const char *name) {
  for (const struct aiNode *node = model->mRootNode; node; node = next_node(node))
    if (strcmp(node->mName.data, name) == 0) return node;
  return NULL;
}

static int differ(const struct place *a, const struct place *b) {
  double most = 0, size = 0;
  for (int i = 0; i < 16; i++) {
    most = fmax(most, fabs(a->m[i] - b->m[i]));
    size = fmax(size, fabs(b->m[i]));
  }
  return !(most <= 1e-3 * size);
}

/* Whether a joint of the mesh stands elsewhere than where the mesh was bound to it. */
static int is_posed(const struct aiScene *model, const struct aiMesh *mesh, const struct place *place) {
  for (unsigned b = 0; b < mesh->mNumBones; b++) {
    const struct aiNode *joint = find_node(model, mesh->mBones[b]->mName.data);
    if (!joint || !mesh->mBones[b]->mNumWeights) continue;
    struct place at = place_of_node(joint), offset = place_of_matrix(&mesh->mBones[b]->mOffsetMatrix);
    struct place bound = place_product(&at, &offset);
    if (differ(&bound, place)) return 1;
  }
  return 0;
}

static int has_shape(const struct aiMesh *mesh) {
  for (unsigned i = 0; i < mesh->mNumAnimMeshes; i++)
    if (mesh->mAnimMeshes[i] && mesh->mAnimMeshes[i]->mWeight != 0) return 1;
  return 0;
}

void warn_about_poses(const struct importer *importer, const struct aiScene *model) {
  int joints = 0, shapes = 0;
  for (unsigned i = 0; i < model->mNumMeshes; i++) shapes |= has_shape(model->mMeshes[i]);
  for (const struct aiNode *node = model->mRootNode; node && !joints; node = next_node(node))
    for (unsigned i = 0; i < node->mNumMeshes && !joints; i++) {
      if (node->mMeshes[i] >= model->mNumMeshes || !model->mMeshes[node->mMeshes[i]]->mNumBones) continue;
      struct place place = place_of_node(node);
      joints = is_posed(model, model->mMeshes[node->mMeshes[i]], &place);
    }
  const char *what = joints && shapes ? "joints and shape weights"
                     : joints         ? "joints"
                     : shapes         ? "shape weights"
                                      : NULL;
  if (what) send_warning(importer, "its %s are left out: meshes are drawn as they were modelled", what);
}
