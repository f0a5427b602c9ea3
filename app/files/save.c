#define _GNU_SOURCE /* asprintf */
#include "files/save.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/interrupt.h"
#include "base/message.h"
#include "files/label.h"

static const char *made_folder; /* NULL: it was there before */

int save_check(const char *folder) {
  struct stat info;
  if (mkdir(folder, 0777) == 0) {
    made_folder = folder;
    interrupt_watch_folder(folder);
  } else if (errno != EEXIST) {
    return work_error("cannot make the directory %s: %s", folder, strerror(errno));
  }
  if (stat(folder, &info) != 0 || !S_ISDIR(info.st_mode))
    return work_error("cannot write into %s: it is not a directory", folder);
  if (access(folder, W_OK | X_OK) != 0) return work_error("cannot write into %s: %s", folder, strerror(errno));
  return STATUS_OK;
}

void save_abandon(void) {
  if (made_folder) rmdir(made_folder); /* fails where something is in it */
  made_folder = NULL;
  interrupt_watch_folder(NULL);
}

static int save_sized(const struct save *save, const char *name, int width, int height, const struct exr_plane *planes,
                      int plane_count) {
  char *path = NULL;
  if (asprintf(&path, "%s/%s", save->folder, name) < 0) return memory_error();
  int status = exr_write(path, width, height, planes, plane_count);
  if (!status) fprintf(save->people, "%s\n", path);
  free(path);
  return status;
}

int save_planes(const struct save *save, const char *name, const struct exr_plane *planes, int plane_count) {
  return save_sized(save, name, save->width, save->height, planes, plane_count);
}

int save_layers(const struct save *save, const char *name, int width, int height, int layers, const float *values) {
  enum { MOST = 9 }; /* one digit: the names stay in EXR's alphabetical order */
  struct exr_plane planes[MOST];
  char names[MOST][12] = {"Y"};
  for (int i = 0; i < layers && i < MOST; i++) {
    if (i) snprintf(names[i], sizeof names[i], "layer%d.Y", i + 1);
    planes[i] = (struct exr_plane){names[i], values + (size_t)i * (size_t)width * (size_t)height, 1};
  }
  return save_sized(save, name, width, height, planes, layers < MOST ? layers : MOST);
}

int save_vectors(const struct save *save, const char *name, const float *vectors) {
  const struct exr_plane planes[3] = {{"X", vectors, 3}, {"Y", vectors + 1, 3}, {"Z", vectors + 2, 3}};
  return save_planes(save, name, planes, 3);
}

int save_scalars(const struct save *save, const char *name, const float *values) {
  const struct exr_plane plane = {"Y", values, 1};
  return save_planes(save, name, &plane, 1);
}

char *save_name(int index, const char *spec) {
  char *label = file_label(spec), *name = NULL;
  if (label && asprintf(&name, "%02d-%.200s.exr", index + 1, label) < 0) name = NULL;
  free(label);
  return name;
}

char *save_name_inside(const char *file, const char *kind) {
  char *name = NULL;
  int stem = (int)(strlen(file) - strlen(".exr"));
  return asprintf(&name, "%.*s.%s.exr", stem, file, kind) < 0 ? NULL : name;
}
