#include "experiment/experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "files/image.h"
#include "host/shade.h"

static size_t pixel_count(const struct experiment *e) { return (size_t)e->view->width * (size_t)e->view->height; }

int experiment_open(struct experiment *e, const struct scene *scene, const char *device, const char *const *specs,
                    int count) {
  memset(e, 0, sizeof *e);
  e->entries = calloc((size_t)count + 1, sizeof *e->entries);
  if (!e->entries) return memory_error();
  e->count = count;
  for (int i = 0; i < count; i++) e->entries[i].spec = specs[i];
  int status = host_open(scene, device, &e->host);
  return status ? status : view_read(e->host.gbuffer, scene, &e->view);
}

void experiment_drop(struct experiment *e, int index) {
  free(e->entries[index].visibility);
  e->entries[index].visibility = NULL;
  insides_free(&e->entries[index].insides);
}

void experiment_close(struct experiment *e) {
  for (int i = 0; i < e->count; i++) {
    experiment_drop(e, i);
    free(e->entries[i].picture);
  }
  free(e->entries);
  free(e->truth.visibility);
  free(e->mask);
  free(e->background);
  free(e->unoccluded);
  free(e->reference_picture);
  view_free(&e->view);
  host_close(&e->host);
  memset(e, 0, sizeof *e);
}

/* ---- techniques -------------------------------------------------------------------------------------------------- */

static int make_lights(struct experiment *e, struct contestant *contestants) {
  const struct setup *setup = &e->host.scene->setup;
  int status = STATUS_OK;
  for (int i = 0; i < e->count && !status; i++) {
    struct entry *entry = &e->entries[i];
    status = client_light(e->host.client, setup, &setup->light, entry->spec, &entry->light);
    contestants[i] = (struct contestant){.client = e->host.client, .lights = &entry->light, .light_count = 1};
  }
  return status;
}

int experiment_measure(struct experiment *e, int frames, int stages) {
  struct contestant *contestants = calloc((size_t)e->count + 1, sizeof *contestants);
  if (!contestants) return memory_error();
  int status = make_lights(e, contestants);
  if (!status) status = measure(contestants, e->count, frames, stages);
  for (int i = 0; i < e->count && !status; i++) e->entries[i].timing = contestants[i].timing;
  free(contestants);
  return status;
}

int experiment_draw(struct experiment *e, int index) {
  struct entry *entry = &e->entries[index];
  if (!entry->visibility) entry->visibility = malloc(pixel_count(e) * sizeof *entry->visibility);
  if (!entry->visibility) return memory_error();
  return client_visibility(e->host.client, entry->light, entry->visibility);
}

static struct search_means sum_up_search(const float *search, size_t count) {
  struct search_means means = {.searched = search != NULL};
  for (size_t p = 0; search && p < count; p++) {
    const float *pixel = search + 4 * p;
    if (pixel[0] < 3) continue; /* decided without a look at primitives */
    means.pixels++;
    means.visited += pixel[1];
    means.primitives += pixel[2];
    means.window += pixel[3];
  }
  double pixels = means.pixels > 0 ? means.pixels : 1;
  means.visited /= pixels;
  means.primitives /= pixels;
  means.window /= pixels;
  return means;
}

int experiment_look(struct experiment *e, int index, int debug_flags) {
  struct entry *entry = &e->entries[index];
  insides_free(&entry->insides);
  int status = client_insides(e->host.client, entry->light, debug_flags, &entry->insides);
  if (!status) entry->search = sum_up_search(entry->insides.search, pixel_count(e));
  return status;
}

/* ---- truth and errors -------------------------------------------------------------------------------------------- */

int experiment_trace(struct experiment *e, int samples, int use_cache) {
  free(e->truth.visibility);
  return truth_trace(e->host.scene, e->host.gbuffer, e->view, samples, use_cache, &e->truth);
}

static int mark_pixels(struct experiment *e) {
  size_t count = pixel_count(e);
  if (!e->mask) e->mask = malloc(count);
  if (!e->background) e->background = malloc(count);
  if (!e->unoccluded) e->unoccluded = malloc(count * sizeof *e->unoccluded);
  if (!e->mask || !e->background || !e->unoccluded) return memory_error();
  shade_unoccluded(e->view, &e->host.scene->setup.light, e->unoccluded);
  for (size_t i = 0; i < count; i++) {
    e->mask[i] = e->view->mask[i] > 0;
    e->background[i] = isnan(e->view->position[3 * i]) != 0;
  }
  return STATUS_OK;
}

static void warn_of_broken(const struct entry *entry) {
  if (entry->error.not_finite)
    warning("%s: %zu shadow pixels have no finite visibility: its errors are undefined", entry->spec,
            entry->error.not_finite);
  else if (entry->all.not_finite)
    warning("%s: %zu pixels that face a part of the light have no finite visibility: errors over all are undefined",
            entry->spec, entry->all.not_finite);
}

/* The very values that `render` writes, of truth and of each technique. truth, result: room for them. */
static void compare_pictures(struct experiment *e, float *truth, float *result) {
  size_t count = pixel_count(e);
  shade_with(e->unoccluded, e->truth.visibility, count, truth);
  for (int i = 0; i < e->count; i++) {
    shade_with(e->unoccluded, e->entries[i].visibility, count, result);
    e->entries[i].picture_error = error_picture(truth, result, e->view->receives, count);
  }
}

static int picture_errors(struct experiment *e) {
  size_t size = 3 * pixel_count(e) * sizeof(float);
  float *truth = malloc(size), *result = malloc(size);
  int there = truth && result;
  if (there) compare_pictures(e, truth, result);
  free(truth);
  free(result);
  return there ? STATUS_OK : memory_error();
}

int experiment_errors(struct experiment *e) {
  const float *truth = e->truth.visibility;
  size_t shadow_pixels = 0, count = pixel_count(e);
  int status = mark_pixels(e);
  if (status) return status;
  for (int i = 0; i < e->count; i++) {
    struct entry *entry = &e->entries[i];
    if (!error_measure(truth, entry->visibility, e->mask, count, &entry->error) ||
        !error_measure_all(truth, entry->visibility, e->view->faces, count, &entry->all))
      return memory_error();
    warn_of_broken(entry);
    shadow_pixels += entry->error.pixels;
    error_bound(truth, entry->visibility, e->mask, count, entry->insides.bound, &entry->bound);
  }
  if (!shadow_pixels) warning("no shadow falls on what the camera sees and the light faces: errors are undefined");
  return picture_errors(e);
}

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

static int make_picture(const float *unoccluded, const float *visibility, size_t count, uint8_t **out) {
  free(*out);
  float *linear = malloc(3 * count * sizeof *linear);
  *out = linear ? malloc(3 * count) : NULL;
  if (*out) {
    shade_with(unoccluded, visibility, count, linear);
    srgb_bytes(linear, 3 * count, *out);
  }
  free(linear);
  return *out ? STATUS_OK : memory_error();
}

int experiment_pictures(struct experiment *e) {
  size_t count = pixel_count(e);
  int status = make_picture(e->unoccluded, e->truth.visibility, count, &e->reference_picture);
  for (int i = 0; i < e->count && !status; i++)
    status = make_picture(e->unoccluded, e->entries[i].visibility, count, &e->entries[i].picture);
  return status;
}
