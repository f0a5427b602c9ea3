#include "reference/occluders.h"

#include <math.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if PENUMBRA_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/* What the intersection filter of an alpha-tested geometry needs. Embree keeps the address. */
struct holes {
  const uint32_t *indices; /* Embree's buffer: the triangles that were kept */
  const float *texcoords;
  const struct reference_alpha *alpha;
  float cutoff;
};

struct occluders {
  RTCDevice device;
  RTCScene scene;
  struct holes *holes; /* one for each instance */
  float magnitude;
  size_t triangle_count;
  int wide; /* packets of 16 are native, else 8 are used */
  int (*stop)(void *user);
  void *user;
  atomic_int stopped;
};

/* ---- alpha ------------------------------------------------------------------------------------------------------- */

/* A texture coordinate into [0, 1], so that texel indices stay small whatever a file says. */
static float wrap_coordinate(float s, enum reference_wrap wrap) {
  if (!isfinite(s)) return 0;
  if (wrap == REFERENCE_REPEAT) return s - floorf(s);
  if (wrap == REFERENCE_MIRROR) {
    s = fmodf(fabsf(s), 2);
    return s > 1 ? 2 - s : s;
  }
  return s < 0 ? 0 : s > 1 ? 1 : s;
}

/* The two texels beside texel coordinate x. Beyond the border a repeated image goes on at the other side; a clamped
 * or mirrored one shows its border texel once more. */
static void neighbours(float x, int size, enum reference_wrap wrap, int index[2], float *weight) {
  float base = floorf(x);
  *weight = x - base;
  for (int i = 0; i < 2; i++) {
    int texel = (int)base + i;
    if (texel < 0) texel = wrap == REFERENCE_REPEAT ? size - 1 : 0;
    else if (texel >= size) texel = wrap == REFERENCE_REPEAT ? 0 : size - 1;
    index[i] = texel;
  }
}

static float sample_alpha(const struct reference_alpha *alpha, float s, float t) {
  int column[2], row[2];
  float weight_s, weight_t;
  neighbours(wrap_coordinate(s, alpha->wrap_s) * (float)alpha->width - 0.5f, alpha->width, alpha->wrap_s, column,
             &weight_s);
  neighbours(wrap_coordinate(t, alpha->wrap_t) * (float)alpha->height - 0.5f, alpha->height, alpha->wrap_t, row,
             &weight_t);
  float value[2];
  for (int i = 0; i < 2; i++) {
    const uint8_t *texels = alpha->texels + (size_t)row[i] * (size_t)alpha->width;
    value[i] = (float)texels[column[0]] * (1 - weight_s) + (float)texels[column[1]] * weight_s;
  }
  return (value[0] * (1 - weight_t) + value[1] * weight_t) * (1 / 255.0f);
}

/* A packet of N hits is N values of each field, one field after the other: Ng_x, Ng_y, Ng_z, u, v, primID. Embree has
 * functions for that in C++ only. */
static float hit_u(const struct RTCFilterFunctionNArguments *arguments, unsigned i) {
  return ((const float *)arguments->hit)[3 * arguments->N + i];
}
static float hit_v(const struct RTCFilterFunctionNArguments *arguments, unsigned i) {
  return ((const float *)arguments->hit)[4 * arguments->N + i];
}
static size_t hit_triangle(const struct RTCFilterFunctionNArguments *arguments, unsigned i) {
  return ((const unsigned *)arguments->hit)[5 * arguments->N + i];
}

/* Called for each hit that would block: takes back those that fall into a hole. */
static void drop_holes(const struct RTCFilterFunctionNArguments *arguments) {
  const struct holes *holes = arguments->geometryUserPtr;
  for (unsigned i = 0; i < arguments->N; i++) {
    if (arguments->valid[i] != -1) continue;
    const uint32_t *triangle = holes->indices + 3 * hit_triangle(arguments, i);
    float u = hit_u(arguments, i), v = hit_v(arguments, i), st[2];
    for (int axis = 0; axis < 2; axis++)
      st[axis] = holes->texcoords[2 * (size_t)triangle[0] + axis] * (1 - u - v) +
                 holes->texcoords[2 * (size_t)triangle[1] + axis] * u +
                 holes->texcoords[2 * (size_t)triangle[2] + axis] * v;
    if (sample_alpha(holes->alpha, st[0], st[1]) < holes->cutoff) arguments->valid[i] = 0;
  }
}

/* ---- geometry ---------------------------------------------------------------------------------------------------- */

static void transform_point(const float m[16], const float p[3], float out[3]) {
  for (int row = 0; row < 3; row++)
    out[row] =
        (float)((double)m[row] * p[0] + (double)m[4 + row] * p[1] + (double)m[8 + row] * p[2] + (double)m[12 + row]);
}

