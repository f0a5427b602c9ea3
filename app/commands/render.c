/* penumbra render: one picture of a scene under each technique. */
#include <stdlib.h>
#include <string.h>

#include "commands/commands.h"
#include "host/measure.h"
#include "host/shade.h"
#include "json_file.h"
#include "label.h"
#include "message.h"
#include "output.h"

/* Until measurement finds the technique and preset that serve everyday use best. */
static const char default_technique[] = "pcss";

struct picture {
  const char *spec;
  char *path;
  pn_light *light;
};

/* A fixed order of work: what can be wrong with the outputs is found before anything is drawn. */
static int name_pictures(const struct options *o, const struct scene *scene, struct picture *pictures, int count) {
  if (o->output && count > 1) return input_error("--output names one file, but there are %d techniques: leave it out", count);
  for (int i = 0; i < count; i++) {
    pictures[i].spec = o->technique_count ? o->techniques[i] : default_technique;
    pictures[i].path = o->output ? strdup(o->output) : picture_name(scene->name, pictures[i].spec, ".png");
    if (!pictures[i].path) return memory_error();
    int status = output_check(pictures[i].path);
    if (status) return status;
  }
  return o->json ? output_check(o->json) : STATUS_OK;
}

static int measure_pictures(const struct options *o, struct host *host, struct picture *pictures, struct contestant *c, int count) {
  const struct setup *setup = &host->scene->setup;
  for (int i = 0; i < count; i++) {
    int status = client_light(host->client, setup, &setup->light, pictures[i].spec, &pictures[i].light);
    if (status) return status;
    c[i] = (struct contestant){.client = host->client, .lights = &pictures[i].light, .light_count = 1};
  }
  return measure(c, count, o->frames, o->json != NULL);
}

static int write_picture(struct host *host, const struct view *view, const struct picture *picture, float *visibility, float *rgb) {
  int status = client_frame(host->client, picture->light);
  if (!status) status = client_visibility(host->client, picture->light, visibility);
  if (status) return status;
  shade(view, &host->scene->setup.light, visibility, rgb);
  return picture_write(picture->path, view->width, view->height, rgb);
}

static void warn_if_unlit(const struct view *view) {
  size_t count = (size_t)view->width * (size_t)view->height, facing = 0, drawn = 0;
  for (size_t i = 0; i < count; i++) {
    facing += view->mask[i] > 0;
    drawn += view->position[3 * i] == view->position[3 * i];
  }
  if (!drawn) warning("the camera sees nothing of the scene: check --camera-position, --camera-target and --fov");
  else if (!facing) warning("no receiver that the camera sees faces the light: check --light-center and --light-target");
}

static int write_json(const struct options *o, const struct host *host, const struct picture *pictures, const struct contestant *c, int count) {
  cJSON *object = result_begin(host), *results = cJSON_AddArrayToObject(object, "results");
  for (int i = 0; i < count && results; i++) {
    cJSON *result = cJSON_CreateObject();
    cJSON_AddItemToArray(results, result);
    add_technique(result, pictures[i].spec);
    cJSON_AddStringToObject(result, "file", pictures[i].path);
    cJSON_AddItemToObject(result, "time_ms", timing_to_json(&c[i].timing));
  }
  return json_write(o->json, object);
}

static int draw_and_write(const struct options *o, struct host *host, struct picture *pictures, int count) {
  struct contestant *c = calloc((size_t)count + 1, sizeof *c);
  size_t pixels = (size_t)host->gbuffer->width * (size_t)host->gbuffer->height;
  float *visibility = malloc(pixels * sizeof *visibility), *rgb = malloc(pixels * 3 * sizeof *rgb);
  struct view *view = NULL;
  int status = c && visibility && rgb ? view_read(host->gbuffer, host->scene, &view) : memory_error();
  if (!status) {
    warn_if_unlit(view);
    status = measure_pictures(o, host, pictures, c, count);
  }
  /* With the JSON on standard output, people's lines make room. */
  FILE *people = o->json && strcmp(o->json, "-") == 0 ? stderr : stdout;
  for (int i = 0; i < count && !status; i++) {
    status = write_picture(host, view, &pictures[i], visibility, rgb);
    if (!status) fprintf(people, "%s  %.2f ms a frame (%s, median of %d)\n", pictures[i].path, c[i].timing.median, pictures[i].spec, c[i].timing.frames);
  }
  if (!status && o->json) status = write_json(o, host, pictures, c, count);
  if (!status && o->json && people == stdout) puts(o->json);
  view_free(&view);
  free(visibility);
  free(rgb);
  free(c);
  return status;
}

int command_render(const struct options *o) {
  int count = o->technique_count ? o->technique_count : 1;
  struct picture *pictures = calloc((size_t)count, sizeof *pictures);
  struct scene *scene = NULL;
  struct host host = {0};
  int status = pictures ? options_scene(o, NULL, &scene) : memory_error();
  if (!status) status = name_pictures(o, scene, pictures, count);
  if (!status) status = host_open(scene, o->device, &host);
  if (!status) status = draw_and_write(o, &host, pictures, count);
  host_close(&host);
  scene_free(&scene);
  for (int i = 0; pictures && i < count; i++) free(pictures[i].path);
  free(pictures);
  return status;
}
