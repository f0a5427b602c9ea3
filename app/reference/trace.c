#define _GNU_SOURCE /* sched_getaffinity */
#include "reference/reference.h"

#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "reference/occluders.h"
#include "reference/sampling.h"

/* Where a ray starts.
 *
 * A point P that came through a depth buffer lies up to `error` beside its surface, on either side, and Embree
 * evaluates the plane of the triangle that P lies on with rounding of its own. Started at P, half the rays would hit
 * that triangle: acne. So rays start at
 *
 *     O = P + n * offset,   offset = error + 16 * 2^-24 * m
 *
 * n being the geometric normal and m the largest magnitude of a coordinate of P or of any caster. The second term: a
 * vertex minus the origin is rounded by at most 2^-24 * 2m in each coordinate, the normal of the triangle follows
 * from three such differences, and within the triangle the plane through them is then off by a small multiple of
 * that; O itself is rounded by 2^-24 * m. 16 covers the sum with room to spare. O is therefore in front of P's own
 * plane, rays go to the part of the light that is in front of it as well (the horizon is taken at O), and neither P's
 * triangle nor one that lies in the same plane can be hit. No second rejection is needed.
 *
 * What it costs: an occluder closer to the surface than the offset is missed. Some 1e-6 of the scene's size: what
 * stands on a surface still shadows it right up to the contact, because the rays cross its side at that height.
 *
 * For the same reason rays end at the height `offset` before the light's plane: a ceiling that a light lies in does
 * not block it. */
#define OFFSET_ROUNDING (16 * 0x1p-24f)

#define TILE 8
#define PROGRESS_SECONDS 0.1
#define STOP_POLL_SECONDS 0.05

struct work {
  const struct reference_light *light;
  const struct reference_points *points;
  const struct occluders *occluders;
  struct sampling sampling;
  float *visibility;
  float magnitude;
  int tile_columns, tile_count;
  atomic_int next_tile, stop;
  atomic_ullong rays;
  pthread_mutex_t lock; /* guards the three below */
  pthread_cond_t changed;
  int running;
  int tiles_done;
};

static double seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- one point --------------------------------------------------------------------------------------------------- */

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The directions of rays: base + x * axis[0] + y * axis[1], x and y in [-1, 1]; and the same dotted with the normal. */
struct fan {
  float origin[3], reach;
  float base[3], axis[2][3];
  float rise, slope[2];
};

static float point_offset(const struct work *work, const float *position, float error) {
  float magnitude = work->magnitude;
  for (int i = 0; i < 3; i++) magnitude = fmaxf(magnitude, fabsf(position[i]));
  return error + OFFSET_ROUNDING * magnitude;
}

/* Returns 0 where visibility is 1 without a ray: behind or in the light's plane, or the whole light below the
 * horizon. */
static int make_fan(const struct reference_light *light, const float *position, const float *normal, float offset,
                    struct fan *fan) {
  double base[3], n[3] = {normal[0], normal[1], normal[2]};
  for (int i = 0; i < 3; i++) fan->origin[i] = (float)((double)position[i] + n[i] * (double)offset);
  fan->reach = INFINITY;
  if (light->shape == REFERENCE_RECTANGLE) {
    for (int i = 0; i < 3; i++) base[i] = light->center[i] - (double)fan->origin[i];
    double height = -dot(base, light->direction);
    if (height <= 2 * (double)offset) return 0;
    fan->reach = (float)(1 - (double)offset / height);
  } else {
    for (int i = 0; i < 3; i++) base[i] = -light->direction[i];
  }
  double half_u = light->half[0], half_v = light->half[1];
  fan->rise = (float)dot(base, n);
  fan->slope[0] = (float)(half_u * dot(light->u, n));
  fan->slope[1] = (float)(half_v * dot(light->v, n));
  for (int i = 0; i < 3; i++) {
    fan->base[i] = (float)base[i];
    fan->axis[0][i] = (float)(half_u * light->u[i]);
    fan->axis[1][i] = (float)(half_v * light->v[i]);
  }
  return fan->rise + fabsf(fan->slope[0]) + fabsf(fan->slope[1]) > 0;
}

/* Fills the rays of one packet; returns how many of them end above the horizon. */
WIDE_VECTORS static int aim(const struct fan *fan, const float x[SAMPLING_LANES], const float y[SAMPLING_LANES],
                            int active, struct ray_packet *packet) {
  for (int axis = 0; axis < 3; axis++)
    for (int i = 0; i < SAMPLING_LANES; i++)
      packet->direction[axis][i] = fan->base[axis] + x[i] * fan->axis[0][axis] + y[i] * fan->axis[1][axis];
  int above = 0;
  for (int i = 0; i < SAMPLING_LANES; i++) {
    int traced = (i < active) & (fan->rise + x[i] * fan->slope[0] + y[i] * fan->slope[1] > 0);
    packet->valid[i] = -traced;
    above += traced;
  }
  return above;
}

