/* motion.h: what a picture of visibility does between two frames, beside what the truth does there. */
#ifndef PENUMBRA_APP_REPORT_MOTION_H
#define PENUMBRA_APP_REPORT_MOTION_H

#include <stddef.h>
#include <stdint.h>

/* A change that an eye may see, of shadows that keep still. */
#define MOTION_SEEN (2 / 255.0)
/* What lies so near, in pixels, to a truth that changes belongs to a shadow that moves, even where rays do not tell;
 * and so does the umbra within. */
enum { MOTION_AROUND = 4 };

/* One frame, over plain arrays: where each pixel's surface is (3 a pixel; background is not finite), whether it counts,
 * its visibility by a technique and in truth. */
struct motion_frame {
  const float *position, *mask, *visibility, *truth;
};

struct motion_statistics {
  size_t pixels;     /* that show the same surface point in both frames, where a result or a truth is shadow */
  size_t still;      /* of them, those of shadows that keep still: see MOTION_AROUND */
  size_t seen;       /* of the still ones, those that change by more than MOTION_SEEN */
  double still_most; /* largest change of a still one */
  double moving;     /* mean |change of the result - change of the truth| over the others; 0 where there are none */
};

/* Returns 0 when memory ran out. */
int motion_measure(const struct motion_frame *before, const struct motion_frame *after, int width, int height,
                   struct motion_statistics *out);

#endif
