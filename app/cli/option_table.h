/* option_table.h: every option's name, argument, help, the commands that take it, and how its value is read. */
#ifndef PENUMBRA_APP_CLI_OPTION_TABLE_H
#define PENUMBRA_APP_CLI_OPTION_TABLE_H

#include "scene/scene.h"

enum option {
  OPTION_TECHNIQUE,
  OPTION_OUTPUT,
  OPTION_SIZE,
  OPTION_MAP,
  OPTION_LIGHT,
  OPTION_LIGHT_CENTER,
  OPTION_LIGHT_TARGET,
  OPTION_LIGHT_UP,
  OPTION_LIGHT_SIZE,
  OPTION_LIGHT_TEXTURE,
  OPTION_CAMERA_POSITION,
  OPTION_CAMERA_TARGET,
  OPTION_CAMERA_UP,
  OPTION_FOV,
  OPTION_GROUND,
  OPTION_UP,
  OPTION_FIT,
  OPTION_VISIBILITY_SCALE,
  OPTION_NORMALS,
  OPTION_SPLIT,
  OPTION_DEVICE,
  OPTION_SETUP,
  OPTION_REFERENCE_SAMPLES,
  OPTION_JSON,
  OPTION_SAVE_DIR,
  OPTION_HTML,
  OPTION_NO_CACHE,
  OPTION_FRAMES,
  OPTION_LIGHTS,
  OPTION_HIERARCHIES,
  OPTION_QUIET,
  OPTION_VERBOSE,
  OPTION_HELP,
  OPTION_COUNT
};

enum { LIGHT_COUNTS_MAX = 8, LIGHTS_MAX = 64 };

/* What was asked for. Strings point into argv. Values of options that were not given hold the contract's defaults,
 * those of the set-up excepted: they come from the scene, and options_scene lays the given ones over it. */
struct options {
  unsigned char given[OPTION_COUNT];
  const char **techniques; /* specs, already checked with pn_technique_parse */
  int technique_count;
  const char **positionals; /* SCENE, a topic, names of studies */
  int positional_count;
  struct setup setup; /* values of the given set-up options only */
  const char *output, *light_texture, *device, *setup_file, *json, *save_dir, *html;
  enum ground ground;
  int up_is_z;
  int reference_samples, frames;
  int light_counts[LIGHT_COUNTS_MAX], light_count_count; /* bench --lights */
};

typedef int (*option_reader)(struct options *options, const char *name, const char *value);

struct option_row {
  const char *name;
  char letter;
  const char *argument; /* NULL: takes none */
  int commands;         /* bits of enum command */
  option_reader read;
  const char *help;
};

extern const struct option_row option_table[OPTION_COUNT];

#endif
