#include "cli/option_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/message.h"
#include "base/names.h"
#include "cli/command.h"
#include "cli/option_values.h"
#include "files/image.h"

enum {
  DRAWING = COMMAND_RENDER | COMMAND_COMPARE | COMMAND_STUDY | COMMAND_BENCH | COMMAND_VIEW | COMMAND_MOTION,
  EVERY = DRAWING | COMMAND_LIST | COMMAND_INFO | COMMAND_HELP,
  FILES = COMMAND_RENDER | COMMAND_COMPARE | COMMAND_STUDY | COMMAND_BENCH,
  TRACING = COMMAND_COMPARE | COMMAND_STUDY | COMMAND_MOTION
};

/* The nearest technique, or the nearest parameter of a technique, to what a spec names wrongly; "" where nothing is
 * near. */
static void suggest(const char *spec, char *hint, size_t hint_size) {
  enum { NAMES_MAX = 128 };
  const char *names[NAMES_MAX], *at = spec + strcspn(spec, ":");
  char typed[64];
  int count = 0;
  snprintf(typed, sizeof typed, "%.*s", (int)(at - spec), spec);
  const pn_technique *technique = pn_technique_find(typed);
  if (!technique) {
    for (int i = 0; i < pn_technique_count() && i < NAMES_MAX; i++) names[count++] = pn_technique_at(i)->name;
    if (nearest_name(typed, names, count, hint, hint_size)) return;
  }
  for (int i = 0; technique && i < technique->parameter_count && i < NAMES_MAX; i++)
    names[count++] = technique->parameters[i].name;
  for (const char *key = at; technique && *key; key += strcspn(key, ",")) {
    key++;
    snprintf(typed, sizeof typed, "%.*s", (int)strcspn(key, "=,"), key);
    int known = 0;
    for (int i = 0; i < count; i++) known |= strcmp(typed, names[i]) == 0;
    if (!known && nearest_name(typed, names, count, hint, hint_size)) return;
  }
  *hint = 0;
}

static int read_technique(struct options *o, const char *name, const char *value) {
  char why[400] = "", hint[100];
  if (pn_technique_parse(value, NULL, NULL, why, sizeof why) != PN_OK) {
    suggest(value, hint, sizeof hint);
    return input_error("%s %s: %s%s%s", name, value, *why ? why : "not a technique", *hint ? "; " : "", hint);
  }
  o->techniques[o->technique_count++] = value;
  return STATUS_OK;
}

static int read_output(struct options *o, const char *name, const char *value) {
  if (image_kind_of(value) == IMAGE_UNKNOWN) return input_error("%s: '%s' must end in .png or .exr", name, value);
  o->output = value;
  return STATUS_OK;
}

static int read_picture_size(struct options *o, const char *name, const char *value) {
  return read_size(name, value, 1, IMAGE_SIZE_MAX, 0, o->setup.size);
}

static int read_map(struct options *o, const char *name, const char *value) {
  return read_size(name, value, 1, PN_MAP_SIZE_MAX, 1, o->setup.map);
}

static int read_light(struct options *o, const char *name, const char *value) {
  static const char *const shapes[] = {"rectangle", "sun", NULL};
  int shape = 0, status = read_choice(name, value, shapes, &shape);
  o->setup.light.shape = shape ? PN_LIGHT_SUN : PN_LIGHT_RECTANGLE;
  return status;
}

#define POINT_READER(function, field) \
  static int function(struct options *o, const char *name, const char *value) { \
    return read_numbers(name, value, 3, "X,Y,Z", o->setup.field); \
  }
POINT_READER(read_light_center, light.center)
POINT_READER(read_light_target, light.target)
POINT_READER(read_light_up, light.up)
POINT_READER(read_camera_position, camera.position)
POINT_READER(read_camera_target, camera.target)
POINT_READER(read_camera_up, camera.up)

static int read_light_size(struct options *o, const char *name, const char *value) {
  double *size = o->setup.light.size;
  int two = strchr(value, ',') != NULL;
  int status = read_numbers(name, value, 1 + two, two ? "W,H" : "W", size);
  if (!two) size[1] = size[0];
  if (!status && (size[0] <= 0 || size[1] <= 0)) return input_error("%s: '%s' must be greater than 0", name, value);
  return status;
}

static int read_light_texture(struct options *o, const char *name, const char *value) {
  o->light_texture = value;
  return input_error("%s: textured lights are not available in this version", name);
}

static int read_fov(struct options *o, const char *name, const char *value) {
  int status = read_numbers(name, value, 1, "an angle", &o->setup.camera.fov);
  if (!status && !(o->setup.camera.fov >= 0.01 && o->setup.camera.fov <= 170))
    return input_error("%s: '%s' is out of range: 0.01 to 170 degrees", name, value);
  return status;
}

