#include "scene/gltf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/gltf_document.h"
#include "scene/gltf_material.h"
#include "scene/gltf_mesh.h"
#include "scene/import_axes.h"
#include "scene/import_place.h"

/* As many as a document of 100 MB has; a kilobyte that refers to its own nodes may stand for any number. */
enum { VISITS_MAX = 1 << 20 };

/* A mesh without joints is sent once, at its first use; primitives one after another. */
struct known_mesh {
  struct sent_mesh *primitives;
  int count, posed; /* posed: how often it was sent in a node's pose */
};

struct known_alpha {
  int known;
  struct material_alpha alpha;
};

struct walk {
  struct gltf g;
  struct importer *importer;
  struct known_mesh *meshes;
  struct known_alpha *alphas; /* the default material's is the last */
  int *parents;               /* of nodes; -1: none */
};

/* ---- extensions -------------------------------------------------------------------------------------------------- */

enum need { NEED_MET, NEED_PICTURES, NEED_UNMET };

/* Materials, lights and what is said about the file do not change where surfaces are. */
static enum need look_up(const char *name) {
  static const struct {
    const char *start;
    enum need need;
  } known[] = {{"KHR_mesh_quantization", NEED_MET},
               {"KHR_texture_transform", NEED_MET},
               {"EXT_mesh_gpu_instancing", NEED_MET},
               {"KHR_node_visibility", NEED_MET},
               {"KHR_materials_", NEED_MET},
               {"EXT_materials_", NEED_MET},
               {"KHR_lights_", NEED_MET},
               {"EXT_lights_", NEED_MET},
               {"KHR_xmp", NEED_MET},
               {"KHR_animation_pointer", NEED_MET},
               {"KHR_texture_basisu", NEED_PICTURES},
               {"EXT_texture_webp", NEED_PICTURES},
               {"EXT_texture_avif", NEED_PICTURES},
               {"MSFT_texture_dds", NEED_PICTURES},
               {"EXT_meshopt_compression", NEED_UNMET}};
  for (size_t i = 0; i < sizeof known / sizeof *known; i++)
    if (strncmp(name, known[i].start, strlen(known[i].start)) == 0) return known[i].need;
  return NEED_UNMET;
}

static void check_extensions(const struct gltf *g) {
  const cJSON *required = gltf_member(g->root, "extensionsRequired"), *item = NULL;
  if (!cJSON_IsArray(required)) return;
  cJSON_ArrayForEach(item, required) {
    const char *name = cJSON_IsString(item) ? item->valuestring : "an extension without a name";
    enum need need = look_up(name);
    if (need == NEED_UNMET) refuse(g->importer, "needs %.100s, which is not supported", name);
    if (need == NEED_PICTURES)
      send_warning(g->importer, "needs %.100s, which is not supported: such pictures are left out, and make no holes",
                   name);
  }
}

/* ---- nodes ------------------------------------------------------------------------------------------------------- */

static struct place place_of(const double t[3], const double q[4], const double s[3]) {
  double x = q[0], y = q[1], z = q[2], w = q[3], length = sqrt(x * x + y * y + z * z + w * w);
  if (length > 0) x /= length, y /= length, z /= length, w /= length;
  const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w),     2 * (x * z - y * w),
                       2 * (x * y - z * w),     1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
                       2 * (x * z + y * w),     2 * (y * z - x * w),     1 - 2 * (x * x + y * y)};
  struct place out = place_identity();
  for (int column = 0; column < 3; column++)
    for (int row = 0; row < 3; row++) out.m[4 * column + row] = s[column] * r[3 * column + row];
  for (int row = 0; row < 3; row++) out.m[12 + row] = t[row];
  return out;
}

static struct place own_place(const cJSON *node) {
  struct place out;
  double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
  if (gltf_numbers(node, "matrix", 16, out.m)) return out;
  gltf_numbers(node, "translation", 3, t);
  gltf_numbers(node, "rotation", 4, q);
  gltf_numbers(node, "scale", 3, s);
  return place_of(t, q, s);
}

