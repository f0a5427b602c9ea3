#define _GNU_SOURCE /* memmem */
#include "scene/import_axes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "scene/import_files.h"

void turn_up(struct importer *importer, int up_is_z) {
  static const double as_it_is[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, z_up[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0};
  memcpy(importer->turn, up_is_z ? z_up : as_it_is, sizeof importer->turn);
}

static int metadata(const struct aiScene *model, const char *key, int *value) {
  const struct aiMetadata *data = model->mMetaData;
  for (unsigned i = 0; data && i < data->mNumProperties; i++) {
    if (strcmp(data->mKeys[i].data, key) != 0 || data->mValues[i].mType != AI_INT32) continue;
    int32_t number;
    memcpy(&number, data->mValues[i].mData, sizeof number);
    *value = number;
    return 1;
  }
  return 0;
}

static int file_says(const struct importer *importer, const char *word) {
  size_t size = 0;
  char *bytes = read_file(importer, importer->path, &size);
  int found = bytes && memmem(bytes, size, word, strlen(word));
  free(bytes);
  return found;
}

/* Assimp makes metres of Collada's units, by a float, which is what has to be taken back; a scene is in the file's. */
static void undo_unit(struct importer *importer) {
  size_t size = 0;
  char *bytes = read_file(importer, importer->path, &size), *end = NULL;
  const char *unit = bytes ? strstr(bytes, "<unit") : NULL, *close = unit ? strchr(unit, '>') : NULL;
  const char *meter = close ? memmem(unit, (size_t)(close - unit), "meter=", 6) : NULL;
  double metres = meter ? strtof(meter + 7, &end) : 0;
  if (metres > 0 && end > meter + 7 && isfinite(1 / metres))
    for (int i = 0; i < 9; i++) importer->turn[i] /= metres;
  free(bytes);
}

static int has_ending(const char *path, const char *ending) {
  size_t length = strlen(path), wanted = strlen(ending);
  return length >= wanted && strcasecmp(path + length - wanted, ending) == 0;
}

/* FBX names three axes, with signs: the one to the right, up, and to the front. 0: it does not, or they are none. */
static int turn_fbx(struct importer *importer, const struct aiScene *model) {
  static const char *const keys[3][2] = {
      {"CoordAxis", "CoordAxisSign"}, {"UpAxis", "UpAxisSign"}, {"FrontAxis", "FrontAxisSign"}};
  double rows[9] = {0};
  int seen = 0, axis[3], sign[3];
  for (int i = 0; i < 3; i++) {
    if (!metadata(model, keys[i][0], &axis[i]) || !metadata(model, keys[i][1], &sign[i])) return 0;
    if (axis[i] < 0 || axis[i] > 2 || seen >> axis[i] & 1) return 0;
    seen |= 1 << axis[i];
    rows[3 * i + axis[i]] = sign[i] < 0 ? -1 : 1;
  }
  memcpy(importer->turn, rows, sizeof rows);
  return 1;
}

void choose_axes(struct importer *importer, const struct aiScene *model, int up_is_z) {
  turn_up(importer, up_is_z);
  int fbx = has_ending(importer->path, ".fbx") && file_says(importer, "UpAxis") && turn_fbx(importer, model);
  /* Assimp has already turned Collada's. */
  int collada = !fbx && has_ending(importer->path, ".dae") && file_says(importer, "<up_axis>");
  if (collada) turn_up(importer, 0);
  if (has_ending(importer->path, ".dae")) undo_unit(importer);
  if ((fbx || collada) && up_is_z) send_warning(importer, "says itself which axis is up; --up z is left out");
}