static int read_ground(struct options *o, const char *name, const char *value) {
  static const char *const words[] = {"on", "off", NULL};
  int off = 0, status = read_choice(name, value, words, &off);
  o->ground = off ? GROUND_OFF : GROUND_ON;
  return status;
}

static int read_up(struct options *o, const char *name, const char *value) {
  static const char *const words[] = {"y", "z", NULL};
  return read_choice(name, value, words, &o->up_is_z);
}

static int read_fit(struct options *o, const char *name, const char *value) {
  if (strcmp(value, "visible") == 0) o->setup.fit = PN_FIT_VISIBLE;
  else if (strcmp(value, "casters") == 0) o->setup.fit = PN_FIT_CASTERS;
  else {
    double *b = o->setup.fit_bounds;
    o->setup.fit = PN_FIT_GIVEN;
    int status = read_numbers(name, value, 6, "visible, casters or X0,Y0,Z0,X1,Y1,Z1", b);
    if (!status && !(b[0] <= b[3] && b[1] <= b[4] && b[2] <= b[5]))
      return input_error("%s: '%s': X0,Y0,Z0 must not exceed X1,Y1,Z1", name, value);
    return status;
  }
  return STATUS_OK;
}

static int read_visibility_scale(struct options *o, const char *name, const char *value) {
  static const char *const words[] = {"1", "2", "4", NULL};
  int index = 0, status = read_choice(name, value, words, &index);
  o->setup.visibility_scale = 1 << index;
  return status;
}

static int read_normals(struct options *o, const char *name, const char *value) {
  static const char *const words[] = {"given", "depth", NULL};
  return read_choice(name, value, words, &o->setup.normals_from_depth);
}

static int read_device(struct options *o, const char *name, const char *value) {
  o->device = value;
  int number;
  if (strcmp(value, "auto") == 0 || strcmp(value, "software") == 0) return STATUS_OK;
  if (*value < '0' || *value > '9')
    return input_error("%s: '%s' is not auto, software or a number that penumbra info shows", name, value);
  return read_integer(name, value, 0, 255, &number);
}

static int read_reference_samples(struct options *o, const char *name, const char *value) {
  int status = read_integer(name, value, 1, 65536, &o->reference_samples);
  int root = (int)lround(sqrt(o->reference_samples));
  if (!status && root * root != o->reference_samples)
    return input_error("%s: '%s' is not a square number, such as 256 or 1024", name, value);
  return status;
}

static int read_frames(struct options *o, const char *name, const char *value) {
  return read_integer(name, value, 1, 100000, &o->frames);
}

static int read_lights(struct options *o, const char *name, const char *value) {
  char copy[64];
  if (snprintf(copy, sizeof copy, "%s", value) >= (int)sizeof copy)
    return input_error("%s: '%s' is too long", name, value);
  o->light_count_count = 0;
  char *rest = copy;
  for (char *comma; rest; rest = comma ? comma + 1 : NULL) {
    comma = strchr(rest, ',');
    if (comma) *comma = 0;
    if (o->light_count_count == LIGHT_COUNTS_MAX) return input_error("%s: at most %d numbers", name, LIGHT_COUNTS_MAX);
    int status = read_integer(name, rest, 1, LIGHTS_MAX, &o->light_counts[o->light_count_count++]);
    if (status) return status;
  }
  return STATUS_OK;
}

#define TEXT_READER(function, field) \
  static int function(struct options *o, const char *name, const char *value) { \
    if (!*value) return input_error("%s: needs a name", name); \
    o->field = value; \
    return STATUS_OK; \
  }
TEXT_READER(read_setup, setup_file)
TEXT_READER(read_json, json)
TEXT_READER(read_save_dir, save_dir)
TEXT_READER(read_html, html)

static int read_flag(struct options *o, const char *name, const char *value) {
  (void)o;
  (void)name;
  (void)value;
  return STATUS_OK;
}

