/* gltf_mesh.h: glTF's triangles, in the pose that joints and shapes give them. */
#ifndef PENUMBRA_APP_SCENE_GLTF_MESH_H
#define PENUMBRA_APP_SCENE_GLTF_MESH_H

#include "scene/gltf_document.h"
#include "scene/import_mesh.h"
#include "scene/import_place.h"

/* joints NULL: the mesh has none. weights: one for each shape. */
struct gltf_pose {
  const struct place *joints;
  size_t joint_count;
  const double *weights;
  size_t weight_count;
};

/* Sends one primitive of a mesh; with joints its vertices are where the file's scene has them. */
struct sent_mesh gltf_send_primitive(struct gltf *g, const cJSON *primitive, const struct gltf_pose *pose,
                                     const struct material_alpha *alpha, int has_alpha);

#endif
