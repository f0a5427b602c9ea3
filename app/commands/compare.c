/* penumbra compare: several techniques against the reference. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "claims.h"
#include "commands/commands.h"
#include "commands/truth.h"
#include "host/measure.h"
#include "host/shade.h"
#include "image.h"
#include "json_file.h"
#include "message.h"
#include "output.h"
#include "report/report.h"
#include "save.h"

/* One technique's share of the work. */
struct entry {
  const char *spec;
  char *file;       /* name in --save-dir */
  cJSON *described; /* technique, label, parameters */
  pn_light *light;
  float *visibility;
  struct insides insides; /* empty where nobody asks */
  uint8_t *picture;
  struct report_stage stages[STAGES_MAX];
};

struct comparison {
  const struct options *options;
  struct scene *scene;
  struct host host;
  struct view *view;
  struct truth truth;
  struct entry *entries;
  struct contestant *contestants;
  int count;
  float *unoccluded; /* the light without shadows, for pictures */
  uint8_t *reference_picture, *mask, *background;
  struct report_technique *techniques;
  char facts[320], sizes[320];
  struct report report;
};

static size_t pixel_count(const struct comparison *c) { return (size_t)c->view->width * (size_t)c->view->height; }

/* ---- before the work: what can be wrong with the request --------------------------------------------------------- */

static const char *const inside_kinds[] = {"search", "ssm", "bound"};
enum { INSIDE_KINDS = sizeof inside_kinds / sizeof *inside_kinds };

static int claim_insides(struct claims *claims, const char *folder, const struct entry *e) {
  int status = STATUS_OK;
  for (int i = 0; i < INSIDE_KINDS && !status; i++) {
    char *name = save_name_inside(e->file, inside_kinds[i]);
    status = name ? claim_saved(claims, folder, name) : memory_error();
    free(name);
  }
  return status;
}