const struct option_row option_table[OPTION_COUNT] = {
    [OPTION_TECHNIQUE] = {"technique", 't', "NAME[:key=value,...]", DRAWING, read_technique,
                          "technique and its parameters; repeatable"},
    [OPTION_OUTPUT] = {"output", 'o', "FILE", FILES & ~COMMAND_BENCH, read_output,
                       "picture to write; .png or .exr by its ending"},
    [OPTION_SIZE] = {"size", 0, "WxH", DRAWING, read_picture_size, "picture size in pixels, default 1024x768"},
    [OPTION_MAP] = {"map", 0, "N[xM]", DRAWING, read_map, "depth-map resolution, 1 to 8192, default 512"},
    [OPTION_LIGHT] = {"light", 0, "rectangle|sun", DRAWING, read_light,
                      "kind of light; a sun shines along centre to target"},
    [OPTION_LIGHT_CENTER] = {"light-center", 0, "X,Y,Z", DRAWING, read_light_center,
                             "default 3 H above the model's lowest point"},
    [OPTION_LIGHT_TARGET] = {"light-target", 0, "X,Y,Z", DRAWING, read_light_target, "default B, the model's foot"},
    [OPTION_LIGHT_UP] = {"light-up", 0, "X,Y,Z", DRAWING, read_light_up,
                         "which way the light's v axis leans, default 0,0,-1"},
    [OPTION_LIGHT_SIZE] = {"light-size", 0, "W[,H]", DRAWING, read_light_size,
                           "full widths in scene units; of a sun, full angles in degrees"},
    [OPTION_LIGHT_TEXTURE] = {"light-texture", 0, "FILE", DRAWING, read_light_texture,
                              "radiance over the light (not available in this version)"},
    [OPTION_CAMERA_POSITION] = {"camera-position", 0, "X,Y,Z", DRAWING, read_camera_position,
                                "default B + (0, 1.8 H, 2.6 H)"},
    [OPTION_CAMERA_TARGET] = {"camera-target", 0, "X,Y,Z", DRAWING, read_camera_target, "default B + (0, 0.38 H, 0)"},
    [OPTION_CAMERA_UP] = {"camera-up", 0, "X,Y,Z", DRAWING, read_camera_up, "default 0,1,0"},
    [OPTION_FOV] = {"fov", 0, "DEGREES", DRAWING, read_fov, "vertical field of view, default 48.5"},
    [OPTION_GROUND] = {"ground", 0, "on|off", DRAWING, read_ground,
                       "a plane below the model that only receives; default on for model files"},
    [OPTION_UP] = {"up", 0, "y|z", DRAWING, read_up, "which axis of the file is up, default y"},
    [OPTION_FIT] = {"fit", 0, "visible|casters|X0,Y0,Z0,X1,Y1,Z1", DRAWING, read_fit,
                    "what the depth map is fitted to, default visible"},
    [OPTION_VISIBILITY_SCALE] = {"visibility-scale", 0, "1|2|4", DRAWING, read_visibility_scale,
                                 "compute visibility at full, half, quarter resolution"},
    [OPTION_NORMALS] = {"normals", 0, "given|depth", DRAWING, read_normals,
                        "exact normals for the library, or none, as most hosts have it: default given"},
    [OPTION_SPLIT] = {"split", 0, NULL, DRAWING, read_flag, "the model only casts, the ground only receives"},
    [OPTION_DEVICE] = {"device", 0, "auto|software|N", DRAWING | COMMAND_INFO, read_device,
                       "which GL device; penumbra info numbers them"},
    [OPTION_SETUP] = {"setup", 0, "FILE", DRAWING, read_setup,
                      "scene block of an earlier JSON; further options override it"},
    [OPTION_REFERENCE_SAMPLES] = {"reference-samples", 0, "N", TRACING, read_reference_samples,
                                  "rays per pixel of the reference, a square number up to 65536, default 1024"},
    [OPTION_JSON] = {"json", 0, "FILE", FILES | COMMAND_MOTION, read_json,
                     "machine-readable result; - is standard output"},
    [OPTION_SAVE_DIR] = {"save-dir", 0, "DIR", COMMAND_RENDER | COMMAND_COMPARE | COMMAND_STUDY, read_save_dir,
                         "raw buffers as EXR files"},
    [OPTION_HTML] = {"html", 0, "FILE", COMMAND_COMPARE, read_html, "one self-contained page"},
    [OPTION_NO_CACHE] = {"no-cache", 0, NULL, TRACING, read_flag, "trace the reference again"},
    [OPTION_FRAMES] = {"frames", 0, "N", DRAWING & ~(COMMAND_VIEW | COMMAND_MOTION), read_frames,
                       "at most N timed frames, default 20, and at most 3 s a technique"},
    [OPTION_LIGHTS] = {"lights", 0, "N[,N...]", COMMAND_BENCH, read_lights,
                       "measure with N lights around the scene's own, default 1"},
    [OPTION_HIERARCHIES] = {"hierarchies", 0, NULL, COMMAND_BENCH, read_flag,
                            "measure range pyramid, stack and hybrid, too, for maps of 256 to 2048"},
    [OPTION_QUIET] = {"quiet", 0, NULL, EVERY, read_flag, "no progress bars"},
    [OPTION_VERBOSE] = {"verbose", 0, NULL, EVERY, read_flag, "say more"},
    [OPTION_HELP] = {"help", 'h', NULL, EVERY, read_flag, "show this and exit"},
};
