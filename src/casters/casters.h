/* What blocks light: meshes, instances, draw callbacks; and how a pass draws them. */
#ifndef PNI_CASTERS_CASTERS_H
#define PNI_CASTERS_CASTERS_H

#include "casters/mesh.h"
#include "context.h"
#include "gl/pass.h"
#include "space/matrix.h"

typedef struct {
  uint32_t id;
  int mesh; /* slot in meshes: stays while the instance does */
  int group;
  pni_matrix scene_from_object;
} pni_instance_data;

typedef struct {
  pn_draw_fn draw; /* NULL: none */
  void *user;
  pni_box bounds;
} pni_callback;

struct pn_casters {
  pni_object object;
  pni_mesh_data *meshes;
  int mesh_count, mesh_capacity;
  pni_instance_data *instances;
  int instance_count, instance_capacity;
  uint32_t next_id;
  unsigned checked; /* the number of the plan in which alpha textures were looked at */
  pni_callback callbacks[PN_GROUP_COUNT];
};

pni_mesh_data *pni_find_mesh(const pn_casters *casters, uint32_t id);

/* The matrix of the mesh's object space made that of the positions in its vertex buffer: composed in double, so that
 * what is large in the transform and in the mesh's centre cancels before anything is rounded. */
pni_matrix pni_from_vertex(const pni_mesh_data *mesh, const pni_matrix *from_object);

/* Calls visit with the eight corners, in scene space, of every box of every caster in groups. */
typedef void (*pni_box_visitor)(void *user, const double corners[8][3]);
void pni_casters_each_box(const pn_casters *casters, uint32_t groups, pni_box_visitor visit, void *user);

/* Whether a draw callback draws any of the groups. */
bool pni_casters_call_host(const pn_casters *casters, uint32_t groups);

/* Whether all of the mesh lies farther from the light than that. */
bool pni_mesh_beyond(const pni_mesh_data *mesh, const pni_matrix *light_from_object, double distance);

/* Whether the alpha textures that they draw with are still there: hosts delete textures. Draws that are planned look
 * themselves. */
pn_result pni_casters_check(const pn_casters *casters, uint32_t groups);

/* Draws all casters of groups into the pass that has begun. */
typedef struct {
  const pni_pass *pass; /* that one: it is taken up again after each of the host's callbacks */
  pni_matrix clip_from_scene;
  pni_matrix cull_from_scene; /* the same, or of the part of the map that counts */
  double distance[4];         /* from the light, of a point of the scene: its product with (x, y, z, 1) */
  double range;               /* what lies wholly beyond that distance casts nothing; 0: no limit */
  uint32_t groups;
  bool without_host;       /* callbacks are not called: their time is pn_maps_update */
  const float *floor;      /* a, b, c: meshes are drawn where depth < a x + b y + c in window coordinates; NULL: all */
  const pni_texture *peel; /* the previous layer, or NULL */
  int layer;
} pni_caster_draw;
pn_result pni_casters_draw_pass(pn_casters *casters, const pni_caster_draw *draw);

#endif
