/* reference.h: ray-traced truth, over plain arrays; knows no GL.
 *
 * Visibility is the unblocked fraction of the part of the light above the receiver's geometric horizon: 1 where no
 * part is, behind a rectangular light, and on background. From every surface point rays go to a stratified pattern on
 * the light (sampling.h). The result depends on the inputs alone: not on the number of threads, nor on which of them
 * traced what. */
#ifndef PENUMBRA_APP_REFERENCE_H
#define PENUMBRA_APP_REFERENCE_H

#include <stddef.h>
#include <stdint.h>

/* Changes whenever the same inputs may give other numbers; part of the cache's key. */
#define REFERENCE_VERSION 1

#define REFERENCE_SAMPLES_MAX 65536
#define REFERENCE_THREADS_MAX 256

enum reference_wrap { REFERENCE_REPEAT = 0, REFERENCE_CLAMP, REFERENCE_MIRROR };

/* Alpha, one byte a texel, row 0 at t = 0; sampled bilinearly, as OpenGL's GL_LINEAR does. */
struct reference_alpha {
  int width, height;
  const uint8_t *texels;
  enum reference_wrap wrap_s, wrap_t;
};

/* Triangles in object space. Those with a coordinate that is not finite, or an index out of range, block nothing. */
struct reference_mesh {
  const float *positions;  /* 3 a vertex */
  const uint32_t *indices; /* 3 a triangle */
  const float *texcoords;  /* 2 a vertex; needed with alpha */
  size_t vertex_count, triangle_count;
  const struct reference_alpha *alpha; /* NULL: opaque */
  float cutoff;                        /* alpha below it does not block */
};

struct reference_instance {
  int mesh;
  float scene_from_object[16]; /* column-major, affine */
};

struct reference_casters {
  const struct reference_mesh *meshes;
  const struct reference_instance *instances;
  int mesh_count, instance_count;
};

/* u, v, direction: unit, perpendicular, u x v = -direction or direction. Half extents: scene units; sun: tangents,
 * the light being the directions x u + y v - direction with |x| <= half[0], |y| <= half[1]. */
enum reference_shape { REFERENCE_RECTANGLE = 0, REFERENCE_SUN };
struct reference_light {
  enum reference_shape shape;
  double center[3], direction[3], u[3], v[3];
  double half[2];
};

/* What is shaded, row by row. A point that is not finite is background. */
struct reference_points {
  int width, height;
  const float *positions;
  const float *normals;    /* geometric, unit, turned to the side that is seen */
  const uint8_t *receives; /* NULL: every point; 0: visibility 1, nothing traced */
  const float *errors;     /* how far a point may lie from its surface, scene units; NULL: REFERENCE_POINT_ERROR */
};

/* Relative to the point's largest coordinate: what a chain of a few float operations leaves. */
#define REFERENCE_POINT_ERROR 0x1p-20f

struct reference_options {
  int samples; /* rays a point: a square number 1..REFERENCE_SAMPLES_MAX */
  int threads; /* 0: as many as processors */
  /* Called on the calling thread about ten times a second, also while the casters are prepared; seconds_left < 0: not
   * known yet. Returning nonzero stops the work. May be NULL. */
  int (*progress)(void *user, double fraction, double seconds_left);
  void *user;
};

struct reference_result {
  double seconds; /* of tracing, without preparing the casters */
  uint64_t rays;
};

enum reference_status {
  REFERENCE_OK = 0,
  REFERENCE_STOPPED,  /* progress said so; visibility is undefined */
  REFERENCE_ARGUMENT, /* samples, sizes, light or instances make no sense */
  REFERENCE_MEMORY,
  REFERENCE_DEVICE /* Embree failed */
};

/* A few words for a status. */
const char *reference_status_text(enum reference_status status);

/* Nonzero: a number of samples that can be traced. */
int reference_samples_valid(int samples);

/* visibility: width * height floats. result may be NULL. */
enum reference_status reference_trace(const struct reference_casters *casters, const struct reference_light *light,
                                      const struct reference_points *points, const struct reference_options *options,
                                      float *visibility, struct reference_result *result);

#endif