static int mesh_valid(const struct reference_mesh *mesh) {
  if (mesh->triangle_count == 0) return 1;
  if (!mesh->positions || !mesh->indices || mesh->vertex_count > UINT32_MAX || mesh->triangle_count > UINT32_MAX / 3)
    return 0;
  const struct reference_alpha *alpha = mesh->alpha;
  return !alpha || (alpha->texels && alpha->width > 0 && alpha->height > 0 && mesh->texcoords);
}

static int triangle_usable(const uint32_t *triangle, const float *placed, size_t vertex_count) {
  for (int corner = 0; corner < 3; corner++) {
    if (triangle[corner] >= vertex_count) return 0;
    for (int axis = 0; axis < 3; axis++)
      if (!isfinite(placed[3 * (size_t)triangle[corner] + axis])) return 0;
  }
  return 1;
}

/* Vertices are placed here and not by Embree's instances: one precision for all of them, and the one that the GPU's
 * vertices have. */
static float place_vertices(const struct reference_mesh *mesh, const float matrix[16], float *placed) {
  float magnitude = 0;
  for (size_t i = 0; i < mesh->vertex_count; i++) {
    transform_point(matrix, mesh->positions + 3 * i, placed + 3 * i);
    for (int axis = 0; axis < 3; axis++)
      if (isfinite(placed[3 * i + axis]) && fabsf(placed[3 * i + axis]) > magnitude)
        magnitude = fabsf(placed[3 * i + axis]);
  }
  return magnitude;
}

static enum reference_status add_instance(struct occluders *occluders, const struct reference_mesh *mesh,
                                          const float matrix[16], struct holes *holes) {
  RTCGeometry geometry = rtcNewGeometry(occluders->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  float *placed = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                          mesh->vertex_count);
  uint32_t *kept = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t),
                                           mesh->triangle_count);
  if (!placed || !kept) {
    rtcReleaseGeometry(geometry);
    return REFERENCE_MEMORY;
  }
  float magnitude = place_vertices(mesh, matrix, placed);
  /* A dropped triangle becomes a point, which no ray hits, and the numbers of the others stay. */
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    int usable = triangle_usable(mesh->indices + 3 * i, placed, mesh->vertex_count);
    for (int corner = 0; corner < 3; corner++) kept[3 * i + corner] = usable ? mesh->indices[3 * i + corner] : 0;
    occluders->triangle_count += (size_t)usable;
  }
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
    if (!isfinite(placed[i])) placed[i] = 0;
  if (magnitude > occluders->magnitude) occluders->magnitude = magnitude;
  if (mesh->alpha) {
    *holes = (struct holes){kept, mesh->texcoords, mesh->alpha, mesh->cutoff};
    rtcSetGeometryUserData(geometry, holes);
    rtcSetGeometryOccludedFilterFunction(geometry, drop_holes);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(occluders->scene, geometry);
  rtcReleaseGeometry(geometry);
  return REFERENCE_OK;
}

/* ---- building ---------------------------------------------------------------------------------------------------- */

/* Embree's progress monitor: false ends the build. */
static bool build_goes_on(void *user, double fraction) {
  struct occluders *occluders = user;
  (void)fraction;
  if (occluders->stop && occluders->stop(occluders->user)) atomic_store(&occluders->stopped, 1);
  return !atomic_load(&occluders->stopped);
}

static enum reference_status device_status(const struct occluders *occluders) {
  switch (rtcGetDeviceError(occluders->device)) {
  case RTC_ERROR_NONE: return REFERENCE_OK;
  case RTC_ERROR_OUT_OF_MEMORY: return REFERENCE_MEMORY;
  case RTC_ERROR_CANCELLED: return REFERENCE_STOPPED;
  default: return REFERENCE_DEVICE;
  }
}

static enum reference_status build(struct occluders *occluders, const struct reference_casters *casters) {
  for (int i = 0; i < casters->instance_count; i++) {
    const struct reference_instance *instance = &casters->instances[i];
    if (instance->mesh < 0 || instance->mesh >= casters->mesh_count || !mesh_valid(&casters->meshes[instance->mesh]))
      return REFERENCE_ARGUMENT;
    const struct reference_mesh *mesh = &casters->meshes[instance->mesh];
    if (mesh->triangle_count == 0 || mesh->vertex_count == 0) continue;
    enum reference_status status = add_instance(occluders, mesh, instance->scene_from_object, &occluders->holes[i]);
    if (status == REFERENCE_OK) status = device_status(occluders);
    if (status != REFERENCE_OK) return status;
  }
  rtcSetSceneProgressMonitorFunction(occluders->scene, build_goes_on, occluders);
  rtcCommitScene(occluders->scene);
  enum reference_status status = device_status(occluders);
  return atomic_load(&occluders->stopped) ? REFERENCE_STOPPED : status;
}

