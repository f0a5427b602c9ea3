#include "commands/outputs.h"

#include <stdlib.h>

#include "base/message.h"
#include "files/json.h"
#include "files/output.h"

int claim_technique(struct claims *claims, const char *folder, int index, const char *spec, unsigned insides) {
  char *file = save_name(index, spec);
  int status = file ? claim_saved(claims, folder, file) : memory_error();
  for (int i = 0; i < INSIDE_COUNT && !status; i++) {
    if (!(insides >> i & 1)) continue;
    char *name = save_name_inside(file, inside_kinds[i]);
    status = name ? claim_saved(claims, folder, name) : memory_error();
    free(name);
  }
  free(file);
  return status;
}

int write_result(const struct options *o, cJSON *json) {
  int status = json_write(o->json, json);
  if (!status && !output_is_standard(o->json)) fprintf(options_people(o), "%s\n", o->json);
  return status;
}
