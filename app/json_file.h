/* json_file.h: results as JSON. */
#ifndef PENUMBRA_APP_JSON_FILE_H
#define PENUMBRA_APP_JSON_FILE_H

#include <cjson/cJSON.h>

#include "host/host.h"

/* The members every result begins with: penumbra, schema, device, scene. NULL: out of memory. */
cJSON *result_begin(const struct host *host);

/* Writes and deletes the object; path "-" is standard output. Exit status. */
int json_write(const char *path, cJSON *object);

/* Adds technique, label and parameters (with the values that spec gives them) of one result. */
void add_technique(cJSON *result, const char *spec);

#endif
