/* What the C in README.md and docs/ takes as given: the host's variables. */
#include <penumbra/penumbra.h>

#include <stdio.h>
#include <string.h>

extern pn_context *context;
extern pn_casters *casters;
extern pn_receiver *receiver;
extern pn_light *light, *lights[PN_FORWARD_LIGHTS_MAX];
extern pn_mesh mesh;
extern pn_instance instance;
extern pn_image visibility;
extern pn_gl vertices, indices, depth, normals, framebuffer, program, layers, leaf_texture;
extern size_t vertex_count, index_count;
extern float view[16], projection[16], scene_from_object[16], bounds[6], positions[300], texcoords[200];
extern int width, height;
extern void *engine;
void *engine_proc_address(void *user, const char *name);
void *engine_realloc(void *user, void *old, size_t bytes);
void engine_log(void *user, pn_log_level level, int message_id, const char *text);
void engine_draw_crowd(void *engine, const float *clip_from_scene, const float *planes, int plane_count);
