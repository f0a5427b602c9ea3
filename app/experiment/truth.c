#include "experiment/truth.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "base/progress.h"
#include "reference/cache.h"
#include "reference/reference.h"
#include "scene/vector.h"

/* What the tracer is given, and what has to be freed afterwards. */
struct inputs {
  struct reference_casters casters;
  struct reference_light light;
  struct reference_points points;
  struct reference_mesh *meshes;
  struct reference_instance *instances;
  struct reference_alpha *textures;
  float *errors;
};

static void free_inputs(struct inputs *in) {
  free(in->meshes);
  free(in->instances);
  free(in->textures);
  free(in->errors);
}

static void fill_textures(struct inputs *in, const struct scene *scene) {
  static const enum reference_wrap wraps[] = {
      [WRAP_REPEAT] = REFERENCE_REPEAT, [WRAP_CLAMP] = REFERENCE_CLAMP, [WRAP_MIRROR] = REFERENCE_MIRROR};
  for (int i = 0; i < scene->texture_count; i++) {
    const struct texture *t = &scene->textures[i];
    in->textures[i] = (struct reference_alpha){t->width, t->height, t->alpha, wraps[t->wrap_u], wraps[t->wrap_v]};
  }
}

static void fill_casters(struct inputs *in, const struct scene *scene) {
  for (int i = 0; i < scene->mesh_count; i++) {
    const struct mesh *m = &scene->meshes[i];
    in->meshes[i] = (struct reference_mesh){.positions = m->positions,
                                            .indices = m->indices,
                                            .texcoords = m->texcoords,
                                            .vertex_count = m->vertex_count,
                                            .triangle_count = m->triangle_count,
                                            .alpha = m->texture >= 0 ? &in->textures[m->texture] : NULL,
                                            .cutoff = m->cutoff};
  }
  in->casters = (struct reference_casters){in->meshes, in->instances, scene->mesh_count, 0};
  for (int i = 0; i < scene->instance_count; i++) {
    const struct instance *instance = &scene->instances[i];
    if (!instance->casts) continue;
    struct reference_instance *to = &in->instances[in->casters.instance_count++];
    to->mesh = instance->mesh;
    memcpy(to->scene_from_object, instance->placed, sizeof to->scene_from_object);
  }
}

/* Seen from where points and casters are. */
static void fill_light(struct reference_light *to, const struct light *light, const double origin[3]) {
  to->shape = light->shape == PN_LIGHT_SUN ? REFERENCE_SUN : REFERENCE_RECTANGLE;
  v3_sub(light->center, origin, to->center);
  memcpy(to->direction, light->direction, sizeof to->direction);
  memcpy(to->u, light->u, sizeof to->u);
  memcpy(to->v, light->v, sizeof to->v);
  memcpy(to->half, light->half, sizeof to->half);
}

/* How far a point may lie from its surface.
 *
 *     depth       at eye distance z the window depth d, a float of 24 bits made by a few float operations, is off by
 *                 2^-22; z by that times |dz/dd| = 2 z^2 / |P[14]|
 *     rasteriser  vertices are moved to a grid of 2^-bits pixels before they are filled, the surface with them by
 *                 half a step; a pixel is 2 z / (P[5] height) wide
 *
 * Both move the point by no more than that along the normal. Rounding of the coordinates is the tracer's concern. */
static float point_error(const struct gbuffer *g, const float *p, double subpixel) {
  double z = -((double)g->view[2] * p[0] + (double)g->view[6] * p[1] + (double)g->view[10] * p[2] + g->view[14]);
  double depth = 0x1p-22 * 2 * z * z / fabs((double)g->projection[14]);
  return (float)(depth + 0.5 * subpixel * 2 * z / (g->projection[5] * (double)g->height));
}

static void fill_points(struct inputs *in, const struct gbuffer *g, const struct view *view) {
  GLint bits = 0;
  glGetIntegerv(GL_SUBPIXEL_BITS, &bits);
  double subpixel = ldexp(1, bits >= 4 && bits <= 24 ? -bits : -4);
  for (size_t i = 0; i < (size_t)view->width * (size_t)view->height; i++) {
    const float *p = view->position + 3 * i;
    in->errors[i] = isfinite(p[0]) ? point_error(g, p, subpixel) : 0;
  }
  in->points =
      (struct reference_points){view->width, view->height, view->position, view->normal, view->receives, in->errors};
}

static int fill_inputs(struct inputs *in, const struct scene *scene, const struct gbuffer *g, const struct view *view) {
  memset(in, 0, sizeof *in);
  in->meshes = calloc((size_t)scene->mesh_count + 1, sizeof *in->meshes);
  in->instances = calloc((size_t)scene->instance_count + 1, sizeof *in->instances);
  in->textures = calloc((size_t)scene->texture_count + 1, sizeof *in->textures);
  in->errors = malloc((size_t)view->width * (size_t)view->height * sizeof *in->errors);
  if (!in->meshes || !in->instances || !in->textures || !in->errors) return memory_error();
  fill_textures(in, scene);
  fill_casters(in, scene);
  fill_light(&in->light, &scene->setup.light, scene->origin);
  fill_points(in, g, view);
  return STATUS_OK;
}

static int show_progress(void *user, double fraction, double seconds_left) {
  (void)user;
  (void)seconds_left; /* the bar tells the same */
  progress_update(fraction);
  return 0; /* Ctrl-C ends the program itself */
}

static int trace(const struct inputs *in, int samples, float *visibility, struct reference_result *result) {
  struct reference_options options = {.samples = samples, .progress = show_progress};
  progress_begin("tracing the reference");
  enum reference_status status = reference_trace(&in->casters, &in->light, &in->points, &options, visibility, result);
  progress_end();
  if (status == REFERENCE_OK) return STATUS_OK;
  if (status == REFERENCE_MEMORY) return memory_error();
  return work_error("the reference could not be traced: %s", reference_status_text(status));
}

/* From the cache, or traced and then kept there. */
static int find_or_trace(const struct inputs *in, int samples, int use_cache, struct truth *out,
                         struct reference_result *result) {
  size_t count = (size_t)in->points.width * (size_t)in->points.height;
  char why[5000] = "";
  struct digest key = {{0}};
  if (use_cache) {
    key = cache_key(&in->casters, &in->light, &in->points, samples);
    out->from_cache = cache_load(&key, count, out->visibility, result, why, sizeof why);
    if (out->from_cache) return STATUS_OK;
    if (*why) warning("%s", why);
  }
  int warned = *why != 0, status = trace(in, samples, out->visibility, result);
  if (!status && use_cache && !cache_store(&key, count, out->visibility, result, why, sizeof why) && !warned)
    warning("%s", why);
  return status;
}

int truth_trace(const struct scene *scene, const struct gbuffer *g, const struct view *view, int samples, int use_cache,
                struct truth *out) {
  memset(out, 0, sizeof *out);
  struct inputs in;
  struct reference_result result = {0, 0};
  int status = fill_inputs(&in, scene, g, view);
  out->visibility = malloc((size_t)view->width * (size_t)view->height * sizeof *out->visibility);
  if (!status && !out->visibility) status = memory_error();
  if (!status) status = find_or_trace(&in, samples, use_cache, out, &result);
  free_inputs(&in);
  out->seconds = result.seconds;
  out->rays = (double)result.rays;
  if (status) {
    free(out->visibility);
    out->visibility = NULL;
  }
  return status;
}
