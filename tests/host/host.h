/* What every test of the client begins with: a GL context, a library context with a recording log, casters, a light. */
#ifndef HOST_HOST_H
#define HOST_HOST_H

#include <penumbra/penumbra.h>

#include "headless.h"
#include "renderer.h"

typedef struct {
  int counts[PN_MESSAGE_COUNT];
  int errors; /* of level PN_LOG_ERROR */
  char last[512];
} log_record;

typedef struct {
  headless window;
  scene world;
  renderer draw;
  log_record log;
  pn_context *context;
  pn_casters *casters;
  pn_mesh meshes[SCENE_MESHES];
  pn_instance instances[SCENE_MESHES];
  GLuint caster_programs[2]; /* without and with pn_peel() */
  int peeled_passes;         /* that the draw callback has seen */
} host;

/* GL, the scene and its buffers; 0 when there is no GL here. With a model (which becomes the host's) the scene is that
 * mesh alone. */
int host_open(host *self);
int host_open_compatible(host *self); /* in a compatibility context */
int host_open_model(host *self, const mesh *model);
void host_close(host *self);

/* A library context with the client's loader and log. */
pn_context_desc host_context_desc(host *self);
pn_result host_context(host *self);

/* cmocka's group fixtures around a host in *state; the test ends with 77 when there is no GL. */
int host_setup(void **state);
int host_teardown(void **state);

/* After each test: no GL error may be left. */
int host_check(void **state);

/* What casts, in three ways. */
typedef enum { CAST_MEMORY, CAST_BUFFERS, CAST_CALLBACK } cast_kind;
pn_result host_cast(host *self, cast_kind kind);
pn_mesh_desc host_mesh_desc(const host *self, int index, cast_kind kind);
void host_uncast(host *self);

/* The light of most tests: above the scene, tilted, 256 x 256 maps; and one that differs in everything. */
pn_light_desc host_light_desc(void);
pn_light_desc host_light_desc_other(void);
pn_light_desc host_sun_desc(void);
pn_result host_light(host *self, const pn_light_desc *desc, const char *technique, pn_light **out);

/* A camera's target with the scene's depth drawn, and its receiver. */
typedef struct {
  camera view;
  depth_target target;
  pn_receiver *receiver;
} camera_view;
pn_receiver_desc host_receiver_desc(const camera *view, const depth_target *target);
pn_result host_view(host *self, const camera *view, camera_view *out);
void host_view_close(camera_view *self);

/* What many tests begin with: the scene cast so, seen by camera_at(0), under one light. */
typedef struct {
  camera_view v;
  pn_light *light;
} lit_view;
pn_result host_lit_view(host *self, cast_kind kind, const pn_light_desc *desc, const char *technique, lit_view *out);
void host_lit_view_close(host *self, lit_view *lit);

/* Maps and visibility; the pair's result, width * height floats from the bottom row, malloced; NULL when anything
 * fails. */
float *host_visibility(host *self, pn_light *light, const camera_view *view);
float *host_result(pn_light *light, pn_receiver *receiver);

/* Bytes that the library holds in GL. */
size_t host_gpu_memory(const host *self);

/* Specs that between them take every way through the library: each technique of the list, what its parameters draw
 * differently, few samples where many take their time. NULL past the last. */
const char *host_spec(int index);

#endif
