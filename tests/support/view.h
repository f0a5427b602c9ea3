/* A camera's view of a soup, drawn with GL as a host would: depth, normals, and which triangle each pixel shows. */
#ifndef TEST_VIEW_H
#define TEST_VIEW_H

#include <stdbool.h>
#include <penumbra/penumbra.h>

#include "gl_context.h"
#include "soup.h"

typedef struct {
  int width, height;
  vec eye, target, up;
  bool orthographic;
  double half_height;  /* perspective: tangent of half the vertical angle; orthographic: scene units */
  double near, far;
  bool reversed;       /* depth 1 near, 0 far, clip depth zero to one */
  GLenum depth_format; /* 0 = GL_DEPTH_COMPONENT32F */
} camera;

typedef struct {
  camera camera;
  const soup *surfaces;
  float view[16], projection[16];
  GLuint depth, normal;
  int *shown;     /* index of the triangle a pixel shows, -1 where there is none; row 0 is GL's lowest */
  float *depths;  /* as stored */
} view;

void view_draw(view *v, const camera *c, const soup *surfaces);
void view_free(view *v);
/* The receiver's description; normals: whether the normal texture goes with it. Results are R32F. */
pn_receiver_desc view_desc(const view *v, bool normals);

/* The exact point of the triangle's plane under the pixel's centre, from the ray that the two float matrices define. */
vec view_point(const view *v, int x, int y);
/* Unit normal of the surface at a pixel, turned to the camera. */
vec view_normal(const view *v, int x, int y);
static inline int view_shown(const view *v, int x, int y) { return v->shown[y * v->camera.width + x]; }
/* Whether the pixels within distance (in both axes) all show triangles of the same plane. */
bool view_flat_around(const view *v, int x, int y, int distance);

#endif
