/* penumbra motion: what shadows do between frames that are given as models, beside what the truth does. */
#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "commands/commands.h"
#include "commands/outputs.h"
#include "experiment/choice.h"
#include "experiment/experiment.h"
#include "experiment/result.h"
#include "files/output.h"
#include "report/motion.h"

/* What is kept of a frame while the next one is made. */
struct drawn {
  int width, height;
  float *position, *mask, *truth;
  float **visibility; /* of each technique */
  float (*texel)[2];
};

struct motion {
  const struct options *options;
  const char **specs;
  int count;
  struct setup setup; /* of the first frame, for all of them */
  struct drawn frames[2];
  cJSON *json; /* NULL: not wanted */
  FILE *people;
};

static void drawn_free(struct drawn *d, int count) {
  for (int i = 0; d->visibility && i < count; i++) free(d->visibility[i]);
  free(d->visibility);
  free(d->texel);
  free(d->position);
  free(d->mask);
  free(d->truth);
  memset(d, 0, sizeof *d);
}

static float *copy_of(const float *from, size_t count) {
  float *copy = malloc(count * sizeof *copy);
  if (copy) memcpy(copy, from, count * sizeof *copy);
  return copy;
}

static int keep(const struct motion *m, const struct experiment *e, struct drawn *out) {
  size_t pixels = (size_t)e->view->width * (size_t)e->view->height;
  out->width = e->view->width;
  out->height = e->view->height;
  out->position = copy_of(e->view->position, 3 * pixels);
  out->mask = copy_of(e->view->mask, pixels);
  out->truth = copy_of(e->truth.visibility, pixels);
  out->visibility = calloc((size_t)m->count + 1, sizeof *out->visibility);
  out->texel = calloc((size_t)m->count + 1, sizeof *out->texel);
  int made = out->position && out->mask && out->truth && out->visibility && out->texel;
  for (int i = 0; i < m->count && made; i++) {
    pn_maps_info info = {0};
    made = (out->visibility[i] = copy_of(e->entries[i].visibility, pixels)) != NULL;
    if (pn_light_maps(e->entries[i].light, &info) != PN_OK) continue;
    out->texel[i][0] = info.texel_s;
    out->texel[i][1] = info.texel_t;
  }
  return made ? STATUS_OK : memory_error();
}

static int draw_frame(struct motion *m, int index, struct drawn *out) {
  const struct options *o = m->options;
  struct scene *scene = NULL;
  struct experiment e = {0};
  int status = options_scene(o, o->positionals[index], &scene);
  if (!status && index == 0) m->setup = scene->setup;
  if (!status) scene->setup = m->setup;
  if (!status) status = experiment_open(&e, scene, o->device, m->specs, m->count);
  if (!status && o->json && !m->json && !(m->json = result_begin(&e.host))) status = memory_error();
  if (!status) status = experiment_measure(&e, 1, 0);
  for (int i = 0; i < m->count && !status; i++) status = experiment_draw(&e, i);
  if (!status) status = experiment_trace(&e, o->reference_samples, !o->given[OPTION_NO_CACHE]);
  if (!status) status = keep(m, &e, out);
  experiment_close(&e);
  scene_free(&scene);
  return status;
}

static struct motion_frame frame_of(const struct drawn *d, int technique) {
  return (struct motion_frame){d->position, d->mask, d->visibility[technique], d->truth};
}

static int same_texel(const struct motion *m, int i) {
  return memcmp(m->frames[0].texel[i], m->frames[1].texel[i], sizeof m->frames[0].texel[i]) == 0;
}

static void add_result(struct motion *m, int step, int i, const struct motion_statistics *s) {
  if (!m->json) return;
  cJSON *results = cJSON_GetObjectItem(m->json, "results");
  if (!results) results = cJSON_AddArrayToObject(m->json, "results");
  cJSON *result = result_technique(m->specs[i]);
  cJSON_AddItemToArray(results, result);
  cJSON_AddNumberToObject(result, "step", step);
  cJSON_AddStringToObject(result, "scene", m->options->positionals[step]);
  cJSON_AddNumberToObject(result, "pixels", (double)s->pixels);
  cJSON_AddNumberToObject(result, "still", (double)s->still);
  cJSON_AddNumberToObject(result, "seen", (double)s->seen);
  cJSON_AddNumberToObject(result, "still_max", s->still_most);
  cJSON_AddNumberToObject(result, "moving", s->moving);
  cJSON_AddBoolToObject(result, "same_texel", same_texel(m, i));
}

static int tell_step(struct motion *m, int step) {
  const char *path = m->options->positionals[step], *slash = strrchr(path, '/');
  for (int i = 0; i < m->count; i++) {
    struct motion_frame before = frame_of(&m->frames[0], i), after = frame_of(&m->frames[1], i);
    struct motion_statistics s;
    if (!motion_measure(&before, &after, m->frames[0].width, m->frames[0].height, &s)) return memory_error();
    fprintf(m->people, "%-16.16s  %-24.24s %8zu %8zu %8.3f %8.4f %8.4f  %s\n", slash ? slash + 1 : path, m->specs[i],
            s.pixels, s.still, s.still ? 100.0 * (double)s.seen / (double)s.still : 0, s.still_most, s.moving,
            same_texel(m, i) ? "same" : "steps");
    add_result(m, step, i, &s);
  }
  fflush(m->people);
  return STATUS_OK;
}

static int run_steps(struct motion *m) {
  int status = draw_frame(m, 0, &m->frames[0]);
  if (!status)
    fprintf(m->people, "%-16s  %-24s %8s %8s %8s %8s %8s  texel\n", "frame", "technique", "pixels", "still", "seen %",
            "max", "moving");
  for (int step = 1; step < m->options->positional_count && !status; step++) {
    status = draw_frame(m, step, &m->frames[1]);
    if (!status) status = tell_step(m, step);
    drawn_free(&m->frames[0], m->count);
    m->frames[0] = m->frames[1];
    memset(&m->frames[1], 0, sizeof m->frames[1]);
  }
  if (!status && m->json) {
    status = write_result(m->options, m->json);
    m->json = NULL;
  }
  return status;
}

int command_motion(const struct options *o) {
  struct motion m = {.options = o, .people = options_people(o)};
  struct claims claims = {NULL, 0};
  int status = claim_options(&claims, o);
  claims_free(&claims);
  if (!status && o->json) status = output_check(o->json);
  if (!status) m.specs = technique_choice(o->techniques, o->technique_count, &m.count);
  if (!status && !m.specs) status = STATUS_FAILED;
  if (!status) status = run_steps(&m);
  for (int i = 0; i < 2; i++) drawn_free(&m.frames[i], m.count);
  cJSON_Delete(m.json);
  free(m.specs);
  return status;
}
