/* buffers.h: the scene's meshes and textures in GL. */
#ifndef PENUMBRA_APP_HOST_BUFFERS_H
#define PENUMBRA_APP_HOST_BUFFERS_H

#include "scene/scene.h"

/* Triangles are drawn in runs, each with its normals in a texture buffer of its own, because a texture buffer's
 * size is limited. */
struct gpu_run {
  uint32_t first, count; /* triangles */
  pn_gl normals, normal_buffer;
};

struct gpu_mesh {
  pn_gl vertex_array, positions, texcoords, indices;
  struct gpu_run *runs;
  int run_count;
};

struct gpu_scene {
  const struct scene *scene;
  struct gpu_mesh *meshes;
  pn_gl *textures; /* one for each of the scene's: R8, one level, linear */
};

/* Uploads; the scene must outlive the result. Exit status. */
int gpu_scene_create(const struct scene *scene, struct gpu_scene **out);
void gpu_scene_free(struct gpu_scene **gpu);

#endif
