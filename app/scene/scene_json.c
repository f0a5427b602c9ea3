#include "scene/scene_json.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/message.h"
#include "base/names.h"
#include "files/image.h"
#include "scene/vector.h"

enum { SETUP_FILE_MAX = 64 << 20 };

/* What is not finite becomes null. NULL: out of memory. */
static cJSON *json_numbers(const double *values, int count) {
  cJSON *array = cJSON_CreateArray();
  for (int i = 0; i < count && array; i++)
    cJSON_AddItemToArray(array, isfinite(values[i]) ? cJSON_CreateNumber(values[i]) : cJSON_CreateNull());
  return array;
}

static cJSON *json_pair(const int values[2]) { return cJSON_CreateIntArray(values, 2); }

static void add_light(cJSON *scene, const struct light *light) {
  cJSON *object = cJSON_AddObjectToObject(scene, "light");
  cJSON_AddStringToObject(object, "type", light->shape == PN_LIGHT_SUN ? "sun" : "rectangle");
  cJSON_AddItemToObject(object, "center", json_numbers(light->center, 3));
  cJSON_AddItemToObject(object, "direction", json_numbers(light->direction, 3));
  cJSON_AddItemToObject(object, "u", json_numbers(light->u, 3));
  cJSON_AddItemToObject(object, "v", json_numbers(light->v, 3));
  cJSON_AddItemToObject(object, "size", json_numbers(light->size, 2));
  cJSON_AddItemToObject(object, "target", json_numbers(light->target, 3));
  cJSON_AddItemToObject(object, "up", json_numbers(light->up, 3));
}

static void add_camera(cJSON *scene, const struct camera *camera) {
  cJSON *object = cJSON_AddObjectToObject(scene, "camera");
  cJSON_AddItemToObject(object, "position", json_numbers(camera->position, 3));
  cJSON_AddItemToObject(object, "target", json_numbers(camera->target, 3));
  cJSON_AddItemToObject(object, "up", json_numbers(camera->up, 3));
  cJSON_AddNumberToObject(object, "fov", camera->fov);
}

cJSON *scene_to_json(const struct scene *scene) {
  static const char *const grounds[] = {"default", "on", "off"};
  const struct setup *setup = &scene->setup;
  cJSON *object = cJSON_CreateObject();
  if (!object) return NULL;
  cJSON_AddStringToObject(object, "name", scene->name);
  cJSON_AddNumberToObject(object, "triangles", (double)scene->triangle_count);
  add_light(object, &setup->light);
  add_camera(object, &setup->camera);
  cJSON_AddItemToObject(object, "size", json_pair(setup->size));
  cJSON_AddItemToObject(object, "map", json_pair(setup->map));
  cJSON_AddBoolToObject(object, "split", setup->split);
  cJSON_AddNumberToObject(object, "visibility_scale", setup->visibility_scale);
  cJSON_AddStringToObject(object, "normals", setup->normals_from_depth ? "depth" : "given");
  if (setup->fit == PN_FIT_GIVEN) cJSON_AddItemToObject(object, "fit", json_numbers(setup->fit_bounds, 6));
  else cJSON_AddStringToObject(object, "fit", setup->fit == PN_FIT_CASTERS ? "casters" : "visible");
  cJSON_AddStringToObject(object, "ground", grounds[setup->ground]);
  cJSON_AddStringToObject(object, "up", setup->up_is_z ? "z" : "y");
  return object;
}

static char *read_text(const char *path, size_t *size) {
  struct stat info;
  int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC); /* a FIFO would wait for somebody who writes */
  FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "rb");
  char *text = NULL;
  if (!file) {
    input_error("--setup %s: %s", path, strerror(errno));
    return NULL;
  }
  const char *problem = fstat(fileno(file), &info) != 0        ? strerror(errno)
                        : S_ISDIR(info.st_mode)                ? "is a directory, not a JSON file"
                        : !S_ISREG(info.st_mode)               ? "is not a regular file"
                        : info.st_size > (off_t)SETUP_FILE_MAX ? "is larger than 64 MB, too large for a set-up"
                                                               : NULL;
  if (problem) input_error("--setup %s: %s", path, problem);
  if (!problem && !(text = malloc((size_t)info.st_size + 1))) memory_error();
  if (text) {
    *size = fread(text, 1, (size_t)info.st_size, file);
    text[*size] = 0;
  }
  fclose(file);
  return text;
}

static const char *const scene_keys[] = {"name",  "triangles",        "light",   "camera", "size",   "map",
                                         "split", "visibility_scale", "normals", "fit",    "ground", "up",
                                         NULL};
