#include "json_file.h"

#include <stdlib.h>
#include <string.h>

#include "message.h"
#include "output.h"
#include "scene/scene_json.h"

cJSON *result_begin(const struct host *host) {
  cJSON *object = cJSON_CreateObject();
  if (!object) return NULL;
  cJSON_AddStringToObject(object, "penumbra", pn_version());
  cJSON_AddNumberToObject(object, "schema", 1);
  cJSON *device = cJSON_AddObjectToObject(object, "device");
  cJSON_AddStringToObject(device, "renderer", device_renderer(host->device));
  cJSON_AddStringToObject(device, "version", device_version(host->device));
  cJSON_AddItemToObject(object, "scene", scene_to_json(host->scene));
  return object;
}

int json_write(const char *path, cJSON *object) {
  char *text = object ? cJSON_Print(object) : NULL;
  cJSON_Delete(object);
  if (!text) return memory_error();
  size_t length = strlen(text);
  text[length] = '\n'; /* in the terminator's place: the size says where the file ends */
  int status = output_write_file(path, text, length + 1);
  free(text);
  return status;
}

void add_technique(cJSON *result, const char *spec) {
  enum { PARAMETERS_MAX = 64 };
  const pn_technique *technique = NULL;
  double values[PARAMETERS_MAX];
  if (pn_technique_parse(spec, &technique, NULL, NULL, 0) != PN_OK || technique->parameter_count > PARAMETERS_MAX)
    return;
  pn_technique_parse(spec, NULL, values, NULL, 0);
  cJSON_AddStringToObject(result, "technique", technique->name);
  cJSON_AddStringToObject(result, "label", spec);
  cJSON *object = cJSON_AddObjectToObject(result, "parameters");
  for (int i = 0; i < technique->parameter_count; i++) {
    const pn_parameter *p = &technique->parameters[i];
    if (p->type == PN_CHOICE) cJSON_AddStringToObject(object, p->name, p->choices[(int)values[i]]);
    else if (p->type == PN_BOOL) cJSON_AddBoolToObject(object, p->name, values[i] != 0);
    else if (p->choices && values[i] == p->least) cJSON_AddStringToObject(object, p->name, p->choices[0]);
    else cJSON_AddNumberToObject(object, p->name, values[i]);
  }
}
