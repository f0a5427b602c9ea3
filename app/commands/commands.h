/* commands.h: one function a command; each answers with the exit status. */
#ifndef PENUMBRA_APP_COMMANDS_H
#define PENUMBRA_APP_COMMANDS_H

#include "options.h"

struct command_row {
  const char *name;
  enum command bit;
  int (*run)(const struct options *options);
  int positionals_least, positionals_most;
  const char *arguments, *summary;
};

extern const struct command_row commands[];
extern const int command_count;

int command_render(const struct options *options);
int command_compare(const struct options *options);
int command_bench(const struct options *options);
int command_list(const struct options *options);
int command_info(const struct options *options);
int command_help(const struct options *options);
int command_missing(const struct options *options); /* not available in this version */

const struct command_row *command_find(const char *name); /* NULL: none */

/* What `penumbra help COMMAND` prints; NULL: the overview. */
void print_help(FILE *file, const struct command_row *command);

/* A technique's table, as `help TECHNIQUE` and `list --verbose` show it. */
void print_technique(FILE *file, const pn_technique *technique);

#endif