/* A number of an array; -1 where it is none. */
static int index_of(const cJSON *item) {
  return cJSON_IsNumber(item) && item->valuedouble >= 0 && item->valuedouble < INT32_MAX ? item->valueint : -1;
}

static void find_parents(struct walk *walk) {
  size_t count = walk->g.lists[GLTF_NODES].count;
  walk->parents = import_memory(count, sizeof *walk->parents);
  for (size_t i = 0; i < count; i++) walk->parents[i] = -1;
  for (size_t i = 0; i < count; i++) {
    const cJSON *child = NULL, *children = gltf_member(walk->g.lists[GLTF_NODES].items[i], "children");
    if (cJSON_IsArray(children)) cJSON_ArrayForEach(child, children) {
        int index = index_of(child);
        gltf_item(&walk->g, GLTF_NODES, index);
        if (walk->parents[index] < 0) walk->parents[index] = (int)i;
      }
  }
}

static struct place whole_place(struct walk *walk, int node) {
  struct place place = place_identity();
  size_t depth = 0;
  for (; node >= 0; node = walk->parents[node]) {
    struct place own = own_place(gltf_item(&walk->g, GLTF_NODES, node));
    place = place_product(&own, &place);
    if (depth++ > walk->g.lists[GLTF_NODES].count) refuse(walk->importer, "is damaged: its nodes form a circle");
  }
  return place;
}

/* ---- poses ------------------------------------------------------------------------------------------------------- */

/* Where each joint takes the mesh's vertices. */
static struct place *find_joints(struct walk *walk, const cJSON *skin, size_t *count) {
  const cJSON *joints = gltf_member(skin, "joints"), *joint = NULL;
  int inverse = gltf_index(skin, "inverseBindMatrices");
  size_t have = 0, i = 0;
  *count = cJSON_IsArray(joints) ? (size_t)cJSON_GetArraySize(joints) : 0;
  struct place *out = import_memory(*count, sizeof *out);
  float *matrices = inverse < 0 ? NULL : gltf_floats(&walk->g, inverse, 16, &have);
  if (matrices && have < *count)
    refuse(walk->importer, "is damaged: a skin with %zu joints and %zu matrices", *count, have);
  if (*count) cJSON_ArrayForEach(joint, joints) {
      int node = index_of(joint);
      gltf_item(&walk->g, GLTF_NODES, node);
      struct place at = whole_place(walk, node), bind = place_identity();
      for (size_t k = 0; matrices && k < 16; k++) bind.m[k] = matrices[16 * i + k];
      out[i++] = place_product(&at, &bind);
    }
  free(matrices);
  return out;
}

/* The node's weights before the mesh's. NULL: none. */
static double *find_weights(const cJSON *node, const cJSON *mesh, size_t *count) {
  const cJSON *array = gltf_member(node, "weights");
  const cJSON *of = array ? node : mesh;
  if (!array) array = gltf_member(mesh, "weights");
  *count = cJSON_IsArray(array) ? (size_t)cJSON_GetArraySize(array) : 0;
  double *out = import_memory(*count, sizeof *out);
  if (!*count || !gltf_numbers(of, "weights", *count, out)) *count = 0;
  return out;
}

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

static const struct material_alpha *alpha_of(struct walk *walk, const cJSON *primitive, int *material) {
  *material = gltf_index(primitive, "material");
  size_t count = walk->g.lists[GLTF_MATERIALS].count;
  struct known_alpha *known = &walk->alphas[*material < 0 || (size_t)*material > count ? count : (size_t)*material];
  if (!known->known) known->alpha = gltf_alpha(&walk->g, *material);
  known->known = 1;
  return &known->alpha;
}

