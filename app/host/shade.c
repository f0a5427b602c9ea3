#include "host/shade.h"

#include <math.h>
#include <string.h>

#include "scene/setup.h"
#include "scene/vector.h"

static const float background = 0.05f, ambient = 0.02f;
static const double lit_level = 0.8;

/* The polygon's part above the horizon of the unit normal n, corners relative to the point. */
static int clip_at_horizon(double corners[4][3], const double n[3], double out[8][3]) {
  int count = 0;
  for (int i = 0; i < 4; i++) {
    const double *a = corners[i], *b = corners[(i + 1) % 4];
    double ha = v3_dot(a, n), hb = v3_dot(b, n);
    if (ha >= 0) memcpy(out[count++], a, 3 * sizeof *a);
    if ((ha >= 0) != (hb >= 0)) {
      double t = ha / (ha - hb);
      for (int k = 0; k < 3; k++) out[count][k] = a[k] + t * (b[k] - a[k]);
      count++;
    }
  }
  return count;
}

/* Lambert's edge sum: each edge adds its angle times the cosine between n and the normal of the plane through the
 * edge. */
static double edge_sum(double polygon[8][3], int count, const double n[3]) {
  double sum = 0;
  for (int i = 0; i < count; i++) {
    const double *a = polygon[i], *b = polygon[(i + 1) % count];
    double c[3];
    v3_cross(a, b, c);
    double sine = v3_length(c);
    if (sine > 0) sum += atan2(sine, v3_dot(a, b)) * v3_dot(c, n) / sine;
  }
  return fabs(sum) / (2 * 3.14159265358979323846);
}

double light_form_factor(const struct light *light, const double position[3], const double normal[3]) {
  if (light->shape == PN_LIGHT_SUN) return fmax(0, -v3_dot(normal, light->direction));
  double corners[4][3], d[3], polygon[8][3];
  v3_sub(position, light->center, d);
  if (!(v3_dot(d, light->direction) > 0)) return 0;
  light_corners(light, corners);
  for (int i = 0; i < 4; i++) v3_sub(corners[i], position, corners[i]);
  int count = clip_at_horizon(corners, normal, polygon);
  return count < 3 ? 0 : edge_sum(polygon, count, normal);
}

/* What makes a lit surface at the target, facing the light, lit_level bright. */
static double exposure(const struct light *light) {
  double toward[3] = {-light->direction[0], -light->direction[1], -light->direction[2]};
  double factor = light_form_factor(light, light->target, toward);
  return factor > 0 ? lit_level / factor : lit_level;
}

void shade_unoccluded(const struct view *view, const struct light *light, float *out) {
  double scale = exposure(light);
  for (size_t i = 0; i < (size_t)view->width * (size_t)view->height; i++) {
    double p[3], n[3];
    for (int k = 0; k < 3; k++) {
      p[k] = view->origin[k] + view->position[3 * i + (size_t)k];
      n[k] = view->normal[3 * i + (size_t)k];
    }
    out[i] = isnan(p[0]) ? -1 : (float)(scale * light_form_factor(light, p, n));
  }
}

void shade_with(const float *unoccluded, const float *visibility, size_t count, float *rgb) {
  for (size_t i = 0; i < count; i++) {
    float value = unoccluded[i] < 0 ? background : unoccluded[i] * visibility[i] + ambient;
    rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = value;
  }
}

void shade(const struct view *view, const struct light *light, const float *visibility, float *rgb) {
  size_t count = (size_t)view->width * (size_t)view->height;
  /* The first third of the output holds the light until the pixels are spread, from the last one on. */
  shade_unoccluded(view, light, rgb);
  for (size_t i = count; i-- > 0;) {
    float lit = rgb[i];
    shade_with(&lit, &visibility[i], 1, &rgb[3 * i]);
  }
}