static const char *const light_keys[] = {"type", "center", "direction", "u", "v", "size", "target", "up", NULL};
static const char *const camera_keys[] = {"position", "target", "up", "fov", NULL};

static int count_names(const char *const *names) {
  int count = 0;
  while (names[count]) count++;
  return count;
}

static int is_among(const char *name, const char *const *names) {
  for (; *names; names++)
    if (strcmp(name, *names) == 0) return 1;
  return 0;
}

/* A misspelt key would otherwise be a value that silently does nothing. */
static void warn_about_keys(const char *path, const char *where, const cJSON *object, const char *const *known) {
  const cJSON *item;
  char hint[100];
  if (cJSON_IsObject(object)) cJSON_ArrayForEach(item, object) {
      if (is_among(item->string, known)) continue;
      int near = nearest_name(item->string, known, count_names(known), hint, sizeof hint);
      warning("--setup %s: %s has an unknown key '%s', which is not read%s%s", path, where, item->string,
              near ? "; " : "", near ? hint : "");
    }
}

/* Whether an object says anything about a set-up: name and triangles alone do not. */
static int has_setup(const cJSON *object) {
  for (const char *const *key = scene_keys + 2; *key; key++)
    if (cJSON_GetObjectItemCaseSensitive(object, *key)) return 1;
  return 0;
}

int setup_read(const char *path, cJSON **out) {
  *out = NULL;
  size_t size = 0;
  char *text = read_text(path, &size);
  if (!text) return STATUS_INPUT;
  cJSON *root = cJSON_ParseWithLength(text, size);
  free(text);
  if (!root) return input_error("--setup %s: is not JSON", path);
  cJSON *scene = cJSON_DetachItemFromObjectCaseSensitive(root, "scene");
  if (scene) {
    cJSON_Delete(root);
    root = scene;
  }
  if (cJSON_IsObject(root) && has_setup(root)) {
    warn_about_keys(path, "the scene", root, scene_keys);
    warn_about_keys(path, "light", cJSON_GetObjectItemCaseSensitive(root, "light"), light_keys);
    warn_about_keys(path, "camera", cJSON_GetObjectItemCaseSensitive(root, "camera"), camera_keys);
    *out = root;
    return STATUS_OK;
  }
  cJSON_Delete(root);
  return input_error("--setup %s: holds no set-up of a scene, such as a light, a camera or a size", path);
}

/* Reading: one struct carries where we are, and whether something was wrong already, so that only the first fault
 * is told. */
struct reader {
  const char *path;
  int status;
};

static void complain(struct reader *r, const char *key, const char *wanted) {
  if (!r->status) r->status = input_error("--setup %s: %s must be %s", r->path, key, wanted);
}

static int has(const cJSON *object, const char *key) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
  return item && !cJSON_IsNull(item);
}

static void get_numbers(struct reader *r, const cJSON *object, const char *key, int count, double *out) {
  if (!has(object, key)) return;
  const cJSON *array = cJSON_GetObjectItemCaseSensitive(object, key), *item;
  int i = 0;
  double values[6];
  if (cJSON_IsArray(array) && cJSON_GetArraySize(array) == count) cJSON_ArrayForEach(item, array) {
      if (!cJSON_IsNumber(item) || !(fabs(item->valuedouble) <= COORDINATE_MAX)) break;
      values[i++] = item->valuedouble;
    }
  char wanted[64];
  snprintf(wanted, sizeof wanted, "%d finite numbers", count);
  if (i == count) memcpy(out, values, (size_t)count * sizeof *out);
  else complain(r, key, wanted);
}

static void get_size(struct reader *r, const cJSON *object, const char *key, int most, int out[2]) {
  double pair[2] = {out[0], out[1]};
  get_numbers(r, object, key, 2, pair);
  if (!(pair[0] >= 1 && pair[0] <= most && pair[1] >= 1 && pair[1] <= most)) {
    char wanted[64];
    snprintf(wanted, sizeof wanted, "two numbers from 1 to %d", most);
    complain(r, key, wanted);
    return;
  }
  out[0] = (int)pair[0];
  out[1] = (int)pair[1];
}

/* The index of the member's word, or -1 where it is missing. */
static int get_word(struct reader *r, const cJSON *object, const char *key, const char *const *words,
                    const char *wanted) {
  if (!has(object, key)) return -1;
  const char *value = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, key));
  for (int i = 0; value && words[i]; i++)
    if (strcmp(value, words[i]) == 0) return i;
  complain(r, key, wanted);
  return -1;
}

/* Files that only hold what the contract names have no target and no up: direction and v say the same, and the
 * target is as far as it was. */
