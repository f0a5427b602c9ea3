/* options.h: the command line, read by the table of options. */
#ifndef PENUMBRA_APP_CLI_OPTIONS_H
#define PENUMBRA_APP_CLI_OPTIONS_H

#include <stdio.h>

#include "cli/command.h"
#include "cli/option_table.h"

/* Reads the arguments that follow the command's name. On failure one line was printed and the exit status is
 * returned. Free the options in any case. */
int options_parse(struct options *options, enum command command, int argc, char **argv);
void options_free(struct options *options);

/* Where people read what a command did: with the JSON on standard output, their lines make room for it. */
FILE *options_people(const struct options *options);

/* The options a command takes, one or more lines each. */
void options_print(FILE *file, enum command command);

/* The scene that the options describe, with --setup's scene block and all options applied and checked: scene_load,
 * setup_apply_json, the options, setup_finish. name NULL: options->positionals[0]. Exit status. */
int options_scene(const struct options *options, const char *name, struct scene **out);

#endif
