#include "maps/trim.h"

#include <math.h>
#include <string.h>

#include "gl/device.h"
#include "gl/host.h"

/* Samples along each axis, and how often they are drawn, each time over what the last one left. */
enum { SIZE = 256, TIMES_MAX = 3 };
/* Left is much less where it is narrower than that. */
static const double much_less = 0.5;

/* ---- what counts ------------------------------------------------------------------------------------------------- */

/* So many samples at most are held against what is seen, before the rest is taken to count: a rough ground that shadows
 * nothing must not hold up the frame. */
enum { QUESTIONS_MAX = 1 << 14 };

typedef struct {
  const pni_trim_image *image;
  const pni_grid *grid;
  double cell[2];
  int questions;
} search;

static search search_of(const pni_trim_image *image, const pni_grid *grid) {
  search f = {image, grid, {0, 0}, 0};
  for (int i = 0; i < 2; i++) f.cell[i] = (image->bounds[i + 2] - image->bounds[i]) / image->size;
  return f;
}

static bool sample_at(const search *f, int x, int y, double out[3]) {
  out[0] = f->image->bounds[0] + (x + 0.5) * f->cell[0];
  out[1] = f->image->bounds[1] + (y + 0.5) * f->cell[1];
  out[2] = f->image->w[(size_t)y * (size_t)f->image->size + (size_t)x];
  return !pni_is_nothing(out[2]);
}

static bool below_floor(const pni_trim_image *image, const double p[3]) {
  const double *f = image->floor;
  if (!f) return false;
  double slack = image->error.w + fabs(f[0]) * image->error.place[0] + fabs(f[1]) * image->error.place[1];
  return p[2] <= f[0] * p[0] + f[1] * p[1] + f[2] + slack;
}

static bool counts(search *f, int x, int y) {
  double point[1][3];
  if (!sample_at(f, x, y, point[0]) || below_floor(f->image, point[0])) return false;
  if (++f->questions > QUESTIONS_MAX) return true;
  return pni_grid_shadowed(f->grid, (const double(*)[3])point, 1, &f->image->error);
}

/* Whether any sample between first and last, both included, of a row or column counts. */
static bool line_counts(search *f, bool row, int at, int first, int last) {
  for (int i = first; i <= last; i++)
    if (row ? counts(f, i, at) : counts(f, at, i)) return true;
  return false;
}

bool pni_trim_bounds(const pni_trim_image *image, const pni_grid *grid, double out[4]) {
  search f = search_of(image, grid);
  int last = image->size - 1, low[2] = {0, 0}, high[2] = {last, last};
  while (low[1] <= last && !line_counts(&f, true, low[1], 0, last)) low[1]++;
  if (low[1] > last) return false;
  while (!line_counts(&f, true, high[1], 0, last)) high[1]--;
  while (!line_counts(&f, false, low[0], low[1], high[1])) low[0]++;
  while (!line_counts(&f, false, high[0], low[1], high[1])) high[0]--;
  for (int i = 0; i < 2; i++) { /* an edge lies before the centre of the next sample, or past the image */
    out[i] = low[i] == 0 ? image->bounds[i] : image->bounds[i] + (low[i] - 0.5) * f.cell[i];
    out[i + 2] = high[i] == last ? image->bounds[i + 2] : image->bounds[i] + (high[i] + 1.5) * f.cell[i];
  }
  return true;
}

/* ---- the image --------------------------------------------------------------------------------------------------- */

typedef struct {
  pni_gpu *gpu;
  pni_texture *images; /* depth; w */
  const pni_trim_request *request;
} trimming;

static pn_result draw_casters(const trimming *t, const double bounds[4]) {
  static const double centre[2] = {0, 0};
  const pni_trim_request *r = t->request;
  pni_matrix clip = pni_clip_from_light(r->frame->projection, bounds, r->fit->w_near, r->fit->w_far, centre);
  pni_matrix light = pni_light_from_scene(r->frame);
  pni_pass pass = {.name = "casters that count",
                   .depth = pni_image_of(&t->images[0], 0, 0),
                   .width = SIZE,
                   .height = SIZE,
                   .depth_clamp = true,
                   .depth_use = PNI_DEPTH_NEAREST,
                   .depth_range = {PNI_DEPTH_MARGIN, 1 - PNI_DEPTH_MARGIN}};
  pn_result result = pni_pass_begin(t->gpu, &pass);
  if (result != PN_OK) return result;
  pni_caster_draw draw = {
      .pass = &pass, .clip_from_scene = pni_matrix_multiply(&clip, &light), .groups = r->groups, .range = r->range};
  draw.cull_from_scene = draw.clip_from_scene;
  for (int c = 0; c < 4; c++) draw.distance[c] = light.m[4 * c + 2];
  return pni_casters_draw_pass(r->casters, &draw);
}

