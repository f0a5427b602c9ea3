/* penumbra render: one picture of a scene under each technique. */
#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "commands/commands.h"
#include "commands/outputs.h"
#include "experiment/experiment.h"
#include "experiment/result.h"
#include "files/label.h"
#include "files/output.h"
#include "files/picture.h"
#include "host/shade.h"

static const char *const default_techniques[] = {PN_TECHNIQUE_DEFAULT};

struct rendering {
  const struct options *options;
  const char *const *specs;
  char **paths; /* of the pictures */
  int count;
  struct claims claims;
  struct scene *scene;
  struct experiment experiment;
  float *rgb;
  FILE *people;
};

/* ---- before the work: what can be wrong with the request --------------------------------------------------------- */

static int claim_files(struct rendering *r) {
  const struct options *o = r->options;
  int status = claim_options(&r->claims, o);
  for (int i = 0; i < r->count && o->save_dir && !status; i++)
    status = claim_technique(&r->claims, o->save_dir, i, r->specs[i], 1 << INSIDE_SOFT);
  return status;
}

static int claim_picture(struct rendering *r, int index) {
  char what[120];
  snprintf(what, sizeof what, "the picture of %.80s", r->specs[index]);
  return claim_write(&r->claims, what, r->paths[index]);
}

/* A fixed order of work: what can be wrong with the outputs is found before anything is drawn. */
static int name_pictures(struct rendering *r) {
  const struct options *o = r->options;
  for (int i = 0; i < r->count; i++) {
    r->paths[i] = o->output ? strdup(o->output) : picture_name(r->scene->name, r->specs[i], ".png");
    if (!r->paths[i]) return memory_error();
    int status = o->output ? STATUS_OK : claim_picture(r, i);
    if (!status) status = output_check(r->paths[i]);
    if (status) return status;
  }
  int status = o->json ? output_check(o->json) : STATUS_OK;
  return !status && o->save_dir ? save_check(o->save_dir) : status;
}

/* ---- the work, and outputs --------------------------------------------------------------------------------------- */

static void warn_if_unlit(const struct view *view) {
  size_t count = (size_t)view->width * (size_t)view->height, facing = 0, drawn = 0;
  for (size_t i = 0; i < count; i++) {
    facing += view->mask[i] > 0;
    drawn += view->position[3 * i] == view->position[3 * i];
  }
  if (!drawn) warning("the camera sees nothing of the scene: check --camera-position, --camera-target and --fov");
  else if (!facing)
    warning("no receiver that the camera sees faces the light: check --light-center and --light-target");
}

static int save_buffers(struct rendering *r, int index) {
  const struct view *view = r->experiment.view;
  const struct entry *entry = &r->experiment.entries[index];
  const struct save save = {r->options->save_dir, r->people, view->width, view->height};
  int status = index == 0 ? save_view(&save, view) : STATUS_OK;
  return status ? status : save_technique(&save, index, entry->spec, entry->visibility, &entry->insides);
}

/* Pictures come one after the other, so that no more than one visibility takes memory. */
static int write_picture(struct rendering *r, int index) {
  struct experiment *e = &r->experiment;
  const struct entry *entry = &e->entries[index];
  int status = experiment_draw(e, index);
  if (!status && r->options->save_dir) status = experiment_look(e, index, 0);
  if (status) return status;
  shade(e->view, &r->scene->setup.light, entry->visibility, r->rgb);
  status = picture_write(r->paths[index], e->view->width, e->view->height, r->rgb);
  if (status) return status;
  fprintf(r->people, "%s  %.2f ms a frame (%s, median of %d)\n", r->paths[index], entry->timing.median, entry->spec,
          entry->timing.frames);
  if (r->options->save_dir) status = save_buffers(r, index);
  experiment_drop(e, index);
  return status;
}

static int write_json(const struct rendering *r) {
  cJSON *object = result_begin(&r->experiment.host), *results = cJSON_AddArrayToObject(object, "results");
  for (int i = 0; i < r->count && results; i++) {
    cJSON *result = result_technique(r->specs[i]);
    cJSON_AddItemToArray(results, result);
    cJSON_AddStringToObject(result, "file", r->paths[i]);
    cJSON_AddItemToObject(result, "time_ms", result_times(&r->experiment.entries[i].timing));
  }
  return write_result(r->options, object);
}

static int draw_and_write(struct rendering *r) {
  const struct options *o = r->options;
  struct experiment *e = &r->experiment;
  int status = experiment_open(e, r->scene, o->device, r->specs, r->count);
  if (status) return status;
  r->rgb = malloc((size_t)e->view->width * (size_t)e->view->height * 3 * sizeof *r->rgb);
  if (!r->rgb) return memory_error();
  warn_if_unlit(e->view);
  status = experiment_measure(e, o->frames, o->json != NULL);
  for (int i = 0; i < r->count && !status; i++) status = write_picture(r, i);
  if (!status && o->json) status = write_json(r);
  return status;
}

/* ---- the command ------------------------------------------------------------------------------------------------- */

static int render(struct rendering *r) {
  const struct options *o = r->options;
  if (o->output && r->count > 1)
    return input_error("--output names one file, but there are %d techniques: leave it out", r->count);
  r->paths = calloc((size_t)r->count, sizeof *r->paths);
  int status = r->paths ? claim_files(r) : memory_error();
  if (!status) status = options_scene(o, NULL, &r->scene);
  if (!status) status = name_pictures(r);
  return status ? status : draw_and_write(r);
}

int command_render(const struct options *o) {
  struct rendering r = {.options = o,
                        .specs = o->technique_count ? o->techniques : default_techniques,
                        .count = o->technique_count ? o->technique_count : 1,
                        .people = options_people(o)};
  int status = render(&r);
  if (status) save_abandon();
  experiment_close(&r.experiment);
  scene_free(&r.scene);
  claims_free(&r.claims);
  for (int i = 0; r.paths && i < r.count; i++) free(r.paths[i]);
  free(r.paths);
  free(r.rgb);
  return status;
}
