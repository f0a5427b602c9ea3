#include "agreement.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

double local_range(const float *image, int width, int height, int x, int y, int r) {
  float least = 2, most = -1;
  for (int j = y - r; j <= y + r; j++) {
    for (int i = x - r; i <= x + r; i++) {
      if (i < 0 || j < 0 || i >= width || j >= height) continue;
      float v = image[j * width + i];
      if (v < least) least = v;
      if (v > most) most = v;
    }
  }
  return most - least;
}

agreement agree(const float *a, int a_width, int a_height, int offset_x, int offset_y, const float *b, int width,
                int height, const unsigned char *skip) {
  agreement out = {0};
  for (int y = 0; y < height; y++) {
    for (int x = 0; x < width; x++) {
      if (skip && skip[y * width + x]) continue;
      int ax = x + offset_x, ay = y + offset_y;
      double difference = fabs((double)b[y * width + x] - a[ay * a_width + ax]);
      out.pixels++;
      out.range += local_range(a, a_width, a_height, ax, ay, 1);
      out.sum += difference;
      if (!(difference <= out.worst)) out.worst = difference;
      if (!(difference <= 1e-6)) {
        out.differing++;
        out.strays += local_range(a, a_width, a_height, ax, ay, 2) == 0;
      }
    }
  }
  return out;
}

int dark_pixels(const float *image, int width, int height) {
  int count = 0;
  for (int i = 0; i < width * height; i++) count += image[i] < 0.5f;
  return count;
}

double allowed_changes(double expected) { return expected + 4 * sqrt(expected) + 4; }

double view_error(const camera *view, const surfaces *seen) {
  mat4 clip = camera_clip(view);
  double worst = 0;
  for (int i = 0; i < seen->width * seen->height; i += 7) {
    const float *p = seen->position + 4 * i;
    if (p[3] < 0) continue;
    double z = project(&clip, v3_of(p), NULL).z, error = camera_depth_error(view, view->zero_to_one ? z : (z + 1) / 2);
    if (error > worst) worst = error;
  }
  GLint bits = 4;
  gl.GetIntegerv(GL_SUBPIXEL_BITS, &bits);
  return worst + ldexp(1, -bits);
}

void save_picture(const char *name, const float *image, int width, int height) {
  const char *directory = getenv("HOST_PICTURES");
  char path[512];
  if (!directory || !image) return;
  snprintf(path, sizeof path, "%s/%s.pgm", directory, name);
  FILE *file = fopen(path, "wb");
  if (!file) return;
  fprintf(file, "P5\n%d %d\n255\n", width, height);
  for (int y = height - 1; y >= 0; y--) {
    for (int x = 0; x < width; x++) {
      float v = image[y * width + x];
      fputc((int)(255 * (v < 0 ? 0 : v > 1 ? 1 : v) + 0.5f), file);
    }
  }
  fclose(file);
}
