#include "scene/scene.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/vector.h"

void mesh_free(struct mesh *mesh) {
  free(mesh->positions);
  free(mesh->texcoords);
  free(mesh->indices);
  memset(mesh, 0, sizeof *mesh);
}

void scene_free(struct scene **scene) {
  if (!scene || !*scene) return;
  struct scene *s = *scene;
  for (int i = 0; i < s->mesh_count; i++) mesh_free(&s->meshes[i]);
  for (int i = 0; i < s->texture_count; i++) free(s->textures[i].alpha);
  free(s->meshes);
  free(s->textures);
  free(s->instances);
  free(s->name);
  free(s);
  *scene = NULL;
}

struct scene *scene_new(const char *name) {
  struct scene *scene = calloc(1, sizeof *scene);
  if (!scene) return NULL;
  scene->name = strdup(name);
  if (!scene->name) scene_free(&scene);
  return scene;
}

/* Room for one element more in an array that grows by doubling. */
static int grow(void **array, int count, size_t element) {
  if (count & (count - 1)) return 0;
  void *grown = realloc(*array, element * (count ? (size_t)count * 2 : 1));
  if (!grown) return -1;
  *array = grown;
  return 0;
}

/* Where a mesh lies farther from 0 than it is wide, its coordinates are taken from its middle. Nothing is rounded: a
 * float minus another that is between half and twice it is a float. */
static void center_mesh(struct mesh *mesh) {
  for (int k = 0; k < 3; k++) {
    float low = FLT_MAX, high = -FLT_MAX;
    float *p = mesh->positions + k;
    for (size_t i = 0; i < mesh->vertex_count; i++) {
      low = fminf(low, p[3 * i]);
      high = fmaxf(high, p[3 * i]);
    }
    float middle = (float)(0.5 * ((double)low + high));
    if ((double)high - low > 0.5 * fmax(fabs(low), fabs(high))) middle = 0;
    for (size_t i = 0; middle != 0 && i < mesh->vertex_count; i++) p[3 * i] -= middle;
    mesh->center[k] = middle;
    mesh->bounds_min[k] = low - middle;
    mesh->bounds_max[k] = high - middle;
  }
}

int scene_add_mesh(struct scene *scene, struct mesh *mesh) {
  if (grow((void **)&scene->meshes, scene->mesh_count, sizeof *scene->meshes)) {
    mesh_free(mesh);
    return -1;
  }
  center_mesh(mesh);
  scene->meshes[scene->mesh_count] = *mesh;
  return scene->mesh_count++;
}

int scene_add_instance(struct scene *scene, int mesh, const double m[16], int casts, int receives) {
  static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  if (grow((void **)&scene->instances, scene->instance_count, sizeof *scene->instances)) return -1;
  struct instance *instance = &scene->instances[scene->instance_count];
  *instance = (struct instance){.mesh = mesh, .casts = casts, .receives = receives};
  memcpy(instance->scene_from_object, m ? m : identity, sizeof identity);
  return scene->instance_count++;
}

int scene_add_texture(struct scene *scene, const struct texture *texture) {
  if (grow((void **)&scene->textures, scene->texture_count, sizeof *scene->textures)) {
    free(texture->alpha);
    return -1;
  }
  scene->textures[scene->texture_count] = *texture;
  return scene->texture_count++;
}

void instance_bounds(const struct scene *scene, const struct instance *instance, double low[3], double high[3]) {
  const struct mesh *mesh = &scene->meshes[instance->mesh];
  const double *m = instance->scene_from_object;
  int tight = mesh->vertex_count <= 1u << 22;
  for (int k = 0; k < 3; k++) {
    low[k] = DBL_MAX;
    high[k] = -DBL_MAX;
  }
  uint32_t count = tight ? mesh->vertex_count : 8;
  for (uint32_t i = 0; i < count; i++) {
    double p[3], q[3];
    for (int k = 0; k < 3; k++)
      p[k] = mesh->center[k] +
             (tight ? mesh->positions[3 * (size_t)i + k] : (i >> k & 1 ? mesh->bounds_max[k] : mesh->bounds_min[k]));
    m4_point(m, p, q);
    for (int k = 0; k < 3; k++) {
      low[k] = fmin(low[k], q[k]);
      high[k] = fmax(high[k], q[k]);
    }
  }
}

