/* gbuffer.h: what the camera sees, as the library wants it: depth, geometric normals, who receives. */
#ifndef PENUMBRA_APP_HOST_GBUFFER_H
#define PENUMBRA_APP_HOST_GBUFFER_H

#include "host/buffers.h"

struct gbuffer {
  int width, height;
  pn_gl framebuffer, depth, normal, mask; /* D32F, RGBA32F (scene space, turned to the camera), R8 */
  pn_gl program;
  float view[16], projection[16]; /* the view of scene space seen from scene.origin */
};

/* Draws the scene from its camera; near and far planes lie close to what is visible. Exit status. */
int gbuffer_create(const struct gpu_scene *gpu, struct gbuffer **out);
void gbuffer_free(struct gbuffer **gbuffer);

#endif
