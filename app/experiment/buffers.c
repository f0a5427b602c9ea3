#include "experiment/buffers.h"

#include <stdlib.h>

#include "base/message.h"

const char *const inside_kinds[INSIDE_COUNT] = {
    [INSIDE_SEARCH] = "search", [INSIDE_SOFT] = "ssm", [INSIDE_BOUND] = "bound"};

static int save_positions(const struct save *save, const struct view *view) {
  float *positions = malloc(3 * (size_t)view->width * (size_t)view->height * sizeof *positions);
  if (!positions) return memory_error();
  view_positions(view, positions);
  int status = save_vectors(save, "position.exr", positions);
  free(positions);
  return status;
}

int save_view(const struct save *save, const struct view *view) {
  int status = save_positions(save, view);
  if (!status) status = save_vectors(save, "normal.exr", view->normal);
  return status ? status : save_scalars(save, "mask.exr", view->mask);
}

static int save_inside(const struct save *save, const char *name, enum inside kind, const struct insides *in) {
  if (kind == INSIDE_SOFT) return save_layers(save, name, in->soft_width, in->soft_height, in->soft_layers, in->soft);
  if (kind == INSIDE_BOUND) return save_scalars(save, name, in->bound);
  const struct exr_plane planes[6] = {{"class", in->search, 4},          {"level", in->levels, 2},
                                      {"primitives", in->search + 2, 4}, {"range_level", in->levels + 1, 2},
                                      {"visited", in->search + 1, 4},    {"window", in->search + 3, 4}};
  return save_planes(save, name, planes, 6);
}

static int save_insides(const struct save *save, const char *file, const struct insides *in) {
  const float *const there[INSIDE_COUNT] = {
      [INSIDE_SEARCH] = in->levels ? in->search : NULL, [INSIDE_SOFT] = in->soft, [INSIDE_BOUND] = in->bound};
  int status = STATUS_OK;
  for (int i = 0; i < INSIDE_COUNT && !status; i++) {
    if (!there[i]) continue;
    char *name = save_name_inside(file, inside_kinds[i]);
    status = name ? save_inside(save, name, (enum inside)i, in) : memory_error();
    free(name);
  }
  return status;
}

int save_technique(const struct save *save, int index, const char *spec, const float *visibility,
                   const struct insides *insides) {
  char *file = save_name(index, spec);
  int status = file ? save_scalars(save, file, visibility) : memory_error();
  if (!status) status = save_insides(save, file, insides);
  free(file);
  return status;
}
