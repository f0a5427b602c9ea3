/* main.c: which command. */
#include <stdio.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/message.h"
#include "base/names.h"
#include "base/streams.h"
#include "commands/commands.h"
#include "scene/import_process.h"

static int unknown_command(const char *typed) {
  const char *names[COMMAND_COUNT];
  char hint[80];
  for (int i = 0; i < COMMAND_COUNT; i++) names[i] = commands[i].name;
  return input_error("unknown command '%s'; %s", typed,
                     nearest_name(typed, names, COMMAND_COUNT, hint, sizeof hint) ? hint : "penumbra help lists them");
}

static int run_command(const struct command_row *command, const struct options *o) {
  switch (command->bit) {
  case COMMAND_RENDER: return command_render(o);
  case COMMAND_COMPARE: return command_compare(o);
  case COMMAND_BENCH: return command_bench(o);
  case COMMAND_MOTION: return command_motion(o);
  case COMMAND_LIST: return command_list(o);
  case COMMAND_INFO: return command_info(o);
  case COMMAND_HELP: return command_help(o);
  case COMMAND_STUDY:
  case COMMAND_VIEW: break;
  }
  return input_error("this command is not available in this version");
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
  return run_command(command, o);
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
  import_serve(argc, argv);
  streams_hold();
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
