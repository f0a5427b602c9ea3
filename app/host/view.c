#include "host/view.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "scene/setup.h"
#include "scene/vector.h"

/* eye = P^-1 (pixel, depth), scene = V^-1 eye, in double from the very matrices the library is given. V is a
 * rotation and a translation, up to rounding; its inverse is by cofactors, so that the rounding is undone too. */
struct unprojection {
  double p0, p5, p10, p14, inverse[3][3], translation[3];
};

static void prepare(const struct gbuffer *g, struct unprojection *u) {
  const float *v = g->view;
  u->p0 = g->projection[0];
  u->p5 = g->projection[5];
  u->p10 = g->projection[10];
  u->p14 = g->projection[14];
  double columns[3][3], cross[3];
  for (int c = 0; c < 3; c++)
    for (int r = 0; r < 3; r++) columns[c][r] = v[4 * c + r];
  v3_cross(columns[1], columns[2], cross);
  double determinant = v3_dot(columns[0], cross);
  for (int c = 0; c < 3; c++) {
    v3_cross(columns[(c + 1) % 3], columns[(c + 2) % 3], cross);
    for (int r = 0; r < 3; r++) u->inverse[c][r] = cross[r] / determinant; /* row c of the inverse */
    u->translation[c] = v[12 + c];
  }
}

static void unproject(const struct unprojection *u, double ndc_x, double ndc_y, double depth, float out[3]) {
  double w = u->p14 / (2 * depth - 1 + u->p10);
  double eye[3] = {ndc_x * w / u->p0, ndc_y * w / u->p5, -w};
  v3_sub(eye, u->translation, eye);
  for (int k = 0; k < 3; k++) out[k] = (float)v3_dot(u->inverse[k], eye);
}

/* How many corners of the light the surface faces; none where it does not lie in front of the light. What a surface
 * faces of a light is what lies above a plane, and a rectangle has a part there exactly if a corner is. */
static int corners_faced(const struct light *light, double corners[4][3], const double origin[3],
                         const float position[3], const float normal[3]) {
  double p[3], n[3], d[3];
  for (int k = 0; k < 3; k++) {
    p[k] = origin[k] + position[k];
    n[k] = normal[k];
  }
  if (light->shape == PN_LIGHT_RECTANGLE) {
    v3_sub(p, light->center, d);
    if (!(v3_dot(d, light->direction) > 0)) return 0;
  }
  int count = 0;
  for (int i = 0; i < 4; i++) {
    memcpy(d, corners[i], sizeof d);
    if (light->shape == PN_LIGHT_RECTANGLE) v3_sub(corners[i], p, d);
    count += v3_dot(n, d) > 0;
  }
  return count;
}

static int allocate(struct view *view) {
  size_t count = (size_t)view->width * (size_t)view->height;
  view->position = malloc(count * 3 * sizeof(float));
  view->normal = malloc(count * 3 * sizeof(float));
  view->mask = malloc(count * sizeof(float));
  view->faces = malloc(count);
  view->receives = malloc(count);
  return view->position && view->normal && view->mask && view->faces && view->receives;
}

struct raw {
  float *depth, *normal;
  uint8_t *mask;
};

static int read_raw(const struct gbuffer *g, struct raw *raw) {
  size_t count = (size_t)g->width * (size_t)g->height;
  raw->depth = malloc(count * sizeof(float));
  raw->normal = malloc(count * 3 * sizeof(float));
  raw->mask = malloc(count);
  if (!raw->depth || !raw->normal || !raw->mask) return 0;
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glBindTexture(GL_TEXTURE_2D, g->depth);
  glGetTexImage(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT, GL_FLOAT, raw->depth);
  glBindTexture(GL_TEXTURE_2D, g->normal);
  glGetTexImage(GL_TEXTURE_2D, 0, GL_RGB, GL_FLOAT, raw->normal);
  glBindTexture(GL_TEXTURE_2D, g->mask);
  glGetTexImage(GL_TEXTURE_2D, 0, GL_RED, GL_UNSIGNED_BYTE, raw->mask);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  return 1;
}

static void fill(struct view *view, const struct gbuffer *g, const struct light *light, const struct raw *raw) {
  struct unprojection u;
  double corners[4][3];
  prepare(g, &u);
  light_corners(light, corners);
  for (int y = 0; y < g->height; y++)
    for (int x = 0; x < g->width; x++) {
      size_t from = (size_t)y * (size_t)g->width + (size_t)x;
      size_t to = (size_t)(g->height - 1 - y) * (size_t)g->width + (size_t)x;
      float *p = &view->position[3 * to], *n = &view->normal[3 * to];
      view->receives[to] = view->faces[to] = 0;
      view->mask[to] = 0;
      for (int k = 0; k < 3; k++) p[k] = n[k] = NAN;
      if (!(raw->depth[from] < 1)) continue;
      unproject(&u, 2 * (x + 0.5) / g->width - 1, 2 * (y + 0.5) / g->height - 1, raw->depth[from], p);
      memcpy(n, &raw->normal[3 * from], 3 * sizeof *n);
      view->receives[to] = raw->mask[from] != 0;
      int faced = view->receives[to] ? corners_faced(light, corners, view->origin, p, n) : 0;
      view->faces[to] = faced > 0;
      view->mask[to] = faced == 4;
    }
}

int view_read(const struct gbuffer *g, const struct scene *scene, struct view **out) {
  *out = NULL;
  struct view *view = calloc(1, sizeof *view);
  struct raw raw = {0};
  if (view) {
    view->width = g->width;
    view->height = g->height;
    memcpy(view->origin, scene->origin, sizeof view->origin);
  }
  int ok = view && allocate(view) && read_raw(g, &raw);
  if (ok) fill(view, g, &scene->setup.light, &raw);
  else view_free(&view);
  free(raw.depth);
  free(raw.normal);
  free(raw.mask);
  *out = view;
  return ok ? STATUS_OK : memory_error();
}

void view_positions(const struct view *view, float *out) {
  for (size_t i = 0; i < 3 * (size_t)view->width * (size_t)view->height; i++)
    out[i] = (float)(view->origin[i % 3] + view->position[i]);
}

void view_free(struct view **view) {
  if (!view || !*view) return;
  free((*view)->position);
  free((*view)->normal);
  free((*view)->receives);
  free((*view)->faces);
  free((*view)->mask);
  free(*view);
  *view = NULL;
}
