/* Camera views of every kind a host may have: how it projects, how it stores depth, and where in its target it looks.
 * */
#ifndef HOST_CAMERA_H
#define HOST_CAMERA_H

#include "linear.h"

enum { CAMERA_WIDTH = 320, CAMERA_HEIGHT = 240 };

typedef struct {
  const char *name;
  float view[16], projection[16];
  unsigned format; /* GL's sized depth format */
  int samples;     /* 0: not multisampled */
  int renderbuffer;
  int zero_to_one, reversed;
  int x, y, width, height;         /* the view in its target */
  int target_width, target_height; /* of the target */
  int crop_x, crop_y;              /* where the view's lower left pixel lies in the baseline's picture */
  int same_rays;                   /* each pixel sees what the baseline's pixel sees */
} camera;

enum { CAMERA_COUNT = 17 };

/* Tangent of half the vertical field of view. */
extern const double camera_fov_tangent;

/* Camera 0 is the baseline: perspective, D32F, 320 x 240. */
camera camera_at(int index);

/* The same view in fewer pixels, which fill its target. */
camera camera_sized(int index, int width, int height);

/* The baseline seen from elsewhere. */
camera camera_from(vec3 eye, vec3 target);

/* clip from scene, composed in double of the rounded matrices that the library gets too. */
mat4 camera_clip(const camera *self);

/* How far, in pixels of the view, the point that depth d stands for can be from the true one: half of depth's quantum
 * and of what interpolation rounds away, as a movement along the view ray, over the pixel's size there. */
double camera_depth_error(const camera *self, double d);

#endif