static pn_result draw_w(const trimming *t) {
  double scale[2];
  pni_depth_scale(t->request->fit->w_near, t->request->fit->w_far, scale);
  pni_pass pass = {.name = "casters that count, w",
                   .program = {.fragment = "maps/trim.frag.glsl"},
                   .color = {pni_image_of(&t->images[1], 0, 0)},
                   .width = SIZE,
                   .height = SIZE};
  pn_result result = pni_pass_begin(t->gpu, &pass);
  if (result != PN_OK) return result;
  const float w_of_depth[4] = {(float)scale[0], (float)scale[1], 0, 0};
  pni_set_floats(t->gpu, "pn_w_of_depth", w_of_depth);
  pni_set_texture(t->gpu, "pn_map", &t->images[0]);
  pni_draw_screen(t->gpu);
  return PN_OK;
}

/* Whether any sample lies on the plane or below, or so much above it. */
static bool any_below(const pni_trim_image *image, const double plane[3], double above) {
  search f = search_of(image, NULL);
  pni_trim_image with = *image;
  with.floor = plane;
  with.error.w += above;
  for (int y = 0; y < image->size; y++)
    for (int x = 0; x < image->size; x++) {
      double p[3];
      if (sample_at(&f, x, y, p) && below_floor(&with, p)) return true;
    }
  return false;
}

/* The same errors as of the maps that are drawn for good (docs/space.md). */
static pni_caster_error image_error(const trimming *t, const double bounds[4]) {
  double near = t->request->fit->w_near, far = t->request->fit->w_far;
  pni_caster_error error = {.w = (near - far) * 0x1p-21 + fmax(fabs(near), fabs(far)) * 0x1p-22};
  for (int i = 0; i < 2; i++) {
    double texel = (bounds[i + 2] - bounds[i]) / SIZE;
    error.place[i] =
        texel * ldexp(1, -t->gpu->can.subpixel_bits) + fmax(fabs(bounds[i]), fabs(bounds[i + 2])) * 0x1p-22;
  }
  return error;
}

/* The plane need not be known better than that to be asked about: a part of the range of w. */
static const double close = 1e-3;

static pn_result find_floor(const trimming *t, const pni_trim_image *image, double floor[3], bool *found) {
  const pni_trim_request *r = t->request;
  *found = pni_grid_plane(r->grid, floor) && any_below(image, floor, close * (r->fit->w_near - r->fit->w_far));
  return *found ? r->lower(r->user, floor, found) : PN_OK;
}

static pn_result draw_image(const trimming *t, float *w, pni_trim_image *image) {
  pn_result result = draw_casters(t, image->bounds);
  if (result == PN_OK) result = draw_w(t);
  if (result != PN_OK) return result;
  pni_texture_read(t->gpu, &t->images[1], 0, 0, SIZE, SIZE, 1, w);
  image->w = w;
  image->size = SIZE;
  image->error = image_error(t, image->bounds);
  return PN_OK;
}

static pn_result shape(pni_gpu *gpu, pni_texture images[2]) {
  pn_result result = pni_texture_shape(gpu, &images[0], "casters that count", PNI_DEPTH32F, SIZE, SIZE, 0, 1);
  if (result != PN_OK) return result;
  return pni_texture_shape(gpu, &images[1], "casters that count, w", PNI_R32F, SIZE, SIZE, 0, 1);
}

static bool much_narrower(const double a[4], const double b[4]) {
  return a[2] - a[0] < much_less * (b[2] - b[0]) || a[3] - a[1] < much_less * (b[3] - b[1]);
}

static pn_result trim_with(const trimming *t, float *w, pni_fit_kept *out) {
  pni_trim_image image = {0};
  memcpy(image.bounds, t->request->fit->bounds, sizeof image.bounds);
  bool again = true, has_floor = false;
  for (int i = 0; i < TIMES_MAX && again; i++) {
    pn_result result = draw_image(t, w, &image);
    if (result == PN_OK && i == 0) result = find_floor(t, &image, out->floor, &has_floor);
    if (result != PN_OK) return result;
    image.floor = has_floor ? out->floor : NULL;
    out->has_floor = has_floor && any_below(&image, out->floor, 0);
    for (int k = 0; k < 2; k++) out->cell[k] = (image.bounds[k + 2] - image.bounds[k]) / SIZE;
    double left[4];
    if (!pni_trim_bounds(&image, t->request->grid, left)) break;
    again = much_narrower(left, image.bounds);
    memcpy(out->bounds, left, sizeof left);
    memcpy(image.bounds, left, sizeof left);
  }
  return PN_OK;
}

pn_result pni_trim(pni_gpu *gpu, pni_texture images[2], const pni_trim_request *request, pni_fit_kept *out) {
  trimming t = {gpu, images, request};
  pn_result result = shape(gpu, images);
  float *w = result == PN_OK ? pni_reallocate(gpu, NULL, (size_t)SIZE * SIZE * sizeof *w) : NULL;
  if (!w) return result == PN_OK ? PN_ERROR_OUT_OF_MEMORY : result;
  *out = (pni_fit_kept){.bounds = {INFINITY, INFINITY, -INFINITY, -INFINITY}};
  result = trim_with(&t, w, out);
  pni_free(gpu, w);
  return result;
}
