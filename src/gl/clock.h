/* Stage times. On hardware timestamp queries, read when they are there; on software GL, whose queries lie, glFinish
 * and the system's monotonic clock. Timestamps never nest in a host's own query. */
#ifndef PNI_GL_CLOCK_H
#define PNI_GL_CLOCK_H

#include "gl/gpu.h"

enum { PNI_CLOCK_FRAMES = 4 };

typedef struct {
  const char *stage; /* what lies between the mark before this one and this one; of the first: NULL, the start */
  pn_gl query;
  double now; /* software: milliseconds */
} pni_clock_mark_data;

typedef struct {
  pni_clock_mark_data *marks;
  int count, capacity; /* capacity grows with the longest frame */
  bool pending;        /* on hardware: not read yet */
} pni_clock_frame;

typedef struct {
  pni_clock_frame frames[PNI_CLOCK_FRAMES];
  int current;
  bool running;
  /* of the latest frame that is known: each stage once */
  pn_time *times;
  int count, capacity;
} pni_clock;

void pni_clock_start(pni_gpu *gpu, pni_clock *clock); /* a frame begins; nothing while timing is off */
/* what was drawn since the last mark was this stage */
void pni_clock_mark(pni_gpu *gpu, pni_clock *clock, const char *stage);
void pni_clock_end(pni_gpu *gpu, pni_clock *clock);
void pni_clock_read(pni_gpu *gpu, pni_clock *clock, bool wait); /* brings times and count up to date */
void pni_clock_free(pni_gpu *gpu, pni_clock *clock, bool abandon);

#endif
