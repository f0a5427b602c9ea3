#include <math.h>
#include <stdlib.h>

#include "report/report.h"

/* Every function here returns nonzero only when all of it could be added; what was added belongs to the parent in any
 * case. cJSON writes numbers that are not finite as null. */

static int add_number(cJSON *object, const char *name, double value) {
  return cJSON_AddNumberToObject(object, name, value) != NULL;
}

static int add_text(cJSON *object, const char *name, const char *value) {
  return (value ? cJSON_AddStringToObject(object, name, value) : cJSON_AddNullToObject(object, name)) != NULL;
}

static int add_copy(cJSON *object, const char *name, const cJSON *value) {
  cJSON *copy = value ? cJSON_Duplicate(value, 1) : cJSON_CreateObject();
  if (copy && cJSON_AddItemToObject(object, name, copy)) return 1;
  cJSON_Delete(copy);
  return 0;
}

static int add_error(cJSON *object, const struct error_statistics *error) {
  cJSON *item = cJSON_AddObjectToObject(object, "error");
  return item && add_number(item, "mae", error->mae) && add_number(item, "rmse", error->rmse) &&
         add_number(item, "p95", error->p95) && add_number(item, "max", error->max) &&
         add_number(item, "bias", error->bias) && add_number(item, "pixels", (double)error->pixels);
}

static int add_times(cJSON *object, const struct report_technique *technique) {
  cJSON *times = cJSON_AddObjectToObject(object, "time_ms");
  cJSON *total = times ? cJSON_AddObjectToObject(times, "total") : NULL,
        *stages = times ? cJSON_AddObjectToObject(times, "stages") : NULL;
  if (!total || !stages || !add_number(total, "median", technique->time_median) ||
      !add_number(total, "min", technique->time_least) || !add_number(total, "max", technique->time_most))
    return 0;
  for (int i = 0; i < technique->stage_count; i++)
    if (!add_number(stages, technique->stages[i].name, technique->stages[i].milliseconds)) return 0;
  return 1;
}

/* Means over the pixels that looked at primitives; only of techniques that search. */
static int add_search(cJSON *object, const struct report_technique *technique) {
  if (!technique->searched) return 1;
  cJSON *item = cJSON_AddObjectToObject(object, "search");
  return item && add_number(item, "pixels", technique->search_pixels) &&
         add_number(item, "visited", technique->search_visited) &&
         add_number(item, "primitives", technique->search_primitives) &&
         add_number(item, "window", technique->search_window);
}

/* The technique's own bound of its error, held against the error, over shadow pixels. */
static int add_bound(cJSON *object, const struct error_bound *bound) {
  if (!bound->pixels) return 1;
  cJSON *item = cJSON_AddObjectToObject(object, "bound");
  return item && add_number(item, "mean", bound->mean) && add_number(item, "max", bound->max) &&
         add_number(item, "held", bound->held);
}

/* Of techniques that scatter. */
static int add_scatter(cJSON *object, const struct report_technique *technique) {
  if (technique->covered <= 0) return 1;
  cJSON *item = cJSON_AddObjectToObject(object, "scatter");
  return item && add_number(item, "covered", technique->covered);
}

static int add_result(cJSON *results, const struct report_technique *technique) {
  cJSON *item = cJSON_CreateObject();
  if (!item || !cJSON_AddItemToArray(results, item)) {
    cJSON_Delete(item);
    return 0;
  }
  return add_text(item, "technique", technique->name) && add_text(item, "label", technique->label) &&
         add_text(item, "file", technique->file) && add_copy(item, "parameters", technique->parameters) &&
         add_error(item, &technique->error) && add_times(item, technique) && add_search(item, technique) &&
         add_bound(item, &technique->bound) && add_scatter(item, technique);
}

static int fill(cJSON *json, const struct report *report) {
  if (!add_text(json, "penumbra", report->version) || !add_number(json, "schema", 1)) return 0;
  cJSON *device = cJSON_AddObjectToObject(json, "device");
  if (!device || !add_text(device, "renderer", report->renderer) || !add_text(device, "version", report->gl_version) ||
      !add_copy(json, "scene", report->scene))
    return 0;
  cJSON *reference = cJSON_AddObjectToObject(json, "reference");
  if (!reference || !add_text(reference, "method", "embree") || !add_number(reference, "samples", report->samples) ||
      !add_number(reference, "time_ms", report->reference_ms))
    return 0;
  cJSON *results = cJSON_AddArrayToObject(json, "results");
  for (int i = 0; results && i < report->technique_count; i++)
    if (!add_result(results, &report->techniques[i])) return 0;
  return results != NULL;
}

cJSON *report_json(const struct report *report) {
  cJSON *json = cJSON_CreateObject();
  if (json && fill(json, report)) return json;
  cJSON_Delete(json);
  return NULL;
}
