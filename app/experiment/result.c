#include "experiment/result.h"

#include "scene/scene_json.h"

cJSON *result_begin(const struct host *host) {
  cJSON *scene = scene_to_json(host->scene);
  cJSON *head =
      scene ? report_head(pn_version(), device_renderer(host->device), device_version(host->device), scene) : NULL;
  cJSON_Delete(scene);
  return head;
}

static void add_parameters(cJSON *object, const pn_technique *technique, const double *values) {
  for (int i = 0; i < technique->parameter_count; i++) {
    const pn_parameter *p = &technique->parameters[i];
    if (p->type == PN_CHOICE) cJSON_AddStringToObject(object, p->name, p->choices[(int)values[i]]);
    else if (p->type == PN_BOOL) cJSON_AddBoolToObject(object, p->name, values[i] != 0);
    else if (p->choices && values[i] == p->least) cJSON_AddStringToObject(object, p->name, p->choices[0]);
    else cJSON_AddNumberToObject(object, p->name, values[i]);
  }
}

cJSON *result_technique(const char *spec) {
  enum { PARAMETERS_MAX = 64 };
  const pn_technique *technique = NULL;
  double values[PARAMETERS_MAX];
  cJSON *object = cJSON_CreateObject();
  if (pn_technique_parse(spec, &technique, NULL, NULL, 0) != PN_OK || technique->parameter_count > PARAMETERS_MAX)
    return object;
  pn_technique_parse(spec, NULL, values, NULL, 0);
  cJSON_AddStringToObject(object, "technique", technique->name);
  cJSON_AddStringToObject(object, "label", spec);
  add_parameters(cJSON_AddObjectToObject(object, "parameters"), technique, values);
  return object;
}

cJSON *result_times(const struct timing *t) {
  cJSON *times = report_times(t->median, t->min, t->max, t->stages, t->stage_count);
  cJSON_AddNumberToObject(times, "frames", t->frames);
  return times;
}
