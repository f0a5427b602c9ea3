/* main.c: which command. */
#include <stdio.h>
#include <string.h>

#include "commands/commands.h"
#include "interrupt.h"
#include "message.h"
#include "names.h"

const struct command_row commands[] = {
    {"render", COMMAND_RENDER, command_render, 1, 1, "SCENE [options]", "one picture of SCENE under one technique"},
    {"compare", COMMAND_COMPARE, command_compare, 1, 1, "SCENE [options]", "several techniques against the reference"},
    {"study", COMMAND_STUDY, command_missing, 0, 1000, "NAME... | all",
     "the papers' experiments, as CSV, plots and a report (not in this version)"},
    {"bench", COMMAND_BENCH, command_bench, 0, 1, "[SCENE] [options]", "stage times"},
    {"view", COMMAND_VIEW, command_missing, 0, 1, "[SCENE] [options]", "interactive window (not in this version)"},
    {"list", COMMAND_LIST, command_list, 0, 1, "[techniques|scenes|studies]",
     "what there is to choose from; --verbose: with parameters"},
    {"info", COMMAND_INFO, command_info, 0, 0, "", "GL devices, limits, which accelerations are in use"},
    {"help", COMMAND_HELP, command_help, 0, 1, "[COMMAND|TECHNIQUE]",
     "this, a command's options, a technique's parameters"},
};
const int command_count = sizeof commands / sizeof *commands;

const struct command_row *command_find(const char *name) {
  for (int i = 0; i < command_count; i++)
    if (strcmp(commands[i].name, name) == 0) return &commands[i];
  return NULL;
}

int command_missing(const struct options *o) {
  (void)o;
  return input_error("this command is not available in this version");
}

static int unknown_command(const char *typed) {
  const char *names[sizeof commands / sizeof *commands];
  char hint[80];
  for (int i = 0; i < command_count; i++) names[i] = commands[i].name;
  return input_error("unknown command '%s'; %s", typed,
                     nearest_name(typed, names, command_count, hint, sizeof hint) ? hint : "penumbra help lists them");
}

static int run_options(const struct command_row *command, const struct options *o) {
  if (o->given[OPTION_HELP]) {
    print_help(stdout, command);
    return STATUS_OK;
  }
  if (o->positional_count < command->positionals_least)
    return input_error("%s needs %s; penumbra help %s says more", command->name, command->arguments, command->name);
  if (o->positional_count > command->positionals_most)
    return input_error("%s: '%s' is one argument too many", command->name, o->positionals[command->positionals_most]);
  return command->run(o);
}

static int run(const struct command_row *command, int argc, char **argv) {
  struct options options;
  int status = options_parse(&options, command->bit, argc, argv);
  if (!status) status = run_options(command, &options);
  options_free(&options);
  return status;
}

/* Standard output is an output too: a full disk behind it is an error. */
static int finish(int status) {
  if ((fflush(stdout) != 0 || ferror(stdout)) && !status) return work_error("standard output cannot be written");
  return status;
}

int main(int argc, char **argv) {
  interrupt_install();
  if (argc < 2) {
    print_help(stderr, NULL);
    return STATUS_INPUT;
  }
  if (strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "--help") == 0) {
    print_help(stdout, NULL);
    return finish(STATUS_OK);
  }
  if (strcmp(argv[1], "--version") == 0) {
    printf("penumbra %s\n", pn_version());
    return finish(STATUS_OK);
  }
  const struct command_row *command = command_find(argv[1]);
  return finish(command ? run(command, argc - 2, argv + 2) : unknown_command(argv[1]));
}
