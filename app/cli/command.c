#include "cli/command.h"

#include <stddef.h>
#include <string.h>

const struct command_row commands[COMMAND_COUNT] = {
    {"render", COMMAND_RENDER, 1, 1, "SCENE [options]", "one picture of SCENE under one technique"},
    {"compare", COMMAND_COMPARE, 1, 1, "SCENE [options]", "several techniques against the reference"},
    {"study", COMMAND_STUDY, 0, 1000, "NAME... | all",
     "the papers' experiments, as CSV, plots and a report (not in this version)"},
    {"bench", COMMAND_BENCH, 0, 1, "[SCENE] [options]", "stage times"},
    {"motion", COMMAND_MOTION, 2, 1000, "SCENE SCENE... [options]",
     "what shadows do from frame to frame, beside the reference"},
    {"view", COMMAND_VIEW, 0, 1, "[SCENE] [options]", "interactive window (not in this version)"},
    {"list", COMMAND_LIST, 0, 1, "[techniques|scenes|studies]",
     "what there is to choose from; --verbose: with parameters"},
    {"info", COMMAND_INFO, 0, 0, "", "GL devices, limits, which accelerations are in use"},
    {"help", COMMAND_HELP, 0, 1, "[COMMAND|TECHNIQUE]", "this, a command's options, a technique's parameters"},
};

const struct command_row *command_find(const char *name) {
  for (int i = 0; i < COMMAND_COUNT; i++)
    if (strcmp(commands[i].name, name) == 0) return &commands[i];
  return NULL;
}

const char *command_name(enum command command) {
  int i = 0;
  while (commands[i].bit != command) i++;
  return commands[i].name;
}
