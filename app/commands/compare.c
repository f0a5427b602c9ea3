/* penumbra compare: several techniques against the reference. */
#include <stdlib.h>

#include "base/message.h"
#include "commands/commands.h"
#include "commands/outputs.h"
#include "experiment/choice.h"
#include "experiment/findings.h"
#include "files/image.h"
#include "files/output.h"

struct comparison {
  const struct options *options;
  const char **specs;
  int count;
  struct scene *scene;
  struct experiment experiment;
  struct findings findings;
  FILE *people;
};

/* ---- before the work: what can be wrong with the request --------------------------------------------------------- */

static int claim_files(const struct comparison *c) {
  struct claims claims = {NULL, 0};
  const char *folder = c->options->save_dir;
  const unsigned insides = 1 << INSIDE_SEARCH | 1 << INSIDE_SOFT | 1 << INSIDE_BOUND;
  int status = claim_options(&claims, c->options);
  if (!status && folder) status = claim_saved(&claims, folder, "reference.exr");
  for (int i = 0; i < c->count && folder && !status; i++)
    status = claim_technique(&claims, folder, i, c->specs[i], insides);
  claims_free(&claims);
  return status;
}

static int check_outputs(const struct comparison *c) {
  const struct options *o = c->options;
  if (o->output && image_kind_of(o->output) != IMAGE_PNG)
    return input_error("--output %s: the comparison sheet is a .png file", o->output);
  int status = claim_files(c);
  if (!status && o->output) status = output_check(o->output);
  if (!status && o->html) status = output_check(o->html);
  if (!status && o->json) status = output_check(o->json);
  if (!status && o->save_dir) status = save_check(o->save_dir);
  return status;
}

/* ---- the work ---------------------------------------------------------------------------------------------------- */

/* What techniques did on the way goes into the files and the JSON; the bound takes long, so it comes with the files
 * only. */
static int look_inside(struct comparison *c) {
  const struct options *o = c->options;
  int status = STATUS_OK, flags = PN_DEBUG_SEARCH | (o->save_dir ? PN_DEBUG_BOUND : 0);
  for (int i = 0; i < c->count && (o->save_dir || o->json) && !status; i++)
    status = experiment_look(&c->experiment, i, flags);
  return status;
}

static int run_experiment(struct comparison *c) {
  const struct options *o = c->options;
  struct experiment *e = &c->experiment;
  int status = experiment_open(e, c->scene, o->device, c->specs, c->count);
  if (!status) status = experiment_measure(e, o->frames, 1);
  for (int i = 0; i < c->count && !status; i++) status = experiment_draw(e, i);
  if (!status) status = look_inside(c);
  if (!status) status = experiment_trace(e, o->reference_samples, !o->given[OPTION_NO_CACHE]);
  if (!status) status = experiment_errors(e);
  if (!status && (o->output || o->html)) status = experiment_pictures(e);
  return status ? status : findings_make(e, o->reference_samples, o->save_dir != NULL, &c->findings);
}

/* ---- outputs ----------------------------------------------------------------------------------------------------- */

static int save_buffers(const struct comparison *c) {
  const struct experiment *e = &c->experiment;
  const struct save save = {c->options->save_dir, c->people, e->view->width, e->view->height};
  int status = save_view(&save, e->view);
  if (!status) status = save_scalars(&save, "reference.exr", e->truth.visibility);
  for (int i = 0; i < e->count && !status; i++)
    status = save_technique(&save, i, e->entries[i].spec, e->entries[i].visibility, &e->entries[i].insides);
  return status;
}

static int report_problem(enum report_status status, const char *option, const char *path) {
  if (status == REPORT_TOO_MANY) return input_error("%s %s: too many techniques for one picture", option, path);
  return memory_error();
}

static int write_sheet(const struct comparison *c) {
  uint8_t *png = NULL;
  size_t size = 0;
  enum report_status made = report_sheet(&c->findings.report, &png, &size);
  if (made != REPORT_OK) return report_problem(made, "--output", c->options->output);
  int status = output_write_file(c->options->output, png, size);
  free(png);
  if (!status) fprintf(c->people, "%s\n", c->options->output);
  return status;
}

static int write_page(const struct comparison *c) {
  struct output output;
  int status = output_open(&output, c->options->html);
  if (status) return status;
  enum report_status made = report_html(&c->findings.report, output.file);
  if (made != REPORT_OK) {
    output_abort(&output);
    return report_problem(made, "--html", c->options->html);
  }
  status = output_commit(&output);
  if (!status && !output_is_standard(c->options->html)) fprintf(c->people, "%s\n", c->options->html);
  return status;
}

static void print_table(const struct comparison *c) {
  const struct truth *truth = &c->experiment.truth;
  int samples = c->options->reference_samples;
  fprintf(c->people, "reference: %d ray%s a pixel, %.1f s", samples, samples == 1 ? "" : "s", truth->seconds);
  if (truth->from_cache) fputs(", from the cache", c->people);
  else if (truth->rays > 0 && truth->seconds > 0)
    fprintf(c->people, ", %.1f million rays a second", truth->rays / truth->seconds / 1e6);
  fputs("\n\n", c->people);
  report_table(&c->findings.report, c->people);
  fputc('\n', c->people);
}

static int write_outputs(const struct comparison *c) {
  const struct options *o = c->options;
  print_table(c);
  int status = o->save_dir ? save_buffers(c) : STATUS_OK;
  if (!status && o->output) status = write_sheet(c);
  if (!status && o->html) status = write_page(c);
  if (!status && o->json) status = write_result(o, report_json(&c->findings.report));
  return status;
}

/* ---- the command ------------------------------------------------------------------------------------------------- */

static int compare(struct comparison *c) {
  const struct options *o = c->options;
  c->specs = technique_choice(o->techniques, o->technique_count, &c->count);
  if (!c->specs) return STATUS_FAILED;
  int status = check_outputs(c);
  if (!status) status = options_scene(o, NULL, &c->scene);
  if (!status) status = run_experiment(c);
  return status ? status : write_outputs(c);
}

int command_compare(const struct options *options) {
  struct comparison c = {.options = options, .people = options_people(options)};
  int status = compare(&c);
  if (status) save_abandon();
  findings_free(&c.findings);
  experiment_close(&c.experiment);
  scene_free(&c.scene);
  free(c.specs);
  return status;
}
