/* json.h: JSON files. */
#ifndef PENUMBRA_APP_FILES_JSON_H
#define PENUMBRA_APP_FILES_JSON_H

#include <cjson/cJSON.h>

/* Writes the object and deletes it, in any case; path "-" is standard output. NULL: memory ran out while it was made.
 * Exit status. */
int json_write(const char *path, cJSON *object);

#endif
