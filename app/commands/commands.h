/* commands.h: one function a command; each answers with the exit status. */
#ifndef PENUMBRA_APP_COMMANDS_COMMANDS_H
#define PENUMBRA_APP_COMMANDS_COMMANDS_H

#include "cli/command.h"
#include "cli/options.h"

int command_render(const struct options *options);
int command_compare(const struct options *options);
int command_bench(const struct options *options);
int command_motion(const struct options *options);
int command_list(const struct options *options);
int command_info(const struct options *options);
int command_help(const struct options *options);

/* What `penumbra help COMMAND` prints; NULL: the overview. */
void print_help(FILE *file, const struct command_row *command);

/* A technique's table, as `help TECHNIQUE` and `list --verbose` show it. */
void print_technique(FILE *file, const pn_technique *technique);

#endif
