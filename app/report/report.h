/* report.h: what a comparison found, in plain arrays, and the forms it is shown in.
 *
 *     report_table    for a terminal, best error first
 *     report_json     the contract's object
 *     report_sheet    one picture: truth, then each technique with its error map
 *     report_html     one self-contained page with a slider
 */
#ifndef PENUMBRA_APP_REPORT_H
#define PENUMBRA_APP_REPORT_H

#include <cjson/cJSON.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "report/error.h"

struct report_stage {
  const char *name;
  double milliseconds;
};

/* One technique. Numbers that are not known are NaN. Everything is the caller's. */
struct report_technique {
  const char *name, *label;
  const char *file;                          /* of the buffer in --save-dir; NULL: not saved */
  const cJSON *parameters;                   /* an object, copied; NULL: none */
  struct error_statistics error;             /* over shadow pixels */
  struct error_statistics all;               /* over every receiving pixel that faces any of the light */
  double picture_error;                      /* error_picture over receiving pixels */
  double time_median, time_least, time_most; /* milliseconds a frame */
  const struct report_stage *stages;
  int stage_count;
  double covered;           /* texels that micropatches covered, in all; 0: the technique does not scatter */
  struct error_bound bound; /* pixels 0: the technique has none, or nobody asks */
  int searched;             /* nonzero: means over the pixels whose search looked at primitives */
  double search_pixels, search_visited, search_primitives, search_window;
  const float *visibility;
  const uint8_t *picture; /* RGB, sRGB, 8 bits */
};

struct report {
  const char *version, *renderer, *gl_version;
  const char *title; /* the scene's name */
  const char *facts; /* light and camera: one line; may be NULL */
  const char *sizes; /* picture, map and what it is fitted to: one line; may be NULL */
  const cJSON *scene;
  int samples;
  double reference_ms;
  int width, height; /* of every array, rows top first */
  const float *reference;
  const uint8_t *reference_picture;
  const uint8_t *mask;       /* 1: can be a shadow pixel */
  const uint8_t *background; /* 1: no surface */
  const struct report_technique *techniques;
  int technique_count;
};

/* Lines of text. ratio: of mean errors, to the first technique. */
void report_table(const struct report *report, FILE *file);

/* NULL: out of memory. The caller deletes it. */
cJSON *report_json(const struct report *report);

/* Parts of it that other results have too. What every result begins with: penumbra, schema, device, scene (copied).
 * {"total": {"median", "min", "max"}, "stages": {...}}. NULL: out of memory. The caller deletes or adds them. */
cJSON *report_head(const char *version, const char *renderer, const char *gl_version, const cJSON *scene);
cJSON *report_times(double median, double least, double most, const struct report_stage *stages, int stage_count);

enum report_status { REPORT_OK = 0, REPORT_MEMORY, REPORT_TOO_MANY };

/* A PNG in memory, malloc'ed. REPORT_TOO_MANY: no picture of a sane size holds so many techniques. */
enum report_status report_sheet(const struct report *report, uint8_t **png, size_t *size);

/* Writes the page; the caller looks at ferror. */
enum report_status report_html(const struct report *report, FILE *file);

/* The permutation that sorts the techniques by mean error, undefined ones last, equal ones in their order. order
 * holds technique_count. */
void report_order(const struct report *report, int *order);

#endif
