/* view.h: what the camera sees, read back: what errors are measured over and what is shaded. */
#ifndef PENUMBRA_APP_HOST_VIEW_H
#define PENUMBRA_APP_HOST_VIEW_H

#include "host/gbuffer.h"

/* The G-buffer on the CPU, top row first. Background: NaN positions and normals, mask and receives 0. */
struct view {
  int width, height;
  float *position;   /* 3 a pixel, scene space seen from origin */
  double origin[3];  /* the scene's */
  float *normal;     /* 3 a pixel, unit, turned to the camera */
  uint8_t *receives; /* the surface receives */
  uint8_t *faces;    /* 1 where the surface receives and faces any of the light, else 0 */
  float *mask;       /* contract: 1 where the surface receives and faces all of the light, else 0 */
};
int view_read(const struct gbuffer *gbuffer, const struct scene *scene, struct view **out);
void view_free(struct view **view);

/* In scene space, three a pixel, as near as floats come to it: they are coarse where the scene lies far away. */
void view_positions(const struct view *view, float *out);

#endif
