/* The library's objects in one bundle: put up a scene, ask for visibility. */
#ifndef TEST_STAGE_H
#define TEST_STAGE_H

#include "view.h"

typedef struct {
  pn_context *context;
  pn_casters *casters;
  pn_receiver *receiver;
  pn_light *light;
  int messages[PN_MESSAGE_COUNT]; /* how often each was sent */
} stage;

#define assert_ok(call) assert_string_equal(pn_result_name(call), pn_result_name(PN_OK))

void stage_open(stage *s);
void stage_close(stage *s);
pn_mesh stage_mesh(stage *s, const soup *triangles);
/* A mesh of the triangles, placed where they are, in group 0. */
pn_instance stage_cast(stage *s, const soup *triangles);
void stage_receive(stage *s, const view *v, bool normals);

/* A rectangular light, or a sun with tangents half_u and half_v; the map square. */
pn_light_desc light_at(vec centre, vec direction, double half_u, double half_v, int map);
pn_light_desc sun_along(vec direction, double half_u, double half_v, int map);

/* Sets light and technique, draws maps and visibility; width x height floats, row 0 lowest, freed by the caller. */
float *stage_visibility(stage *s, const pn_light_desc *light, const char *technique);
/* Visibility from the maps there are. */
float *stage_look(stage *s);

/* The light's frame as the tests see it, by scene vectors. */
typedef struct {
  vec origin, u, v, z;
  double half_u, half_v;
  bool sun;
} light_axes;
light_axes axes_of(const pn_light_desc *light);
/* The vector from p to the light's point (a, b) in [-1, 1]^2: for a sun a direction. */
vec to_light(const light_axes *l, vec p, double a, double b);
/* Whether a surface at p with normal n faces all four corners of the light, by more than a sine of margin. */
bool faces_whole_light(const light_axes *l, vec p, vec n, double margin);

#endif
