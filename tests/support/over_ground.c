#include "over_ground.h"

camera camera_over_ground(int size, double half_height) {
  return (camera){.width = size,
                  .height = size,
                  .eye = v3(0.013, 10, 0.007),
                  .target = v3(0.013, 0, 0.007),
                  .up = v3(0, 0, -1),
                  .orthographic = true,
                  .half_height = half_height,
                  .near = 1,
                  .far = 20};
}

void over_ground_open(over_ground *c, int size, double half_height) {
  camera k = camera_over_ground(size, half_height);
  over_ground_see(c, &k);
}

void over_ground_see(over_ground *c, const camera *k) {
  if (!c->ground.count) soup_patch(&c->ground, v3(0, 0, 0), v3(9, 0, 0), v3(0, 0, 9));
  view_draw(&c->v, k, &c->ground);
  stage_open(&c->s);
  if (c->casters.count) stage_cast(&c->s, &c->casters);
  stage_receive(&c->s, &c->v, !c->from_depth);
}

void over_ground_close(over_ground *c) {
  stage_close(&c->s);
  view_free(&c->v);
  soup_free(&c->ground);
  soup_free(&c->casters);
}

pn_light_desc light_over_ground(double half_u, double half_v, int map) {
  return light_at(v3(0, LIGHT_HEIGHT, 0), v3(0, -1, 0), half_u, half_v, map);
}

double clamped(double x, double low, double high) { return fmin(fmax(x, low), high); }

double hidden_by_plate(double x, double half, double plate, double h) {
  double k = h / LIGHT_HEIGHT, from = (-plate - x * (1 - k)) / k, to = (plate - x * (1 - k)) / k;
  return (clamped(to, -half, half) - clamped(from, -half, half)) / (2 * half);
}
