#include "report/motion.h"

#include <math.h>
#include <stdlib.h>

#include "report/error.h"

/* The same surface point: as far as two pictures of it in floats agree. */
static int same_point(const float *a, const float *b) {
  float size = 0, apart = 0;
  for (int k = 0; k < 3; k++) {
    size = fmaxf(size, fabsf(a[k]));
    apart = fmaxf(apart, fabsf(a[k] - b[k]));
  }
  return apart <= 1e-6f * size; /* false where one is not a number */
}

static int is_shadow(const struct motion_frame *f, size_t i) {
  return f->visibility[i] < ERROR_SHADOW_BELOW || f->truth[i] < ERROR_SHADOW_BELOW;
}

/* ---- what moves -------------------------------------------------------------------------------------------------- */

enum { STILL = 0, MOVES };

static void mark_around(uint8_t *marks, int x, int y, int width, int height) {
  for (int v = y - MOTION_AROUND; v <= y + MOTION_AROUND; v++)
    for (int u = x - MOTION_AROUND; u <= x + MOTION_AROUND; u++)
      if (u >= 0 && v >= 0 && u < width && v < height) marks[(size_t)v * (size_t)width + (size_t)u] = MOVES;
}

/* Through umbra, from neighbours that come before in a sweep of that direction. Whether anything was marked. */
static int sweep(const struct motion_frame *before, uint8_t *marks, int width, int height, int direction) {
  int count = width * height, marked = 0;
  for (int k = 0; k < count; k++) {
    int i = direction > 0 ? k : count - 1 - k, beside = i % width - direction, above = i - direction * width;
    if (marks[i] == MOVES || before->truth[i] > 0 || !(before->mask[i] > 0)) continue;
    int moves = (beside >= 0 && beside < width && marks[i - direction] == MOVES) ||
                (above >= 0 && above < count && marks[above] == MOVES);
    if (!moves) continue;
    marks[i] = MOVES;
    marked = 1;
  }
  return marked;
}

/* Shadows that move: where the truth changes and close to it, and the umbra that this is the edge of. */
static void mark_moving(const struct motion_frame *before, const struct motion_frame *after, uint8_t *marks, int width,
                        int height) {
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      size_t i = (size_t)y * (size_t)width + (size_t)x;
      if (before->truth[i] != after->truth[i]) mark_around(marks, x, y, width, height);
    }
  while (sweep(before, marks, width, height, 1) | sweep(before, marks, width, height, -1)) {
  }
}

/* ---- the numbers ------------------------------------------------------------------------------------------------- */

int motion_measure(const struct motion_frame *before, const struct motion_frame *after, int width, int height,
                   struct motion_statistics *out) {
  struct motion_statistics m = {0};
  size_t count = (size_t)width * (size_t)height;
  uint8_t *marks = calloc(count + 1, sizeof *marks);
  if (marks) mark_moving(before, after, marks, width, height);
  for (size_t i = 0; marks && i < count; i++) {
    int counts = before->mask[i] > 0 && after->mask[i] > 0 && (is_shadow(before, i) || is_shadow(after, i));
    if (!counts || !same_point(before->position + 3 * i, after->position + 3 * i)) continue;
    double change = (double)after->visibility[i] - before->visibility[i];
    double wanted = (double)after->truth[i] - before->truth[i];
    m.pixels++;
    if (marks[i] == STILL) {
      m.still++;
      m.seen += fabs(change) > MOTION_SEEN;
      m.still_most = fmax(m.still_most, fabs(change));
    } else m.moving += fabs(change - wanted);
  }
  if (m.pixels > m.still) m.moving /= (double)(m.pixels - m.still);
  *out = m;
  free(marks);
  return marks != NULL;
}
