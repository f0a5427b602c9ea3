/* experiment.h: techniques on one scene, drawn and timed in turn, held against the truth, looked into, made pictures
 * of: what every command shares that draws.
 *
 *     experiment_open        the device, the scene on it, what the camera sees
 *     experiment_measure     a light for each technique; frame times, all techniques in turn
 *     experiment_draw        one technique's visibility
 *     experiment_look        what it did on the way
 *     experiment_trace       the truth
 *     experiment_errors      each visibility against it, and its picture against the truth's
 *     experiment_pictures    truth and techniques, shaded
 *     experiment_close
 *
 * Steps come in this order; those that nobody needs are left out. Each answers with the exit status, having printed
 * one line where that is not STATUS_OK; the experiment can then only be closed. Everything below is the experiment's
 * and lives until experiment_close, or until the step that made it is taken again. A thread that calls these has the
 * experiment's GL context, which experiment_open makes current, to itself. */
#ifndef PENUMBRA_APP_EXPERIMENT_EXPERIMENT_H
#define PENUMBRA_APP_EXPERIMENT_EXPERIMENT_H

#include "experiment/measure.h"
#include "experiment/truth.h"
#include "host/host.h"
#include "host/view.h"
#include "report/error.h"

/* Means over the pixels whose search looked at primitives. */
struct search_means {
  int searched; /* 0: the technique does not search, or nobody asked */
  double pixels, visited, primitives, window;
};

/* One technique's share of the work. What a step fills is empty before. */
struct entry {
  const char *spec;
  pn_light *light;        /* experiment_measure; the host's client frees it */
  struct timing timing;   /* experiment_measure */
  float *visibility;      /* experiment_draw: one a pixel, top row first */
  struct insides insides; /* experiment_look */
  struct search_means search;
  struct error_statistics error, all; /* experiment_errors: as report_technique's */
  double picture_error;
  struct error_bound bound;
  uint8_t *picture; /* experiment_pictures: RGB, sRGB, 8 bits, top row first */
};

struct experiment {
  struct host host;
  struct view *view;
  struct entry *entries;
  int count;
  struct truth truth;         /* experiment_trace */
  uint8_t *mask, *background; /* experiment_errors: 1 where errors count; 1 where there is no surface */
  float *unoccluded;          /* experiment_errors: shade_unoccluded */
  uint8_t *reference_picture; /* experiment_pictures, as the entries' */
};

/* scene and the strings in specs must outlive the experiment; specs itself need not. device: as device_open. Call
 * experiment_close in any case. */
int experiment_open(struct experiment *e, const struct scene *scene, const char *device, const char *const *specs,
                    int count);

/* frames, stages: as measure. */
int experiment_measure(struct experiment *e, int frames, int stages);

/* Reads the visibility of one technique's last frame. */
int experiment_draw(struct experiment *e, int index);

/* What one technique does on the way to its visibility, in a frame that is not timed. debug_flags: as pn_debug;
 * PN_DEBUG_BOUND takes long. */
int experiment_look(struct experiment *e, int index, int debug_flags);

/* Gives back what the two above have read, for who needs one technique after the other. */
void experiment_drop(struct experiment *e, int index);

/* samples: rays a pixel. use_cache: also look among what was traced before. */
int experiment_trace(struct experiment *e, int samples, int use_cache);

/* Of all techniques, whose visibilities must be there; warns where errors are undefined. */
int experiment_errors(struct experiment *e);

/* Needs the errors. */
int experiment_pictures(struct experiment *e);

void experiment_close(struct experiment *e);

#endif
