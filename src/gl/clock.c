#define _POSIX_C_SOURCE 199309L
#include "gl/clock.h"

#include <string.h>
#include <time.h>

static double milliseconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static void mark(pni_gpu *gpu, pni_clock_frame *frame, const char *stage) {
  if (frame->marks == PNI_CLOCK_MARKS) return;
  int i = frame->marks++;
  frame->stage[i] = stage;
  if (gpu->can.software) {
    GL(gpu, Finish)();
    frame->now[i] = milliseconds();
  } else {
    if (!frame->query[i]) GL(gpu, GenQueries)(1, &frame->query[i]);
    GL(gpu, QueryCounter)(frame->query[i], GL_TIMESTAMP);
  }
}

static void publish(pni_clock *clock, const pni_clock_frame *frame, const double *times) {
  clock->count = frame->marks - 1;
  for (int i = 1; i < frame->marks; i++) {
    clock->stage[i - 1] = frame->stage[i];
    clock->milliseconds[i - 1] = times[i] - times[i - 1];
  }
}

void pni_clock_start(pni_gpu *gpu, pni_clock *clock) {
  if (!gpu->timing) return;
  clock->current = (clock->current + 1) % PNI_CLOCK_FRAMES;
  pni_clock_frame *frame = &clock->frames[clock->current];
  frame->marks = 0;
  frame->pending = false; /* a frame not read in time is given up, never waited for */
  clock->running = true;
  mark(gpu, frame, NULL);
}

void pni_clock_mark(pni_gpu *gpu, pni_clock *clock, const char *stage) {
  if (clock->running) mark(gpu, &clock->frames[clock->current], stage);
}

void pni_clock_end(pni_gpu *gpu, pni_clock *clock) {
  if (!clock->running) return;
  clock->running = false;
  pni_clock_frame *frame = &clock->frames[clock->current];
  if (gpu->can.software) publish(clock, frame, frame->now);
  else frame->pending = true;
}

static bool read_frame(pni_gpu *gpu, pni_clock *clock, pni_clock_frame *frame) {
  GLint ready = 0;
  GL(gpu, GetQueryObjectiv)(frame->query[frame->marks - 1], GL_QUERY_RESULT_AVAILABLE, &ready);
  if (!ready) return false;
  double times[PNI_CLOCK_MARKS];
  GLuint64 start = 0; /* differences before doubles: a timestamp may count from 1970 */
  for (int i = 0; i < frame->marks; i++) {
    GLuint64 nanoseconds = 0;
    GL(gpu, GetQueryObjectui64v)(frame->query[i], GL_QUERY_RESULT, &nanoseconds);
    if (i == 0) start = nanoseconds;
    times[i] = (double)(nanoseconds - start) * 1e-6;
  }
  publish(clock, frame, times);
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
  for (int f = 0; f < PNI_CLOCK_FRAMES && !abandon; f++)
    for (int i = 0; i < PNI_CLOCK_MARKS; i++)
      if (clock->frames[f].query[i]) GL(gpu, DeleteQueries)(1, &clock->frames[f].query[i]);
  memset(clock, 0, sizeof *clock);
}
