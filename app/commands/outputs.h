/* outputs.h: what commands share about the files that options ask for. */
#ifndef PENUMBRA_APP_COMMANDS_OUTPUTS_H
#define PENUMBRA_APP_COMMANDS_OUTPUTS_H

#include <cjson/cJSON.h>

#include "cli/claims.h"
#include "experiment/buffers.h"

/* Claims the buffers that --save-dir may hold of the technique with this index: its visibility, and of its insides
 * those whose bit (1 << enum inside) is set. Exit status. */
int claim_technique(struct claims *claims, const char *folder, int index, const char *spec, unsigned insides);

/* Writes --json, deletes the object, and tells people the path. NULL: memory ran out while it was made. Exit status. */
int write_result(const struct options *options, cJSON *json);

#endif
