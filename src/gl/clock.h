/* Stage times. On hardware timestamp queries, read when they are there; on software GL, whose queries lie, glFinish
 * and the system's monotonic clock. Timestamps never nest in a host's own query. */
#ifndef PN_GL_CLOCK_H
#define PN_GL_CLOCK_H

#include "gl/gpu.h"

enum { PNI_CLOCK_MARKS = 48, PNI_CLOCK_FRAMES = 4 };

typedef struct {
  const char *stage[PNI_CLOCK_MARKS]; /* stage[i] lies between marks i-1 and i; stage[0] is NULL, the start */
  pn_gl query[PNI_CLOCK_MARKS];
  double now[PNI_CLOCK_MARKS]; /* software: milliseconds */
  int marks;
  bool pending; /* on hardware: not read yet */
} pni_clock_frame;

typedef struct {
  pni_clock_frame frames[PNI_CLOCK_FRAMES];
  int current;
  bool running;
  const char *stage[PNI_CLOCK_MARKS]; /* of the latest frame that is known */
  double milliseconds[PNI_CLOCK_MARKS];
  int count;
} pni_clock;

void pni_clock_start(pni_gpu *gpu, pni_clock *clock); /* a frame begins; nothing while timing is off */
/* what was drawn since the last mark was this stage */
void pni_clock_mark(pni_gpu *gpu, pni_clock *clock, const char *stage);
void pni_clock_end(pni_gpu *gpu, pni_clock *clock);
void pni_clock_read(pni_gpu *gpu, pni_clock *clock, bool wait); /* brings stage, milliseconds, count up to date */
void pni_clock_free(pni_gpu *gpu, pni_clock *clock, bool abandon);

#endif
