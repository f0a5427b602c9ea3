#include "experiment/choice.h"

#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "penumbra/penumbra.h"

/* `average` is a second truth rather than a technique for every day, and takes seconds a frame: who wants it names
 * it. */
static int is_default(const pn_technique *technique) { return strcmp(technique->name, "average") != 0; }

const char **technique_choice(const char *const *given, int given_count, int *count) {
  int all = pn_technique_count();
  const char **specs = calloc((size_t)given_count + (size_t)all + 1, sizeof *specs);
  *count = 0;
  if (!specs) {
    memory_error();
    return NULL;
  }
  for (int i = 0; i < given_count; i++) specs[(*count)++] = given[i];
  for (int i = 0; i < all && !given_count; i++)
    if (is_default(pn_technique_at(i))) specs[(*count)++] = pn_technique_at(i)->name;
  return specs;
}
