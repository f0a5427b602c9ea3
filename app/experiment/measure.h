/* measure.h: frame times. Contestants are measured in turn, frame by frame (A B A B), so that a machine that slows
 * down slows all of them. */
#ifndef PENUMBRA_APP_EXPERIMENT_MEASURE_H
#define PENUMBRA_APP_EXPERIMENT_MEASURE_H

#include "host/client.h"
#include "report/report.h"

enum { STAGES_MAX = 24 };

struct timing {
  int frames;              /* that were timed */
  double median, min, max; /* milliseconds a frame: maps and visibility of all the contestant's lights */
  double quartiles;        /* how far the quartiles are apart */
  int stage_count;
  struct report_stage stages[STAGES_MAX]; /* medians */
};

/* One or more lights of one client that make a frame together. */
struct contestant {
  struct client *client;
  pn_light **lights;
  int light_count;
  int in_scope;         /* frames stand between pn_state_begin and pn_state_end */
  int maps_only;        /* frames end before visibility */
  struct timing timing; /* the result */
};

/* Three warm-up frames, then up to frames timed ones; a contestant also ends after 3 s, never before one frame, and
 * where the very first frame takes longer than that it is the measurement. With stages, the library's clocks are
 * on. Exit status. */
int measure(struct contestant *contestants, int count, int frames, int stages);
#endif