static struct known_mesh send_primitives(struct walk *walk, const cJSON *mesh, const struct gltf_pose *pose) {
  const cJSON *primitives = gltf_member(mesh, "primitives"), *primitive = NULL;
  struct known_mesh out = {.count = 0};
  if (!cJSON_IsArray(primitives)) return out;
  out.primitives = import_memory((size_t)cJSON_GetArraySize(primitives), sizeof *out.primitives);
  cJSON_ArrayForEach(primitive, primitives) {
    int material = 0;
    const struct material_alpha *alpha = alpha_of(walk, primitive, &material);
    int has_alpha = gltf_has_alpha(&walk->g, material);
    out.primitives[out.count++] = gltf_send_primitive(&walk->g, primitive, pose, alpha, has_alpha);
  }
  return out;
}

/* A mesh in its own pose is sent once; one in a node's pose for each node, and is not held by the file as often. */
static struct known_mesh find_mesh(struct walk *walk, const cJSON *node, int index, int posed) {
  const cJSON *mesh = gltf_item(&walk->g, GLTF_MESHES, index);
  struct known_mesh *known = &walk->meshes[index];
  if (!posed && known->primitives) return *known;
  struct gltf_pose pose = {0};
  struct place *joints = NULL;
  double *weights = find_weights(node, mesh, &pose.weight_count);
  uint64_t held = walk->importer->triangles_held;
  if (gltf_index(node, "skin") >= 0)
    joints = find_joints(walk, gltf_item(&walk->g, GLTF_SKINS, gltf_index(node, "skin")), &pose.joint_count);
  pose.joints = joints;
  pose.weights = weights;
  struct known_mesh sent = send_primitives(walk, mesh, &pose);
  free(joints);
  free(weights);
  if (!posed) *known = sent;
  else if (known->posed++) walk->importer->triangles_held = held;
  return sent;
}

static void place_mesh(struct walk *walk, const struct known_mesh *mesh, const struct place *place) {
  for (int i = 0; i < mesh->count; i++)
    if (mesh->primitives[i].triangles)
      send_instance(walk->importer, mesh->primitives[i].number, mesh->primitives[i].triangles, place);
}

/* One value an instance; NULL where the file has none. */
static float *instance_values(struct walk *walk, const cJSON *attributes, const char *name, size_t components,
                              size_t *count) {
  size_t have = 0;
  int index = gltf_index(attributes, name);
  if (index < 0) return NULL;
  float *values = gltf_floats(&walk->g, index, components, &have);
  if (*count != SIZE_MAX && have != *count)
    refuse(walk->importer, "is damaged: EXT_mesh_gpu_instancing with %zu and %zu values", *count, have);
  *count = have;
  return values;
}

static void place_instances(struct walk *walk, const cJSON *instancing, const struct known_mesh *mesh,
                            const struct place *node) {
  const cJSON *attributes = gltf_member(instancing, "attributes");
  size_t count = SIZE_MAX;
  float *t = instance_values(walk, attributes, "TRANSLATION", 3, &count);
  float *q = instance_values(walk, attributes, "ROTATION", 4, &count);
  float *s = instance_values(walk, attributes, "SCALE", 3, &count);
  if (count == SIZE_MAX) count = 1;
  for (size_t i = 0; i < count; i++) {
    double at[3] = {0, 0, 0}, turn[4] = {0, 0, 0, 1}, size[3] = {1, 1, 1};
    for (size_t k = 0; t && k < 3; k++) at[k] = t[3 * i + k];
    for (size_t k = 0; q && k < 4; k++) turn[k] = q[4 * i + k];
    for (size_t k = 0; s && k < 3; k++) size[k] = s[3 * i + k];
    struct place own = place_of(at, turn, size), place = place_product(node, &own);
    place_mesh(walk, mesh, &place);
  }
  free(t);
  free(q);
  free(s);
}

