/* result.h: results as JSON. Everything is the caller's, who adds it to an object of his own or deletes it. */
#ifndef PENUMBRA_APP_EXPERIMENT_RESULT_H
#define PENUMBRA_APP_EXPERIMENT_RESULT_H

#include <cjson/cJSON.h>

#include "experiment/measure.h"
#include "host/host.h"

/* The members every result begins with: penumbra, schema, device, scene. NULL: out of memory. */
cJSON *result_begin(const struct host *host);

/* One technique's object: technique, label and parameters (with the values that spec gives them). NULL: out of
 * memory. */
cJSON *result_technique(const char *spec);

/* {"total": {"median", "min", "max"}, "stages": {...}, "frames"}; NULL: out of memory. */
cJSON *result_times(const struct timing *timing);

#endif
