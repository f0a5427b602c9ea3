/* penumbra list: what there is to choose from, one a line, the name first. */
#include <string.h>

#include "base/message.h"
#include "base/names.h"
#include "commands/commands.h"
#include "scene/builtin.h"

static void list_techniques(int verbose) {
  for (int i = 0; i < pn_technique_count(); i++) {
    const pn_technique *technique = pn_technique_at(i);
    if (verbose) {
      if (i) puts("");
      print_technique(stdout, technique);
    } else {
      printf("%-16s %s\n", technique->name, technique->help);
    }
  }
}

static void list_scenes(int verbose) {
  (void)verbose;
  for (int i = 0; i < builtin_count; i++) printf("%-20s %s\n", builtins[i].name, builtins[i].summary);
}

static void list_studies(int verbose) {
  (void)verbose;
  note("there are no studies in this version");
}

static const struct {
  const char *name;
  void (*print)(int verbose);
} topics[] = {{"techniques", list_techniques}, {"scenes", list_scenes}, {"studies", list_studies}};
enum { TOPIC_COUNT = sizeof topics / sizeof *topics };

static int unknown_topic(const char *typed) {
  const char *names[TOPIC_COUNT];
  for (int i = 0; i < TOPIC_COUNT; i++) names[i] = topics[i].name;
  char hint[80];
  if (nearest_name(typed, names, TOPIC_COUNT, hint, sizeof hint))
    return input_error("list: unknown '%s'; %s", typed, hint);
  return input_error("list: '%s' is not techniques, scenes or studies", typed);
}

int command_list(const struct options *o) {
  int verbose = o->given[OPTION_VERBOSE];
  if (o->positional_count == 0) {
    for (int i = 0; i < TOPIC_COUNT; i++) {
      printf("%s%s:\n", i ? "\n" : "", topics[i].name);
      topics[i].print(verbose);
    }
    return STATUS_OK;
  }
  for (int i = 0; i < TOPIC_COUNT; i++)
    if (strcmp(o->positionals[0], topics[i].name) == 0) {
      topics[i].print(verbose);
      return STATUS_OK;
    }
  return unknown_topic(o->positionals[0]);
}