static int claim_files(const struct comparison *c) {
  struct claims claims = {NULL, 0};
  const char *folder = c->options->save_dir;
  int status = claim_options(&claims, c->options);
  if (!status && folder) status = claim_saved(&claims, folder, "reference.exr");
  for (int i = 0; i < c->count && folder && !status; i++) {
    status = claim_saved(&claims, folder, c->entries[i].file);
    if (!status) status = claim_insides(&claims, folder, &c->entries[i]);
  }
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

/* `average` is a second truth rather than a technique for every day, and slow: only when asked for. */
static int is_default(const pn_technique *technique) { return strcmp(technique->name, "average") != 0; }

static const char *spec_at(const struct options *o, int index) {
  if (o->technique_count) return o->techniques[index];
  for (int i = 0, seen = 0;; i++)
    if (is_default(pn_technique_at(i)) && seen++ == index) return pn_technique_at(i)->name;
}

static int count_specs(const struct options *o) {
  int count = o->technique_count;
  for (int i = 0; !o->technique_count && i < pn_technique_count(); i++) count += is_default(pn_technique_at(i));
  return count;
}

static int make_entries(struct comparison *c) {
  c->count = count_specs(c->options);
  c->entries = calloc((size_t)c->count + 1, sizeof *c->entries);
  c->contestants = calloc((size_t)c->count + 1, sizeof *c->contestants);
  c->techniques = calloc((size_t)c->count + 1, sizeof *c->techniques);
  if (!c->entries || !c->contestants || !c->techniques) return memory_error();
  for (int i = 0; i < c->count; i++) {
    struct entry *e = &c->entries[i];
    e->spec = spec_at(c->options, i);
    e->file = save_name(i, e->spec);
    e->described = cJSON_CreateObject();
    if (!e->file || !e->described) return memory_error();
    add_technique(e->described, e->spec);
    if (!cJSON_GetObjectItem(e->described, "technique")) return memory_error();
  }
  return STATUS_OK;
}

/* ---- the work ---------------------------------------------------------------------------------------------------- */

/* All techniques in turn; each one's visibility is that of its last frame. */
static int draw_techniques(struct comparison *c) {
  const struct setup *setup = &c->scene->setup;
  struct client *client = c->host.client;
  int status = STATUS_OK;
  for (int i = 0; i < c->count && !status; i++) {
    status = client_light(client, setup, &setup->light, c->entries[i].spec, &c->entries[i].light);
    c->contestants[i] = (struct contestant){.client = client, .lights = &c->entries[i].light, .light_count = 1};
  }
  if (!status) status = measure(c->contestants, c->count, c->options->frames, 1);
  for (int i = 0; i < c->count && !status; i++) {
    struct entry *e = &c->entries[i];
    e->visibility = malloc(pixel_count(c) * sizeof *e->visibility);
    status = e->visibility ? client_visibility(client, e->light, e->visibility) : memory_error();
  }
  return status;
}

static void sum_up_search(struct report_technique *t, const float *search, size_t count) {
  for (size_t p = 0; search && p < count; p++) {
    const float *pixel = search + 4 * p;
    if (pixel[0] < 3) continue; /* decided without a look at primitives */
    t->search_pixels++;
    t->search_visited += pixel[1];
    t->search_primitives += pixel[2];
    t->search_window += pixel[3];
  }
  double pixels = t->search_pixels > 0 ? t->search_pixels : 1;
  t->searched = search != NULL;
  t->search_visited /= pixels;
  t->search_primitives /= pixels;
  t->search_window /= pixels;
}

/* What techniques did on the way, for --save-dir and --json: outside the timed frames. The bound takes long, so it comes
 * with the files only. */
static int look_inside(struct comparison *c) {
  int status = STATUS_OK;
  for (int i = 0; i < c->count && !status && (c->options->save_dir || c->options->json); i++) {
    struct entry *e = &c->entries[i];
    int flags = PN_DEBUG_SEARCH | (c->options->save_dir ? PN_DEBUG_BOUND : 0);
    status = client_insides(c->host.client, e->light, flags, &e->insides);
    c->techniques[i].covered = e->insides.covered;
    if (!status) sum_up_search(&c->techniques[i], e->insides.search, pixel_count(c));
  }
  return status;
}

static int mark_pixels(struct comparison *c) {
  size_t count = pixel_count(c);
  c->mask = malloc(count);
  c->background = malloc(count);
  if (!c->mask || !c->background) return memory_error();
  for (size_t i = 0; i < count; i++) {
    c->mask[i] = c->view->mask[i] > 0;
    c->background[i] = isnan(c->view->position[3 * i]) != 0;
  }
  return STATUS_OK;
}

static int measure_errors(struct comparison *c) {
  size_t shadow_pixels = 0;
  for (int i = 0; i < c->count; i++) {
    struct error_statistics *error = &c->techniques[i].error;
    if (!error_measure(c->truth.visibility, c->entries[i].visibility, c->mask, pixel_count(c), error))
      return memory_error();
    if (error->not_finite)
      warning("%s: %zu shadow pixels have no finite visibility: its errors are undefined", c->entries[i].spec,
              error->not_finite);
    shadow_pixels += error->pixels;
    error_bound(c->truth.visibility, c->entries[i].visibility, c->mask, pixel_count(c), c->entries[i].insides.bound,
                &c->techniques[i].bound);
  }
  if (!shadow_pixels) warning("no shadow falls on what the camera sees and the light faces: errors are undefined");
  return STATUS_OK;
}

static uint8_t *make_picture(const struct comparison *c, const float *visibility) {
  size_t count = pixel_count(c);
  float *linear = malloc(3 * count * sizeof *linear);
  uint8_t *rgb = malloc(3 * count);
  if (linear && rgb) {
    shade_with(c->unoccluded, visibility, count, linear);
    for (size_t i = 0; i < 3 * count; i++) rgb[i] = srgb_byte(linear[i]);
  } else {
    free(rgb);
    rgb = NULL;
  }
  free(linear);
  return rgb;
}

static int make_pictures(struct comparison *c) {
  c->unoccluded = malloc(pixel_count(c) * sizeof *c->unoccluded);
  if (!c->unoccluded) return memory_error();
  shade_unoccluded(c->view, &c->scene->setup.light, c->unoccluded);
  if (!(c->reference_picture = make_picture(c, c->truth.visibility))) return memory_error();
  for (int i = 0; i < c->count; i++)
    if (!(c->entries[i].picture = make_picture(c, c->entries[i].visibility))) return memory_error();
  return STATUS_OK;
}

/* ---- the report -------------------------------------------------------------------------------------------------- */

static void describe_setup(struct comparison *c) {
  const struct setup *setup = &c->scene->setup;
  const struct light *light = &setup->light;
  const struct camera *camera = &setup->camera;
  const double *p = light->center, *q = light->target, *e = camera->position, *t = camera->target;
  const double *b = setup->fit_bounds;
  int sun = light->shape == PN_LIGHT_SUN;
  snprintf(c->facts, sizeof c->facts,
           "%s %.4g x %.4g%s at %.4g, %.4g, %.4g towards %.4g, %.4g, %.4g   "
           "camera at %.4g, %.4g, %.4g towards %.4g, %.4g, %.4g, %.4g degrees",
           sun ? "sun" : "rectangle light", light->size[0], light->size[1], sun ? " degrees" : "", p[0], p[1], p[2],
           q[0], q[1], q[2], e[0], e[1], e[2], t[0], t[1], t[2], camera->fov);
  char fit[120];
  if (setup->fit == PN_FIT_GIVEN)
    snprintf(fit, sizeof fit, "box %.4g, %.4g, %.4g to %.4g, %.4g, %.4g", b[0], b[1], b[2], b[3], b[4], b[5]);
  else snprintf(fit, sizeof fit, "%s", setup->fit == PN_FIT_CASTERS ? "casters" : "visible");
  snprintf(c->sizes, sizeof c->sizes, "%d x %d pixels   map %d x %d fitted to %s%s%s", c->view->width, c->view->height,
           setup->map[0], setup->map[1], fit, setup->split ? "   split: the model only casts" : "",
           setup->visibility_scale > 1 ? "   visibility at lower resolution" : "");
}

static void describe_technique(struct comparison *c, int index) {
  struct entry *e = &c->entries[index];
  struct report_technique *t = &c->techniques[index];
  const struct timing *timing = &c->contestants[index].timing;
  t->name = cJSON_GetObjectItem(e->described, "technique")->valuestring;
  t->label = e->spec;
  t->file = c->options->save_dir ? e->file : NULL;
  t->parameters = cJSON_GetObjectItem(e->described, "parameters");
  t->time_median = timing->median;
  t->time_least = timing->min;
  t->time_most = timing->max;
  for (int i = 0; i < timing->stage_count; i++)
    e->stages[i] = (struct report_stage){timing->stages[i].name, timing->stages[i].median};
  t->stages = e->stages;
  t->stage_count = timing->stage_count;
  t->visibility = e->visibility;
  t->picture = e->picture;
}

static void describe(struct comparison *c) {
  describe_setup(c);
  for (int i = 0; i < c->count; i++) describe_technique(c, i);
  c->report = (struct report){.version = pn_version(),
                              .renderer = device_renderer(c->host.device),
                              .gl_version = device_version(c->host.device),
                              .title = c->scene->name,
                              .facts = c->facts,
                              .sizes = c->sizes,
                              .samples = c->options->reference_samples,
                              .reference_ms = c->truth.seconds * 1000,
                              .width = c->view->width,
                              .height = c->view->height,
                              .reference = c->truth.visibility,
                              .reference_picture = c->reference_picture,
                              .mask = c->mask,
                              .background = c->background,
                              .techniques = c->techniques,
                              .technique_count = c->count};
}

/* ---- outputs ----------------------------------------------------------------------------------------------------- */

/* With JSON on standard output, people's lines make room. */
static FILE *people(const struct options *o) { return o->json && strcmp(o->json, "-") == 0 ? stderr : stdout; }

static int save_search(const struct save *save, const char *name, const struct insides *in) {
  const struct exr_plane planes[4] = {{"class", in->search, 4},
                                      {"primitives", in->search + 2, 4},
                                      {"visited", in->search + 1, 4},
                                      {"window", in->search + 3, 4}};
  return save_planes(save, name, planes, 4);
}

static int save_soft(const struct save *save, const char *name, const struct insides *in) {
  return save_layers(save, name, in->soft_width, in->soft_height, in->soft_layers, in->soft);
}

static int save_bound(const struct save *save, const char *name, const struct insides *in) {
  return save_scalars(save, name, in->bound);
}

static int save_insides(const struct save *save, const struct entry *e) {
  static int (*const savers[INSIDE_KINDS])(const struct save *, const char *,
                                           const struct insides *) = {save_search, save_soft, save_bound};
  const struct insides *in = &e->insides;
  const float *const there[INSIDE_KINDS] = {in->search, in->soft, in->bound};
  int status = STATUS_OK;
  for (int i = 0; i < INSIDE_KINDS && !status; i++) {
    if (!there[i]) continue;
    char *name = save_name_inside(e->file, inside_kinds[i]);
    status = name ? savers[i](save, name, in) : memory_error();
    free(name);
  }
  return status;
}

static int save_buffers(const struct comparison *c) {
  const struct save save = {c->options->save_dir, people(c->options), c->view->width, c->view->height};
  int status = save_view(&save, c->view);
  if (!status) status = save_scalars(&save, "reference.exr", c->truth.visibility);
  for (int i = 0; i < c->count && !status; i++) {
    status = save_scalars(&save, c->entries[i].file, c->entries[i].visibility);
    if (!status) status = save_insides(&save, &c->entries[i]);
  }
  return status;
}

static int report_problem(enum report_status status, const char *option, const char *path) {
  if (status == REPORT_TOO_MANY) return input_error("%s %s: too many techniques for one picture", option, path);
  return memory_error();
}

static int write_sheet(const struct comparison *c) {
  uint8_t *png = NULL;
  size_t size = 0;
  enum report_status made = report_sheet(&c->report, &png, &size);
  if (made != REPORT_OK) return report_problem(made, "--output", c->options->output);
  int status = output_write_file(c->options->output, png, size);
  free(png);
  return status;
}

static int write_page(const struct comparison *c) {
  struct output output;
  int status = output_open(&output, c->options->html);
  if (status) return status;
  enum report_status made = report_html(&c->report, output.file);
  if (made == REPORT_OK) return output_commit(&output);
  output_abort(&output);
  return report_problem(made, "--html", c->options->html);
}

static int write_json(struct comparison *c) {
  cJSON *begun = result_begin(&c->host);
  c->report.scene = cJSON_GetObjectItem(begun, "scene");
  cJSON *json = c->report.scene ? report_json(&c->report) : NULL;
  cJSON_Delete(begun);
  c->report.scene = NULL;
  return json_write(c->options->json, json);
}

static int write_outputs(struct comparison *c) {
  const struct options *o = c->options;
  FILE *file = people(o);
  const struct truth *truth = &c->truth;
  fprintf(file, "reference: %d ray%s a pixel, %.1f s", o->reference_samples, o->reference_samples == 1 ? "" : "s",
          truth->seconds);
  if (truth->from_cache) fputs(", from the cache", file);
  else if (truth->rays > 0 && truth->seconds > 0)
    fprintf(file, ", %.1f million rays a second", truth->rays / truth->seconds / 1e6);
  fputs("\n\n", file);
  report_table(&c->report, file);
  fputc('\n', file);
  int status = o->save_dir ? save_buffers(c) : STATUS_OK;
  if (!status && o->output && !(status = write_sheet(c))) fprintf(file, "%s\n", o->output);
  if (!status && o->html && !(status = write_page(c))) fprintf(file, "%s\n", o->html);
  if (!status && o->json && !(status = write_json(c)) && file == stdout) fprintf(file, "%s\n", o->json);
  return status;
}

/* ---- the command ------------------------------------------------------------------------------------------------- */

static int compare(struct comparison *c) {
  const struct options *o = c->options;
  int status = make_entries(c);
  if (!status) status = check_outputs(c);
  if (!status) status = options_scene(o, NULL, &c->scene);
  if (!status) status = host_open(c->scene, o->device, &c->host);
  if (!status) status = view_read(c->host.gbuffer, c->scene, &c->view);
  if (!status) status = mark_pixels(c);
  if (!status) status = draw_techniques(c);
  if (!status) status = look_inside(c);
  if (!status)
    status =
        truth_trace(c->scene, c->host.gbuffer, c->view, o->reference_samples, !o->given[OPTION_NO_CACHE], &c->truth);
  if (!status) status = measure_errors(c);
  if (!status && (o->output || o->html)) status = make_pictures(c);
  if (status) return status;
  describe(c);
  return write_outputs(c);
}

static void free_comparison(struct comparison *c) {
  for (int i = 0; c->entries && i < c->count; i++) {
    free(c->entries[i].file);
    cJSON_Delete(c->entries[i].described);
    free(c->entries[i].visibility);
    insides_free(&c->entries[i].insides);
    free(c->entries[i].picture);
  }
  free(c->entries);
  free(c->contestants);
  free(c->techniques);
  free(c->unoccluded);
  free(c->reference_picture);
  free(c->mask);
  free(c->background);
  free(c->truth.visibility);
  view_free(&c->view);
  host_close(&c->host);
  scene_free(&c->scene);
}

int command_compare(const struct options *options) {
  struct comparison c = {.options = options};
  int status = compare(&c);
  if (status) save_abandon();
  free_comparison(&c);
  return status;
}
