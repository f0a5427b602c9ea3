#include "casters/rounding.h"

#include <math.h>

static void add_map(pni_rounding *rounding, const pni_matrix *light_from_object, const pni_box *box) {
  double lost[3];
  pni_box_rounding(light_from_object, box->min, box->max, lost);
  for (int i = 0; i < 3; i++) rounding->map[i] = fmax(rounding->map[i], lost[i]);
}

static void add_host(pni_rounding *rounding, const pni_matrix *scene_from_object, const pni_box *box) {
  double lost[3];
  pni_box_rounding(scene_from_object, box->min, box->max, lost);
  rounding->host = fmax(rounding->host, sqrt(lost[0] * lost[0] + lost[1] * lost[1] + lost[2] * lost[2]));
}

pni_rounding pni_casters_rounding(const pn_casters *casters, uint32_t groups, const pni_frame *frame) {
  pni_rounding rounding = {{0}, 0, 0};
  pni_matrix light_from_scene = pni_light_from_scene(frame);
  for (int i = 0; i < casters->instance_count; i++) {
    const pni_instance_data *instance = &casters->instances[i];
    const pni_mesh_data *mesh = &casters->meshes[instance->mesh];
    if (!(groups >> instance->group & 1) || mesh->box_count == 0) continue;
    add_host(&rounding, &instance->scene_from_object, &mesh->whole);
    if (mesh->own_positions.id) continue; /* seen from its middle */
    pni_matrix light_from_object = pni_matrix_multiply(&light_from_scene, &instance->scene_from_object);
    add_map(&rounding, &light_from_object, &mesh->whole);
  }
  for (int group = 0; group < PN_GROUP_COUNT; group++)
    if (casters->callbacks[group].draw && (groups >> group & 1))
      add_map(&rounding, &light_from_scene, &casters->callbacks[group].bounds);
  return rounding;
}