static void visit(struct walk *walk, const cJSON *node, const struct place *place) {
  int index = gltf_index(node, "mesh");
  if (index < 0) return;
  int skinned = gltf_index(node, "skin") >= 0, posed = skinned || gltf_member(node, "weights");
  struct known_mesh mesh = find_mesh(walk, node, index, posed);
  const cJSON *instancing = gltf_extension(node, "EXT_mesh_gpu_instancing");
  struct place here = place_identity();
  if (skinned) place_mesh(walk, &mesh, &here); /* its joints alone say where it is */
  else if (instancing) place_instances(walk, instancing, &mesh, place);
  else place_mesh(walk, &mesh, place);
  if (posed) free(mesh.primitives);
}

/* ---- the tree ---------------------------------------------------------------------------------------------------- */

/* Nodes to come, each with its parent's place: without recursion, a tree may be as deep as it has nodes. */
struct waiting {
  struct waiting_node {
    int node;
    size_t depth;
    struct place parent;
  } * nodes;
  size_t count, room;
};

static void wait_for(struct waiting *w, int node, size_t depth, const struct place *parent) {
  if (w->count == w->room) {
    w->room = 2 * w->room + 16;
    w->nodes = realloc(w->nodes, w->room * sizeof *w->nodes);
    if (!w->nodes) exit(1);
  }
  w->nodes[w->count++] = (struct waiting_node){node, depth, *parent};
}

static int is_hidden(const cJSON *node) {
  return cJSON_IsFalse(gltf_member(gltf_extension(node, "KHR_node_visibility"), "visible"));
}

static void visit_all(struct walk *walk, struct waiting *w) {
  for (int visits = 0; w->count; visits++) {
    struct waiting_node at = w->nodes[--w->count];
    const cJSON *node = gltf_item(&walk->g, GLTF_NODES, at.node), *child = NULL;
    const cJSON *children = gltf_member(node, "children");
    if (is_hidden(node)) continue;
    if (at.depth > walk->g.lists[GLTF_NODES].count) refuse(walk->importer, "is damaged: its nodes form a circle");
    if (visits > VISITS_MAX)
      refuse(walk->importer, "refers to its nodes more than %d times, which is as often as a file may", VISITS_MAX);
    struct place own = own_place(node), place = place_product(&at.parent, &own);
    visit(walk, node, &place);
    if (cJSON_IsArray(children)) cJSON_ArrayForEach(child, children) wait_for(w, index_of(child), at.depth + 1, &place);
  }
}

/* The nodes of the scene that the file names, of its first, or those without a parent. */
static void add_roots(struct walk *walk, struct waiting *w) {
  struct place identity = place_identity();
  struct gltf *g = &walk->g;
  int index = gltf_index(g->root, "scene");
  if (index < 0 && g->lists[GLTF_SCENES].count) index = 0;
  if (index < 0)
    for (size_t i = 0; i < g->lists[GLTF_NODES].count; i++)
      if (walk->parents[i] < 0) wait_for(w, (int)i, 0, &identity);
  if (index < 0) return;
  const cJSON *roots = gltf_member(gltf_item(g, GLTF_SCENES, index), "nodes"), *root = NULL;
  if (cJSON_IsArray(roots)) cJSON_ArrayForEach(root, roots) wait_for(w, index_of(root), 0, &identity);
}

int gltf_import(struct importer *importer, int up_is_z) {
  struct walk walk = {.importer = importer};
  struct waiting waiting = {0};
  if (!gltf_open(&walk.g, importer)) return 0;
  turn_up(importer, up_is_z);
  check_extensions(&walk.g);
  walk.meshes = import_memory(walk.g.lists[GLTF_MESHES].count, sizeof *walk.meshes);
  walk.alphas = import_memory(walk.g.lists[GLTF_MATERIALS].count + 1, sizeof *walk.alphas);
  find_parents(&walk);
  add_roots(&walk, &waiting);
  visit_all(&walk, &waiting);
  free(waiting.nodes);
  return 1;
}
