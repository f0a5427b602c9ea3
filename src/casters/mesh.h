/* One mesh: from the host's description to buffers and bounds. */
#ifndef PN_CASTERS_MESH_H
#define PN_CASTERS_MESH_H

#include "casters/casters.h"

bool pn_box_sound(const float min[3], const float max[3]);
pn_result pn_mesh_check(pn_gpu *gpu, const pn_mesh_desc *desc);
pn_result pn_mesh_build(pn_gpu *gpu, const pn_mesh_desc *desc, pn_mesh_data *mesh);
pn_result pn_mesh_deform(pn_gpu *gpu, pn_mesh_data *mesh, const pn_span *positions, const float *bounds);
void pn_mesh_drop(pn_gpu *gpu, pn_mesh_data *mesh, bool abandon);

#endif