static void get_light(struct reader *r, const cJSON *object, struct light *light) {
  static const char *const types[] = {"rectangle", "sun", NULL};
  double toward[3];
  v3_sub(light->target, light->center, toward);
  double distance = v3_length(toward);
  int type = get_word(r, object, "type", types, "\"rectangle\" or \"sun\"");
  if (type >= 0) light->shape = type ? PN_LIGHT_SUN : PN_LIGHT_RECTANGLE;
  get_numbers(r, object, "center", 3, light->center);
  if (!has(object, "target") && has(object, "direction")) {
    get_numbers(r, object, "direction", 3, toward);
    v3_normalize(toward);
    v3_add_scaled(light->center, distance, toward, light->target);
  }
  get_numbers(r, object, "target", 3, light->target);
  get_numbers(r, object, "v", 3, light->up);
  get_numbers(r, object, "up", 3, light->up);
  get_numbers(r, object, "size", 2, light->size);
  if (!(light->size[0] > 0 && light->size[1] > 0)) complain(r, "light.size", "two numbers greater than 0");
}

static void get_camera(struct reader *r, const cJSON *object, struct camera *camera) {
  get_numbers(r, object, "position", 3, camera->position);
  get_numbers(r, object, "target", 3, camera->target);
  get_numbers(r, object, "up", 3, camera->up);
  if (!has(object, "fov")) return;
  const cJSON *fov = cJSON_GetObjectItemCaseSensitive(object, "fov");
  if (cJSON_IsNumber(fov) && fov->valuedouble >= 0.01 && fov->valuedouble <= 170) camera->fov = fov->valuedouble;
  else complain(r, "camera.fov", "an angle from 0.01 to 170");
}

static void get_fit(struct reader *r, const cJSON *object, struct setup *setup) {
  static const char *const fits[] = {"visible", "casters", NULL};
  if (cJSON_IsArray(cJSON_GetObjectItemCaseSensitive(object, "fit"))) {
    setup->fit = PN_FIT_GIVEN;
    double *b = setup->fit_bounds;
    get_numbers(r, object, "fit", 6, b);
    if (!(b[0] <= b[3] && b[1] <= b[4] && b[2] <= b[5])) complain(r, "fit", "a box, least corner first");
    return;
  }
  int fit = get_word(r, object, "fit", fits, "\"visible\", \"casters\" or a box");
  if (fit >= 0) setup->fit = fit ? PN_FIT_CASTERS : PN_FIT_VISIBLE;
}

int setup_request(const char *path, const cJSON *json, struct scene_request *request) {
  static const char *const grounds[] = {"default", "on", "off", NULL}, *const ups[] = {"y", "z", NULL};
  struct reader r = {path, STATUS_OK};
  int ground = get_word(&r, json, "ground", grounds, "\"default\", \"on\" or \"off\"");
  int up = get_word(&r, json, "up", ups, "\"y\" or \"z\"");
  if (ground >= 0) request->ground = (enum ground)ground;
  if (up >= 0) request->up_is_z = up;
  if (cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(json, "split"))) request->split = 1;
  return r.status;
}

int setup_apply_json(const char *path, const cJSON *json, struct setup *setup) {
  struct reader r = {path, STATUS_OK};
  const cJSON *light = cJSON_GetObjectItemCaseSensitive(json, "light"),
              *camera = cJSON_GetObjectItemCaseSensitive(json, "camera");
  if (cJSON_IsObject(light)) get_light(&r, light, &setup->light);
  else if (has(json, "light")) complain(&r, "light", "an object");
  if (cJSON_IsObject(camera)) get_camera(&r, camera, &setup->camera);
  else if (has(json, "camera")) complain(&r, "camera", "an object");
  get_size(&r, json, "size", IMAGE_SIZE_MAX, setup->size);
  get_size(&r, json, "map", PN_MAP_SIZE_MAX, setup->map);
  get_fit(&r, json, setup);
  const cJSON *scale = cJSON_GetObjectItemCaseSensitive(json, "visibility_scale");
  if (scale && !cJSON_IsNull(scale)) {
    double s = cJSON_IsNumber(scale) ? scale->valuedouble : 0;
    if (s == 1 || s == 2 || s == 4) setup->visibility_scale = (int)s;
    else complain(&r, "visibility_scale", "1, 2 or 4");
  }
  static const char *const normals[] = {"given", "depth", NULL};
  int from_depth = get_word(&r, json, "normals", normals, "\"given\" or \"depth\"");
  if (from_depth >= 0) setup->normals_from_depth = from_depth;
  return r.status;
}