/* Composed in double: what is large in a transform and in a mesh's centre cancels before anything is rounded. */
static void place(const struct scene *scene, struct instance *instance) {
  const double *m = instance->scene_from_object;
  double at[3];
  m4_point(m, scene->meshes[instance->mesh].center, at);
  for (int i = 0; i < 12; i++) instance->placed[i] = (float)m[i];
  for (int k = 0; k < 3; k++) instance->placed[12 + k] = (float)(at[k] - scene->origin[k]);
  instance->placed[15] = 1;
}

/* A scene that lies farther away than twice its size is seen from its middle. */
static void choose_origin(struct scene *scene) {
  double extent = scene_extent(scene);
  for (int k = 0; k < 3; k++) {
    double low = scene->bounds_min[k], high = scene->bounds_max[k];
    scene->origin[k] = fmax(fabs(low), fabs(high)) > 2 * extent ? 0.5 * (low + high) : 0;
  }
}

void scene_measure(struct scene *scene) {
  double low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
  int any_caster = 0;
  for (int i = 0; i < scene->instance_count; i++) any_caster |= scene->instances[i].casts;
  scene->triangle_count = 0;
  for (int i = 0; i < scene->instance_count; i++) {
    const struct instance *instance = &scene->instances[i];
    scene->triangle_count += scene->meshes[instance->mesh].triangle_count;
    if (any_caster && !instance->casts) continue;
    double a[3], b[3];
    instance_bounds(scene, instance, a, b);
    for (int k = 0; k < 3; k++) {
      low[k] = fmin(low[k], a[k]);
      high[k] = fmax(high[k], b[k]);
    }
  }
  for (int k = 0; k < 3; k++) {
    scene->bounds_min[k] = low[k];
    scene->bounds_max[k] = high[k];
  }
  choose_origin(scene);
  for (int i = 0; i < scene->instance_count; i++) place(scene, &scene->instances[i]);
}

double scene_extent(const struct scene *scene) {
  double extent = 0;
  for (int k = 0; k < 3; k++) extent = fmax(extent, scene->bounds_max[k] - scene->bounds_min[k]);
  return extent;
}

static int wrapped(int i, int n, enum texture_wrap wrap) {
  if (wrap == WRAP_CLAMP) return i < 0 ? 0 : i >= n ? n - 1 : i;
  int period = wrap == WRAP_MIRROR ? 2 * n : n;
  i %= period;
  if (i < 0) i += period;
  return i < n ? i : 2 * n - 1 - i;
}

float texture_alpha(const struct texture *texture, float u, float v) {
  /* Far outside, texel positions lose their fraction and then overflow an int; one period is as good as another. */
  if (!isfinite(u) || !isfinite(v)) return 1;
  float x = fmodf(u, 2) * (float)texture->width - 0.5f, y = fmodf(v, 2) * (float)texture->height - 0.5f;
  if (texture->wrap_u == WRAP_CLAMP) x = fminf(fmaxf(u, -1), 2) * (float)texture->width - 0.5f;
  if (texture->wrap_v == WRAP_CLAMP) y = fminf(fmaxf(v, -1), 2) * (float)texture->height - 0.5f;
  int x0 = (int)floorf(x), y0 = (int)floorf(y);
  float fx = x - (float)x0, fy = y - (float)y0, rows[2];
  for (int j = 0; j < 2; j++) {
    const uint8_t *row =
        texture->alpha + (size_t)wrapped(y0 + j, texture->height, texture->wrap_v) * (size_t)texture->width;
    float a = row[wrapped(x0, texture->width, texture->wrap_u)],
          b = row[wrapped(x0 + 1, texture->width, texture->wrap_u)];
    rows[j] = a + (b - a) * fx;
  }
  return (rows[0] + (rows[1] - rows[0]) * fy) / 255;
}
