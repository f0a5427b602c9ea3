/* Casters over a ground that only receives, seen from straight above under a light that looks down: the scene of closed
 * forms. */
#ifndef TEST_OVER_GROUND_H
#define TEST_OVER_GROUND_H

#include "stage.h"

/* The light looks down from (0, LIGHT_HEIGHT, 0); u is x, v is -z. The ground is y = 0. */
#define LIGHT_HEIGHT 4.0

typedef struct {
  stage s;
  view v;
  /* Filled before the scene is opened: casters, and the ground where it is not to be a wide one. */
  soup ground, casters;
  bool from_depth; /* the receiver has no normals */
} over_ground;

/* Straight from above: size x size pixels that reach half_height to each side. */
camera camera_over_ground(int size, double half_height);
void over_ground_open(over_ground *c, int size, double half_height);
/* The same scene seen by another camera. */
void over_ground_see(over_ground *c, const camera *k);
void over_ground_close(over_ground *c);
pn_light_desc light_over_ground(double half_u, double half_v, int map);

double clamped(double x, double low, double high);
/* Share of the light's [-half, half] that a plate [-plate, plate] at height h hides from x on the ground. */
double hidden_by_plate(double x, double half, double plate, double h);

#endif
