#include "cli/options.h"

#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "base/names.h"
#include "base/progress.h"
#include "files/output.h"

/* The option in the table, or an error that names the nearest. */
static int find_long(enum command command, const char *name, size_t length, enum option *out) {
  const char *names[OPTION_COUNT];
  char typed[64], hint[100];
  int count = 0;
  for (int i = 0; i < OPTION_COUNT; i++) {
    if (option_table[i].commands & command) names[count++] = option_table[i].name;
    if (strlen(option_table[i].name) != length || strncmp(option_table[i].name, name, length) != 0) continue;
    *out = (enum option)i;
    if (option_table[i].commands & command) return STATUS_OK;
    return input_error("--%s is not an option of penumbra %s", option_table[i].name, command_name(command));
  }
  snprintf(typed, sizeof typed, "%.*s", (int)length, name);
  if (!nearest_name(typed, names, count, hint, sizeof hint))
    return input_error("unknown option --%s; penumbra %s --help lists them", typed, command_name(command));
  char *mark = strstr(hint, "you mean ");
  return input_error("unknown option --%s; did you mean --%s", typed, mark + strlen("you mean "));
}

static int find_short(enum command command, char letter, enum option *out) {
  for (int i = 0; i < OPTION_COUNT; i++)
    if (option_table[i].letter == letter && option_table[i].commands & command) {
      *out = (enum option)i;
      return STATUS_OK;
    }
  return input_error("unknown option -%c; penumbra %s --help lists them", letter, command_name(command));
}

/* argv[*at] is an option; takes its value, moving *at on where that is the next argument. */
static int parse_option(struct options *o, enum command command, int argc, char **argv, int *at) {
  const char *argument = argv[*at], *value = NULL;
  enum option option = OPTION_HELP;
  int status;
  if (argument[1] == '-') {
    size_t length = strcspn(argument + 2, "=");
    status = find_long(command, argument + 2, length, &option);
    if (argument[2 + length]) value = argument + 2 + length + 1;
  } else {
    status = find_short(command, argument[1], &option);
    if (argument[2]) value = argument + 2 + (argument[2] == '=');
  }
  if (status) return status;
  const struct option_row *row = &option_table[option];
  char name[40];
  snprintf(name, sizeof name, "--%s", row->name);
  if (!row->argument && value) return input_error("%s takes no value", name);
  if (row->argument && !value) {
    if (*at + 1 >= argc) return input_error("%s needs a value: %s", name, row->argument);
    value = argv[++*at];
  }
  o->given[option] = 1;
  return row->read(o, name, value);
}

int options_parse(struct options *o, enum command command, int argc, char **argv) {
  memset(o, 0, sizeof *o);
  o->reference_samples = 1024;
  o->frames = 20;
  o->light_counts[0] = 1;
  o->light_count_count = 1;
  o->techniques = calloc((size_t)argc + 1, sizeof *o->techniques);
  o->positionals = calloc((size_t)argc + 1, sizeof *o->positionals);
  if (!o->techniques || !o->positionals) return memory_error();
  /* Help wins over whatever else is wrong with the line. */
  for (int i = 0; i < argc && strcmp(argv[i], "--") != 0; i++)
    if (strcmp(argv[i], "-h") == 0 || strcmp(argv[i], "--help") == 0) {
      o->given[OPTION_HELP] = 1;
      return STATUS_OK;
    }
  int only_positionals = 0;
  for (int i = 0; i < argc; i++) {
    if (!only_positionals && strcmp(argv[i], "--") == 0) {
      only_positionals = 1;
      continue;
    }
    if (only_positionals || argv[i][0] != '-' || !argv[i][1]) {
      o->positionals[o->positional_count++] = argv[i];
      continue;
    }
    int status = parse_option(o, command, argc, argv, &i);
    if (status) return status;
  }
  message_set_verbose(o->given[OPTION_VERBOSE]);
  progress_set_quiet(o->given[OPTION_QUIET]);
  return STATUS_OK;
}

void options_free(struct options *o) {
  free(o->techniques);
  free(o->positionals);
  o->techniques = o->positionals = NULL;
}

FILE *options_people(const struct options *o) {
  return output_is_standard(o->json) || output_is_standard(o->html) ? stderr : stdout;
}

void options_print(FILE *file, enum command command) {
  for (int i = 0; i < OPTION_COUNT; i++) {
    const struct option_row *row = &option_table[i];
    if (!(row->commands & command)) continue;
    char left[80];
    int n = row->letter ? snprintf(left, sizeof left, "-%c, ", row->letter) : snprintf(left, sizeof left, "    ");
    snprintf(left + n, sizeof left - (size_t)n, "--%s%s%s", row->name, row->argument ? " " : "",
             row->argument ? row->argument : "");
    if (strlen(left) > 36) fprintf(file, "  %s\n  %-36s  %s\n", left, "", row->help);
    else fprintf(file, "  %-36s  %s\n", left, row->help);
  }
}