static float trace_point(struct work *work, uint32_t index, unsigned long long *rays) {
  const struct reference_points *points = work->points;
  const float *position = points->positions + 3 * (size_t)index, *normal = points->normals + 3 * (size_t)index;
  for (int i = 0; i < 3; i++)
    if (!isfinite(position[i]) || !isfinite(normal[i])) return 1;
  if (points->receives && !points->receives[index]) return 1;
  float largest = fmaxf(fabsf(position[0]), fmaxf(fabsf(position[1]), fabsf(position[2])));
  float error = points->errors ? points->errors[index] : largest * REFERENCE_POINT_ERROR;
  struct fan fan;
  if (!make_fan(work->light, position, normal, point_offset(work, position, error), &fan)) return 1;
  struct sampling_pixel pixel;
  sampling_begin(&work->sampling, index, &pixel);
  struct ray_packet packet;
  memcpy(packet.origin, fan.origin, sizeof packet.origin);
  packet.reach = fan.reach;
  int above = 0, blocked = 0;
  for (int i = 0; i < work->sampling.packets; i++) {
    float x[SAMPLING_LANES], y[SAMPLING_LANES];
    int active = sampling_packet(&work->sampling, &pixel, i, x, y);
    int traced = aim(&fan, x, y, active, &packet);
    above += traced;
    if (traced) blocked += occluders_blocked(work->occluders, &packet);
  }
  *rays += (unsigned long long)above;
  return above ? (float)((double)(above - blocked) / (double)above) : 1;
}

/* ---- many points ------------------------------------------------------------------------------------------------- */

static void trace_tile(struct work *work, int tile) {
  const struct reference_points *points = work->points;
  int x0 = tile % work->tile_columns * TILE, y0 = tile / work->tile_columns * TILE;
  unsigned long long rays = 0;
  for (int y = y0; y < y0 + TILE && y < points->height; y++)
    for (int x = x0; x < x0 + TILE && x < points->width; x++) {
      if (atomic_load_explicit(&work->stop, memory_order_relaxed)) return;
      uint32_t index = (uint32_t)y * (uint32_t)points->width + (uint32_t)x;
      work->visibility[index] = trace_point(work, index, &rays);
    }
  atomic_fetch_add(&work->rays, rays);
}

/* Numbers near 1e-38 mean nothing here, and take Embree a hundred times longer than zeros. */
static void flush_denormals(void) {
#ifdef __SSE__
  _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
}

static void *worker(void *argument) {
  struct work *work = argument;
  flush_denormals();
  int tile;
  while (!atomic_load(&work->stop) && (tile = atomic_fetch_add(&work->next_tile, 1)) < work->tile_count) {
    trace_tile(work, tile);
    pthread_mutex_lock(&work->lock);
    work->tiles_done++;
    pthread_mutex_unlock(&work->lock);
  }
  pthread_mutex_lock(&work->lock);
  work->running--;
  pthread_cond_signal(&work->changed);
  pthread_mutex_unlock(&work->lock);
  return NULL;
}

static struct timespec after(double seconds) {
  struct timespec until;
  clock_gettime(CLOCK_MONOTONIC, &until);
  until.tv_nsec += (long)(seconds * 1e9);
  until.tv_sec += until.tv_nsec / 1000000000;
  until.tv_nsec %= 1000000000;
  return until;
}

/* The calling thread's part: tells how far the work is until all workers have left. */
static void watch(struct work *work, const struct reference_options *options) {
  double start = seconds_now();
  pthread_mutex_lock(&work->lock);
  while (work->running > 0) {
    struct timespec until = after(PROGRESS_SECONDS);
    pthread_cond_timedwait(&work->changed, &work->lock, &until);
    double fraction = (double)work->tiles_done / (double)work->tile_count;
    pthread_mutex_unlock(&work->lock);
    double left = fraction > 0 ? (seconds_now() - start) * (1 - fraction) / fraction : -1;
    if (options->progress && !atomic_load(&work->stop) && options->progress(options->user, fraction, left))
      atomic_store(&work->stop, 1);
    pthread_mutex_lock(&work->lock);
  }
  pthread_mutex_unlock(&work->lock);
}

