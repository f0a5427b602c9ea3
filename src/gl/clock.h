/* Stage times. On hardware timestamp queries, read when they are there; on software GL, whose queries lie, glFinish
 * and the system's monotonic clock. Timestamps never nest in a host's own query. */
#ifndef PN_GL_CLOCK_H
#define PN_GL_CLOCK_H

#include "gl/gpu.h"

enum { PN_CLOCK_MARKS = 48, PN_CLOCK_FRAMES = 4 };

typedef struct {
  const char *stage[PN_CLOCK_MARKS]; /* stage[i] lies between marks i-1 and i; stage[0] is NULL, the start */
  pn_gl query[PN_CLOCK_MARKS];
  double now[PN_CLOCK_MARKS]; /* software: milliseconds */
  int marks;
  bool pending; /* on hardware: not read yet */
} pn_clock_frame;

typedef struct {
  pn_clock_frame frames[PN_CLOCK_FRAMES];
  int current;
  bool running;
  const char *stage[PN_CLOCK_MARKS]; /* of the latest frame that is known */
  double milliseconds[PN_CLOCK_MARKS];
  int count;
} pn_clock;

void pn_clock_start(pn_gpu *gpu, pn_clock *clock); /* a frame begins; nothing while timing is off */
/* what was drawn since the last mark was this stage */
void pn_clock_mark(pn_gpu *gpu, pn_clock *clock, const char *stage);
void pn_clock_end(pn_gpu *gpu, pn_clock *clock);
void pn_clock_read(pn_gpu *gpu, pn_clock *clock, bool wait); /* brings stage, milliseconds, count up to date */
void pn_clock_free(pn_gpu *gpu, pn_clock *clock, bool abandon);

#endif
