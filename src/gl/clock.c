#define _POSIX_C_SOURCE 199309L
#include "gl/clock.h"

#include <string.h>
#include <time.h>

#include "gl/host.h"
#include "gl/label.h"

static double milliseconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* Room for one element more, those added zeroed; false: out of memory. */
static bool room(pni_gpu *gpu, void **array, int count, int *capacity, size_t element) {
  if (count < *capacity) return true;
  int more = *capacity ? 2 * *capacity : 16;
  char *grown = pni_reallocate(gpu, *array, (size_t)more * element);
  if (!grown) return false;
  memset(grown + (size_t)*capacity * element, 0, (size_t)(more - *capacity) * element);
  *array = grown;
  *capacity = more;
  return true;
}

static void take_time(pni_gpu *gpu, pni_clock_mark_data *mark) {
  if (gpu->can.software) {
    GL(gpu, Finish)();
    mark->now = milliseconds();
    return;
  }
  bool fresh = !mark->query;
  if (fresh) GL(gpu, GenQueries)(1, &mark->query);
  GL(gpu, QueryCounter)(mark->query, GL_TIMESTAMP);
  if (fresh) pni_label(gpu, GL_QUERY, mark->query, "clock");
}

/* Without memory for a mark its stage becomes part of the next one. */
static void add_mark(pni_gpu *gpu, pni_clock_frame *frame, const char *stage) {
  if (!room(gpu, (void **)&frame->marks, frame->count, &frame->capacity, sizeof *frame->marks)) return;
  pni_clock_mark_data *mark = &frame->marks[frame->count++];
  mark->stage = stage;
  take_time(gpu, mark);
}

static void add_time(pni_gpu *gpu, pni_clock *clock, const char *stage, double time) {
  for (int i = 0; i < clock->count; i++)
    if (!strcmp(clock->times[i].stage, stage)) {
      clock->times[i].milliseconds += time;
      return;
    }
  if (room(gpu, (void **)&clock->times, clock->count, &clock->capacity, sizeof *clock->times))
    clock->times[clock->count++] = (pn_time){stage, time};
}

static void publish(pni_gpu *gpu, pni_clock *clock, const pni_clock_frame *frame) {
  clock->count = 0;
  for (int i = 1; i < frame->count; i++)
    add_time(gpu, clock, frame->marks[i].stage, frame->marks[i].now - frame->marks[i - 1].now);
}

void pni_clock_start(pni_gpu *gpu, pni_clock *clock) {
  if (!gpu->timing) return;
  clock->current = (clock->current + 1) % PNI_CLOCK_FRAMES;
  pni_clock_frame *frame = &clock->frames[clock->current];
  frame->count = 0;
  frame->pending = false; /* a frame not read in time is given up, never waited for */
  clock->running = true;
  add_mark(gpu, frame, NULL);
}

void pni_clock_mark(pni_gpu *gpu, pni_clock *clock, const char *stage) {
  if (clock->running && !gpu->plan.on) add_mark(gpu, &clock->frames[clock->current], stage);
}

void pni_clock_end(pni_gpu *gpu, pni_clock *clock) {
  if (!clock->running) return;
  clock->running = false;
  pni_clock_frame *frame = &clock->frames[clock->current];
  if (gpu->can.software) publish(gpu, clock, frame);
  else frame->pending = frame->count > 0;
}

static bool read_frame(pni_gpu *gpu, pni_clock *clock, pni_clock_frame *frame) {
  GLint ready = 0;
  GL(gpu, GetQueryObjectiv)(frame->marks[frame->count - 1].query, GL_QUERY_RESULT_AVAILABLE, &ready);
  if (!ready) return false;
  GLuint64 start = 0; /* differences before doubles: a timestamp may count from 1970 */
  for (int i = 0; i < frame->count; i++) {
    GLuint64 nanoseconds = 0;
    GL(gpu, GetQueryObjectui64v)(frame->marks[i].query, GL_QUERY_RESULT, &nanoseconds);
    if (i == 0) start = nanoseconds;
    frame->marks[i].now = (double)(nanoseconds - start) * 1e-6;
  }
  publish(gpu, clock, frame);
  return true;
}

void pni_clock_read(pni_gpu *gpu, pni_clock *clock, bool wait) {
  if (gpu->can.software) return;
  if (wait) GL(gpu, Finish)();
  /* Oldest first, so that the newest known frame is what stays published. */
  for (int age = 1; age <= PNI_CLOCK_FRAMES; age++) {
    pni_clock_frame *frame = &clock->frames[(clock->current + age) % PNI_CLOCK_FRAMES];
    if (frame->pending && read_frame(gpu, clock, frame)) frame->pending = false;
  }
}

void pni_clock_free(pni_gpu *gpu, pni_clock *clock, bool abandon) {
  for (int f = 0; f < PNI_CLOCK_FRAMES; f++) {
    pni_clock_frame *frame = &clock->frames[f];
    for (int i = 0; i < frame->capacity && !abandon; i++)
      if (frame->marks[i].query) GL(gpu, DeleteQueries)(1, &frame->marks[i].query);
    pni_free(gpu, frame->marks);
  }
  pni_free(gpu, clock->times);
  memset(clock, 0, sizeof *clock);
}
