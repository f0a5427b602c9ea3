#include "scene/ground.h"

#include <stdlib.h>
#include <string.h>

#include "base/message.h"

int ground_add(struct scene *scene) {
  float half = (float)(2.5 * scene_extent(scene));
  double x = 0.5 * (scene->bounds_min[0] + scene->bounds_max[0]), y = scene->bounds_min[1];
  double z = 0.5 * (scene->bounds_min[2] + scene->bounds_max[2]);
  struct mesh mesh = {.vertex_count = 4, .triangle_count = 2, .texture = -1};
  mesh.positions = malloc(12 * sizeof *mesh.positions);
  mesh.indices = malloc(6 * sizeof *mesh.indices);
  if (!mesh.positions || !mesh.indices) {
    free(mesh.positions);
    free(mesh.indices);
    return memory_error();
  }
  const float positions[12] = {-half, 0, -half, -half, 0, half, half, 0, half, half, 0, -half};
  const double scene_from_object[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1};
  const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  memcpy(mesh.positions, positions, sizeof positions);
  memcpy(mesh.indices, indices, sizeof indices);
  int index = scene_add_mesh(scene, &mesh);
  if (index < 0 || scene_add_instance(scene, index, scene_from_object, 0, 1) < 0) return memory_error();
  return STATUS_OK;
}