static enum reference_status run_workers(struct work *work, const struct reference_options *options, int threads) {
  pthread_t ids[REFERENCE_THREADS_MAX];
  int started = 0;
  pthread_condattr_t attributes;
  pthread_condattr_init(&attributes);
  pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC); /* so that setting the clock does not delay a Ctrl-C */
  pthread_mutex_init(&work->lock, NULL);
  pthread_cond_init(&work->changed, &attributes);
  pthread_condattr_destroy(&attributes);
  work->running = threads;
  while (started < threads && pthread_create(&ids[started], NULL, worker, work) == 0) started++;
  pthread_mutex_lock(&work->lock);
  work->running -= threads - started;
  pthread_mutex_unlock(&work->lock);
  if (started > 0) watch(work, options);
  for (int i = 0; i < started; i++) pthread_join(ids[i], NULL);
  pthread_cond_destroy(&work->changed);
  pthread_mutex_destroy(&work->lock);
  if (started == 0) return REFERENCE_MEMORY;
  return atomic_load(&work->stop) ? REFERENCE_STOPPED : REFERENCE_OK;
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

const char *reference_status_text(enum reference_status status) {
  static const char *const texts[] = {"done", "stopped", "impossible input", "out of memory", "Embree failed"};
  return texts[status];
}

static int vector_valid(const double v[3]) {
  double length = dot(v, v);
  return isfinite(length) && fabs(length - 1) < 1e-3;
}

static int light_valid(const struct reference_light *light) {
  for (int i = 0; i < 3; i++)
    if (light->shape == REFERENCE_RECTANGLE && !isfinite(light->center[i])) return 0;
  for (int i = 0; i < 2; i++)
    if (!isfinite(light->half[i]) || light->half[i] < 0) return 0;
  return vector_valid(light->direction) && vector_valid(light->u) && vector_valid(light->v);
}

static int points_valid(const struct reference_points *points) {
  return points->width > 0 && points->height > 0 && points->positions && points->normals &&
         (unsigned long long)points->width * (unsigned long long)points->height <= INT_MAX;
}

/* Processors that this process may use, which can be fewer than the machine has. */
static int processor_count(void) {
#ifdef __linux__
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0) return CPU_COUNT(&set);
#endif
  long online = sysconf(_SC_NPROCESSORS_ONLN);
  return online > 0 && online < INT_MAX ? (int)online : 1;
}

static int thread_count(int wanted) {
  int count = wanted > 0 ? wanted : processor_count();
  return count > REFERENCE_THREADS_MAX ? REFERENCE_THREADS_MAX : count;
}

/* While Embree builds, any of its threads may ask; progress is only called on the caller's. */
struct builder {
  const struct reference_options *options;
  pthread_t caller;
  double last;
};

static int build_stops(void *user) {
  struct builder *builder = user;
  if (!builder->options->progress || !pthread_equal(pthread_self(), builder->caller)) return 0;
  double now = seconds_now();
  if (now - builder->last < STOP_POLL_SECONDS) return 0;
  builder->last = now;
  return builder->options->progress(builder->options->user, 0, -1);
}

enum reference_status reference_trace(const struct reference_casters *casters, const struct reference_light *light,
                                      const struct reference_points *points, const struct reference_options *options,
                                      float *visibility, struct reference_result *result) {
  if (!light_valid(light) || !points_valid(points) || !reference_samples_valid(options->samples))
    return REFERENCE_ARGUMENT;
  struct reference_result done = {0, 0};
  struct occluders *occluders = NULL;
  struct builder builder = {options, pthread_self(), 0};
  int threads = thread_count(options->threads);
  enum reference_status status = occluders_create(casters, threads, build_stops, &builder, &occluders);
  if (status == REFERENCE_OK && occluders_empty(occluders)) {
    for (size_t i = 0; i < (size_t)points->width * (size_t)points->height; i++) visibility[i] = 1;
  } else if (status == REFERENCE_OK) {
    struct work work = {.light = light, .points = points, .occluders = occluders, .visibility = visibility};
    work.magnitude = occluders_magnitude(occluders);
    work.tile_columns = (points->width + TILE - 1) / TILE;
    work.tile_count = work.tile_columns * ((points->height + TILE - 1) / TILE);
    double start = seconds_now();
    status =
        sampling_create(&work.sampling, options->samples) ? run_workers(&work, options, threads) : REFERENCE_MEMORY;
    sampling_free(&work.sampling);
    done.seconds = seconds_now() - start;
    done.rays = atomic_load(&work.rays);
  }
  occluders_destroy(&occluders);
  if (result) *result = done;
  return status;
}
