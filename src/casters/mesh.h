/* One mesh: from the host's description to buffers and bounds. */
#ifndef PN_CASTERS_MESH_H
#define PN_CASTERS_MESH_H

#include "casters/casters.h"

bool pni_box_sound(const float min[3], const float max[3]);
pn_result pni_mesh_check(pni_gpu *gpu, const pn_mesh_desc *desc);
pn_result pni_mesh_build(pni_gpu *gpu, const pn_mesh_desc *desc, pni_mesh_data *mesh);
pn_result pni_mesh_deform(pni_gpu *gpu, pni_mesh_data *mesh, const pn_span *positions, const float *bounds);
void pni_mesh_drop(pni_gpu *gpu, pni_mesh_data *mesh, bool abandon);

#endif
