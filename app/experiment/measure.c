#include "experiment/measure.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/message.h"
#include "base/progress.h"

enum { WARM_UP = 3 };
static const double limit_ms = 3000;

/* What one contestant's frames took. */
struct record {
  double *totals;             /* [frames] */
  double *stages[STAGES_MAX]; /* [frames] each; NULL until the stage appears */
  int frames, warmed, done;
  double sum;
};

static int compare_doubles(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median_of(double *values, int count) {
  qsort(values, (size_t)count, sizeof *values, compare_doubles);
  return count % 2 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}

/* Of sorted values: how far the middle half of them spreads. */
static double quartiles_apart(const double *values, int count) {
  return values[3 * (count - 1) / 4] - values[(count - 1) / 4];
}

static int run_frame(struct contestant *c, double *milliseconds) {
  glFinish();
  double start = clock_ms();
  int status = c->in_scope ? client_check(c->client, pn_state_begin(c->client->context)) : STATUS_OK;
  for (int i = 0; i < c->light_count && !status; i++)
    status = c->maps_only ? client_maps(c->client, c->lights[i]) : client_frame(c->client, c->lights[i]);
  if (c->in_scope && !status) status = client_check(c->client, pn_state_end(c->client->context));
  glFinish();
  *milliseconds = clock_ms() - start;
  return status;
}

static int stage_index(struct timing *timing, struct record *r, const char *name, int frames) {
  for (int i = 0; i < timing->stage_count; i++)
    if (strcmp(timing->stages[i].name, name) == 0) return i;
  if (timing->stage_count == STAGES_MAX) return -1;
  r->stages[timing->stage_count] = calloc((size_t)frames, sizeof(double));
  if (!r->stages[timing->stage_count]) return -1;
  timing->stages[timing->stage_count].name = name;
  return timing->stage_count++;
}

/* Adds the latest frame's stage times, summed over the contestant's lights. */
static void record_stages(struct contestant *c, struct record *r, int frames) {
  for (int l = 0; l < c->light_count; l++) {
    pn_time times[STAGES_MAX];
    int count = pn_times(c->lights[l], times, STAGES_MAX, 1);
    for (int i = 0; i < count && i < STAGES_MAX; i++) {
      int stage = stage_index(&c->timing, r, times[i].stage, frames);
      if (stage >= 0) r->stages[stage][r->frames] += times[i].milliseconds;
    }
  }
}

static int step(struct contestant *c, struct record *r, int frames, int stages) {
  double ms = 0;
  int status = run_frame(c, &ms);
  if (status) return status;
  int first_is_all = r->warmed == 0 && ms > limit_ms;
  if (r->warmed < WARM_UP && !first_is_all) {
    r->warmed++;
    return STATUS_OK;
  }
  if (stages) record_stages(c, r, frames);
  r->totals[r->frames++] = ms;
  r->sum += ms;
  r->done = first_is_all || r->frames == frames || r->sum > limit_ms;
  return STATUS_OK;
}

static void summarise(struct contestant *c, struct record *r) {
  struct timing *t = &c->timing;
  t->frames = r->frames;
  for (int i = 0; i < t->stage_count; i++) t->stages[i].milliseconds = median_of(r->stages[i], r->frames);
  t->median = median_of(r->totals, r->frames);
  t->min = r->totals[0];
  t->max = r->totals[r->frames - 1];
  t->quartiles = quartiles_apart(r->totals, r->frames);
}

static int run_all(struct contestant *contestants, struct record *records, int count, int frames, int stages) {
  int status = STATUS_OK;
  progress_begin("measuring");
  for (int left = count; left > 0 && !status;) {
    double progress = 0;
    left = 0;
    for (int i = 0; i < count && !status; i++) {
      struct record *r = &records[i];
      if (!r->done) status = step(&contestants[i], r, frames, stages);
      left += !r->done;
      progress += r->done ? 1 : fmax((double)r->frames / frames, r->sum / limit_ms);
    }
    progress_update(progress / count);
  }
  progress_end();
  return status;
}

int measure(struct contestant *contestants, int count, int frames, int stages) {
  struct record *records = calloc((size_t)count + 1, sizeof *records);
  if (!records) return memory_error();
  int status = STATUS_OK;
  for (int i = 0; i < count && !status; i++) {
    memset(&contestants[i].timing, 0, sizeof contestants[i].timing);
    records[i].totals = calloc((size_t)frames, sizeof(double));
    if (!records[i].totals) status = memory_error();
    else status = client_check(contestants[i].client, pn_timing(contestants[i].client->context, stages));
  }
  if (!status) status = run_all(contestants, records, count, frames, stages);
  for (int i = 0; i < count; i++) {
    if (!status) summarise(&contestants[i], &records[i]);
    free(records[i].totals);
    for (int s = 0; s < STAGES_MAX; s++) free(records[i].stages[s]);
  }
  free(records);
  return status;
}
