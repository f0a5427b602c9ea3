/* scene_json.h: the "scene" object of the contract, written and read again. */
#ifndef PENUMBRA_APP_SCENE_SCENE_JSON_H
#define PENUMBRA_APP_SCENE_SCENE_JSON_H

#include <cjson/cJSON.h>

#include "scene/load.h"

/* NULL: out of memory. The caller adds it to its own object or deletes it. */
cJSON *scene_to_json(const struct scene *scene);

/* Reads FILE of --setup: its "scene" object, or the whole of it. The caller deletes *out. Exit status. */
int setup_read(const char *path, cJSON **out);

/* What scene_load must know before the scene exists. */
int setup_request(const char *path, const cJSON *json, struct scene_request *request);

/* Lays what the object holds over the set-up; members that are missing stay as they are. path is for messages. Exit
 * status. */
int setup_apply_json(const char *path, const cJSON *json, struct setup *setup);

#endif
