/* command.h: the commands by one table: what they are called, what they take, what help says of them. */
#ifndef PENUMBRA_APP_CLI_COMMAND_H
#define PENUMBRA_APP_CLI_COMMAND_H

/* Bits, so that an option can say which commands take it. */
enum command {
  COMMAND_RENDER = 1,
  COMMAND_COMPARE = 2,
  COMMAND_STUDY = 4,
  COMMAND_BENCH = 8,
  COMMAND_VIEW = 16,
  COMMAND_LIST = 32,
  COMMAND_INFO = 64,
  COMMAND_HELP = 128,
  COMMAND_MOTION = 256
};

struct command_row {
  const char *name;
  enum command bit;
  int positionals_least, positionals_most;
  const char *arguments, *summary;
};

enum { COMMAND_COUNT = 9 };
extern const struct command_row commands[COMMAND_COUNT];

const struct command_row *command_find(const char *name); /* NULL: none */
const char *command_name(enum command command);

#endif
