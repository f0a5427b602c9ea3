/* penumbra render: one picture of a scene under each technique. */
#include <stdlib.h>
#include <string.h>

#include "claims.h"
#include "commands/commands.h"
#include "host/measure.h"
#include "host/shade.h"
#include "json_file.h"
#include "label.h"
#include "message.h"
#include "output.h"
#include "save.h"

static const char default_technique[] = PN_TECHNIQUE_DEFAULT;

struct picture {
  const char *spec;
  char *path;
  pn_light *light;
};

static int claim_buffers(const struct options *o, struct claims *claims) {
  int status = STATUS_OK;
  for (int i = 0; o->save_dir && !status && (i < o->technique_count || i == 0); i++) {
    char *name = save_name(i, o->technique_count ? o->techniques[i] : default_technique);
    char *soft = name ? save_name_inside(name, "ssm") : NULL;
    status = soft ? claim_saved(claims, o->save_dir, name) : memory_error();
    if (!status) status = claim_saved(claims, o->save_dir, soft);
    free(name);
    free(soft);
  }
  return status;
}

static int claim_picture(const struct picture *picture, struct claims *claims) {
  char what[120];
  snprintf(what, sizeof what, "the picture of %.80s", picture->spec);
  return claim_write(claims, what, picture->path);
}

/* A fixed order of work: what can be wrong with the outputs is found before anything is drawn. */
static int name_pictures(const struct options *o, const struct scene *scene, struct claims *claims,
                         struct picture *pictures, int count) {
  for (int i = 0; i < count; i++) {
    pictures[i].spec = o->technique_count ? o->techniques[i] : default_technique;
    pictures[i].path = o->output ? strdup(o->output) : picture_name(scene->name, pictures[i].spec, ".png");
    if (!pictures[i].path) return memory_error();
    int status = o->output ? STATUS_OK : claim_picture(&pictures[i], claims);
    if (!status) status = output_check(pictures[i].path);
    if (status) return status;
  }
  int status = o->json ? output_check(o->json) : STATUS_OK;
  return !status && o->save_dir ? save_check(o->save_dir) : status;
}

static int measure_pictures(const struct options *o, struct host *host, struct picture *pictures, struct contestant *c,
                            int count) {
  const struct setup *setup = &host->scene->setup;
  for (int i = 0; i < count; i++) {
    int status = client_light(host->client, setup, &setup->light, pictures[i].spec, &pictures[i].light);
    if (status) return status;
    c[i] = (struct contestant){.client = host->client, .lights = &pictures[i].light, .light_count = 1};
  }
  return measure(c, count, o->frames, o->json != NULL);
}

/* What one run draws into, and where it tells people what it wrote. */
struct drawing {
  const struct options *options;
  struct host *host;
  struct picture *pictures;
  struct contestant *contestants;
  int count;
  struct view *view;
  float *visibility, *rgb;
  FILE *people;
};

static int save_soft(const struct drawing *d, const struct save *save, int index, const char *name) {
  struct insides insides = {0};
  char *soft = name ? save_name_inside(name, "ssm") : NULL;
  int status = soft ? client_insides(d->host->client, d->pictures[index].light, 0, &insides) : memory_error();
  if (!status && insides.soft)
    status = save_layers(save, soft, insides.soft_width, insides.soft_height, insides.soft_layers, insides.soft);
  insides_free(&insides);
  free(soft);
  return status;
}

static int save_visibility(const struct drawing *d, int index) {
  const struct save save = {d->options->save_dir, d->people, d->view->width, d->view->height};
  int status = index == 0 ? save_view(&save, d->view) : STATUS_OK;
  char *name = save_name(index, d->pictures[index].spec);
  if (!status) status = name ? save_scalars(&save, name, d->visibility) : memory_error();
  if (!status) status = save_soft(d, &save, index, name);
  free(name);
  return status;
}

static int write_picture(const struct drawing *d, int index) {
  const struct picture *picture = &d->pictures[index];
  const struct timing *timing = &d->contestants[index].timing;
  int status = client_frame(d->host->client, picture->light);
  if (!status) status = client_visibility(d->host->client, picture->light, d->visibility);
  if (status) return status;
  shade(d->view, &d->host->scene->setup.light, d->visibility, d->rgb);
  status = picture_write(picture->path, d->view->width, d->view->height, d->rgb);
  if (status) return status;
  fprintf(d->people, "%s  %.2f ms a frame (%s, median of %d)\n", picture->path, timing->median, picture->spec,
          timing->frames);
  return d->options->save_dir ? save_visibility(d, index) : STATUS_OK;
}

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

static int write_json(const struct drawing *d) {
  cJSON *object = result_begin(d->host), *results = cJSON_AddArrayToObject(object, "results");
  for (int i = 0; i < d->count && results; i++) {
    cJSON *result = cJSON_CreateObject();
    cJSON_AddItemToArray(results, result);
    add_technique(result, d->pictures[i].spec);
    cJSON_AddStringToObject(result, "file", d->pictures[i].path);
    cJSON_AddItemToObject(result, "time_ms", timing_to_json(&d->contestants[i].timing));
  }
  int status = json_write(d->options->json, object);
  if (!status && d->people == stdout) puts(d->options->json);
  return status;
}

static int allocate(struct drawing *d) {
  size_t pixels = (size_t)d->host->gbuffer->width * (size_t)d->host->gbuffer->height;
  d->contestants = calloc((size_t)d->count + 1, sizeof *d->contestants);
  d->visibility = malloc(pixels * sizeof *d->visibility);
  d->rgb = malloc(pixels * 3 * sizeof *d->rgb);
  if (!d->contestants || !d->visibility || !d->rgb) return memory_error();
  return view_read(d->host->gbuffer, d->host->scene, &d->view);
}

static int draw_and_write(const struct options *o, struct host *host, struct picture *pictures, int count) {
  struct drawing d = {.options = o, .host = host, .pictures = pictures, .count = count};
  /* With the JSON on standard output, people's lines make room. */
  d.people = o->json && strcmp(o->json, "-") == 0 ? stderr : stdout;
  int status = allocate(&d);
  if (!status) {
    warn_if_unlit(d.view);
    status = measure_pictures(o, host, pictures, d.contestants, count);
  }
  for (int i = 0; i < count && !status; i++) status = write_picture(&d, i);
  if (!status && o->json) status = write_json(&d);
  view_free(&d.view);
  free(d.visibility);
  free(d.rgb);
  free(d.contestants);
  return status;
}

static int render(const struct options *o, struct claims *claims, struct picture *pictures, int count) {
  if (o->output && count > 1)
    return input_error("--output names one file, but there are %d techniques: leave it out", count);
  struct scene *scene = NULL;
  struct host host = {0};
  int status = claim_options(claims, o);
  if (!status) status = claim_buffers(o, claims);
  if (!status) status = options_scene(o, NULL, &scene);
  if (!status) status = name_pictures(o, scene, claims, pictures, count);
  if (!status) status = host_open(scene, o->device, &host);
  if (!status) status = draw_and_write(o, &host, pictures, count);
  host_close(&host);
  scene_free(&scene);
  return status;
}

int command_render(const struct options *o) {
  int count = o->technique_count ? o->technique_count : 1;
  struct picture *pictures = calloc((size_t)count, sizeof *pictures);
  struct claims claims = {NULL, 0};
  int status = pictures ? render(o, &claims, pictures, count) : memory_error();
  if (status) save_abandon();
  claims_free(&claims);
  for (int i = 0; pictures && i < count; i++) free(pictures[i].path);
  free(pictures);
  return status;
}
