#include "scene/import_place.h"

#include <math.h>
#include <sys/stat.h>

#include "scene/scene.h"

/* A file of a kilobyte can place a mesh a billion times, and each instance costs draws in every frame. What a large
 * file lists itself is its own affair; what only references to references make is bounded. */
enum { INSTANCES_MAX = 1 << 14, BYTES_PER_INSTANCE = 64, PLACED_MAX = 1 << 25, PLACED_PER_HELD = 8 };

static uint64_t instances_most(const struct importer *importer) {
  struct stat info;
  uint64_t by_size = stat(importer->path, &info) == 0 ? (uint64_t)info.st_size / BYTES_PER_INSTANCE : 0;
  return by_size > INSTANCES_MAX ? by_size : INSTANCES_MAX;
}

struct place place_identity(void) {
  return (struct place){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
}

struct place place_product(const struct place *a, const struct place *b) {
  struct place out = {{0}};
  for (int column = 0; column < 4; column++)
    for (int row = 0; row < 4; row++)
      for (int k = 0; k < 4; k++) out.m[4 * column + row] += a->m[4 * k + row] * b->m[4 * column + k];
  return out;
}

void place_point(const struct place *a, const double p[3], double out[3]) {
  for (int row = 0; row < 3; row++)
    out[row] = a->m[row] * p[0] + a->m[4 + row] * p[1] + a->m[8 + row] * p[2] + a->m[12 + row];
}

/* 0: not a finite affine matrix. */
static int turned(const struct importer *importer, const struct place *p, double out[16]) {
  for (int column = 0; column < 4; column++) {
    for (int row = 0; row < 3; row++) {
      out[4 * column + row] = 0;
      for (int k = 0; k < 3; k++) out[4 * column + row] += importer->turn[3 * row + k] * p->m[4 * column + k];
    }
    out[4 * column + 3] = column == 3;
  }
  for (int i = 0; i < 16; i++)
    if (!isfinite(out[i]) || fabs(out[i]) > COORDINATE_MAX) return 0;
  return p->m[3] == 0 && p->m[7] == 0 && p->m[11] == 0 && p->m[15] == 1;
}

/* A transform that flattens everything leaves no area to block light with. */
static int flattens(const double m[16]) {
  double x = 0, y = 0, z = 0;
  for (int i = 0; i < 3; i++) {
    x += m[i] * m[i];
    y += m[4 + i] * m[4 + i];
    z += m[8 + i] * m[8 + i];
  }
  return (x == 0) + (y == 0) + (z == 0) > 1;
}

void send_instance(struct importer *importer, int mesh, uint64_t triangles, const struct place *file_from_object) {
  struct record r = {.tag = RECORD_INSTANCE, .mesh = mesh};
  if (!turned(importer, file_from_object, r.scene_from_object) || flattens(r.scene_from_object)) {
    importer->dropped_instances++;
    return;
  }
  importer->triangles_placed += triangles;
  if (++importer->instance_count > INSTANCES_MAX && (uint64_t)importer->instance_count > instances_most(importer))
    refuse(importer, "places meshes more than %llu times, which is more than a file of its size may",
           (unsigned long long)instances_most(importer));
  if (importer->triangles_placed > PLACED_MAX &&
      importer->triangles_placed / PLACED_PER_HELD > importer->triangles_held)
    refuse(importer, "holds %llu triangles but places them so often that there are more than %d",
           (unsigned long long)importer->triangles_held, PLACED_MAX);
  send_bytes(importer->fd, &r, sizeof r);
}
