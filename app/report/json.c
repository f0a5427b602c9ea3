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

static int add_item(cJSON *object, const char *name, cJSON *item) {
  if (item && cJSON_AddItemToObject(object, name, item)) return 1;
  cJSON_Delete(item);
  return 0;
}

static int add_copy(cJSON *object, const char *name, const cJSON *value) {
  return add_item(object, name, value ? cJSON_Duplicate(value, 1) : cJSON_CreateObject());
}

static int add_error(cJSON *object, const char *name, const struct error_statistics *error) {
  cJSON *item = cJSON_AddObjectToObject(object, name);
  return item && add_number(item, "mae", error->mae) && add_number(item, "rmse", error->rmse) &&
         add_number(item, "p95", error->p95) && add_number(item, "max", error->max) &&
         add_number(item, "bias", error->bias) && add_number(item, "pixels", (double)error->pixels);
}

cJSON *report_times(double median, double least, double most, const struct report_stage *stages, int stage_count) {
  cJSON *times = cJSON_CreateObject(), *total = times ? cJSON_AddObjectToObject(times, "total") : NULL,
        *parts = times ? cJSON_AddObjectToObject(times, "stages") : NULL;
  int added = total && parts && add_number(total, "median", median) && add_number(total, "min", least) &&
              add_number(total, "max", most);
  for (int i = 0; i < stage_count && added; i++) added = add_number(parts, stages[i].name, stages[i].milliseconds);
  if (added) return times;
  cJSON_Delete(times);
  return NULL;
}

static int add_times(cJSON *object, const struct report_technique *t) {
  cJSON *times = report_times(t->time_median, t->time_least, t->time_most, t->stages, t->stage_count);
  return add_item(object, "time_ms", times);
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
         add_error(item, "error", &technique->error) && add_error(item, "all", &technique->all) &&
         add_number(item, "picture", technique->picture_error) && add_times(item, technique) &&
         add_search(item, technique) && add_bound(item, &technique->bound) && add_scatter(item, technique);
}

cJSON *report_head(const char *version, const char *renderer, const char *gl_version, const cJSON *scene) {
  cJSON *head = cJSON_CreateObject();
  cJSON *device = head && add_text(head, "penumbra", version) && add_number(head, "schema", 1)
                      ? cJSON_AddObjectToObject(head, "device")
                      : NULL;
  if (device && add_text(device, "renderer", renderer) && add_text(device, "version", gl_version) &&
      add_copy(head, "scene", scene))
    return head;
  cJSON_Delete(head);
  return NULL;
}

static int fill(cJSON *json, const struct report *report) {
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
  cJSON *json = report_head(report->version, report->renderer, report->gl_version, report->scene);
  if (json && fill(json, report)) return json;
  cJSON_Delete(json);
  return NULL;
}