enum reference_status occluders_create(const struct reference_casters *casters, int threads, int (*stop)(void *user),
                                       void *user, struct occluders **out) {
  *out = NULL;
  struct occluders *occluders = calloc(1, sizeof *occluders);
  if (!occluders) return REFERENCE_MEMORY;
  occluders->stop = stop;
  occluders->user = user;
  atomic_init(&occluders->stopped, 0);
  occluders->holes = calloc((size_t)casters->instance_count + 1, sizeof *occluders->holes);
  char configuration[64];
  snprintf(configuration, sizeof configuration, "threads=%d", threads);
  occluders->device = rtcNewDevice(configuration);
  enum reference_status status = !occluders->holes    ? REFERENCE_MEMORY
                                 : !occluders->device ? REFERENCE_DEVICE
                                                      : REFERENCE_OK;
  if (status == REFERENCE_OK) {
    occluders->wide = rtcGetDeviceProperty(occluders->device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
    occluders->scene = rtcNewScene(occluders->device);
    /* Robust: no ray slips through an edge that two triangles share. */
    rtcSetSceneFlags(occluders->scene, RTC_SCENE_FLAG_ROBUST);
    status = build(occluders, casters);
  }
  if (status == REFERENCE_OK) *out = occluders;
  else occluders_destroy(&occluders);
  return status;
}

void occluders_destroy(struct occluders **occluders) {
  if (!*occluders) return;
  if ((*occluders)->scene) rtcReleaseScene((*occluders)->scene);
  if ((*occluders)->device) rtcReleaseDevice((*occluders)->device);
  free((*occluders)->holes);
  free(*occluders);
  *occluders = NULL;
}

int occluders_empty(const struct occluders *occluders) { return occluders->triangle_count == 0; }

float occluders_magnitude(const struct occluders *occluders) { return occluders->magnitude; }

/* ---- rays -------------------------------------------------------------------------------------------------------- */

/* The rays of a packet go much the same way. */
#if PENUMBRA_EMBREE == 4
typedef struct RTCOccludedArguments query_terms;
static void set_coherent(query_terms *terms) {
  rtcInitOccludedArguments(terms);
  terms->flags = RTC_RAY_QUERY_FLAG_COHERENT;
}
#define OCCLUDED(lanes, valid, scene, ray, terms) rtcOccluded##lanes(valid, scene, ray, terms)
#else
typedef struct RTCIntersectContext query_terms;
static void set_coherent(query_terms *terms) {
  rtcInitIntersectContext(terms);
  terms->flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
}
#define OCCLUDED(lanes, valid, scene, ray, terms) rtcOccluded##lanes(valid, scene, terms, ray)
#endif

/* How many of the packet's rays first, first + 1, ... are blocked, as many as there are lanes. Embree sets tfar to
 * -infinity where something was hit. */
#define BLOCKED(lanes) \
  static int blocked_##lanes(const struct occluders *occluders, const struct ray_packet *packet, int first) { \
    struct RTCRay##lanes ray; \
    query_terms terms; \
    _Alignas(4 * lanes) int valid[lanes]; \
    memcpy(valid, packet->valid + first, sizeof valid); \
    for (int i = 0; i < lanes; i++) { \
      ray.org_x[i] = packet->origin[0]; \
      ray.org_y[i] = packet->origin[1]; \
      ray.org_z[i] = packet->origin[2]; \
      ray.dir_x[i] = packet->direction[0][first + i]; \
      ray.dir_y[i] = packet->direction[1][first + i]; \
      ray.dir_z[i] = packet->direction[2][first + i]; \
      ray.tnear[i] = ray.time[i] = 0; \
      ray.tfar[i] = packet->reach; \
      ray.mask[i] = UINT32_MAX; \
      ray.id[i] = ray.flags[i] = 0; \
    } \
    set_coherent(&terms); \
    OCCLUDED(lanes, valid, occluders->scene, &ray, &terms); \
    int blocked = 0; \
    for (int i = 0; i < lanes; i++) blocked += packet->valid[first + i] & (ray.tfar[i] < 0); \
    return blocked; \
  }
BLOCKED(16)
BLOCKED(8)

int occluders_blocked(const struct occluders *occluders, const struct ray_packet *packet) {
  if (occluders->wide) return blocked_16(occluders, packet, 0);
  return blocked_8(occluders, packet, 0) + blocked_8(occluders, packet, 8);
}
