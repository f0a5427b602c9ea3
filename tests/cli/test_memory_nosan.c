/* Loading a million triangles: at most 1 KB each while importing, 300 bytes each afterwards. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

#include "scene/import_process.h"
#include "scene/load.h"

enum { SIDE = 708, TRIANGLES = 2 * SIDE * SIDE }; /* 1,002,528 */

static float height(int x, int y) { return (float)((x * 7 + y * 13) % 10) * 0.1f; }

static void put_corner(FILE *file, int x, int y) {
  const float p[3] = {(float)x, height(x, y), (float)y};
  fwrite(p, sizeof p, 1, file);
}

static void write_ply(FILE *file) {
  fprintf(
      file,
      "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
      "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
      (SIDE + 1) * (SIDE + 1), TRIANGLES);
  for (int i = 0; i < (SIDE + 1) * (SIDE + 1); i++) put_corner(file, i % (SIDE + 1), i / (SIDE + 1));
  for (int i = 0; i < TRIANGLES; i++) {
    int32_t a = i / 2 / SIDE * (SIDE + 1) + i / 2 % SIDE;
    const int32_t lower[3] = {a, a + SIDE + 1, a + 1}, upper[3] = {a + 1, a + SIDE + 1, a + SIDE + 2};
    fputc(3, file);
    fwrite(i % 2 ? upper : lower, 12, 1, file);
  }
}

static void write_stl(FILE *file) {
  static const char zeros[80];
  const uint32_t count = TRIANGLES;
  fwrite(zeros, 80, 1, file);
  fwrite(&count, 4, 1, file);
  for (int i = 0; i < TRIANGLES; i++) {
    int x = i / 2 % SIDE, y = i / 2 / SIDE, up = i % 2;
    fwrite(zeros, 12, 1, file);
    put_corner(file, x + up, y);
    put_corner(file, x, y + 1);
    put_corner(file, x + 1, y + up);
    fwrite(zeros, 2, 1, file);
  }
}

static void write_obj(FILE *file) {
  for (int i = 0; i < (SIDE + 1) * (SIDE + 1); i++)
    fprintf(file, "v %d %g %d\n", i % (SIDE + 1), height(i % (SIDE + 1), i / (SIDE + 1)), i / (SIDE + 1));
  for (int i = 0; i < TRIANGLES; i++) {
    int a = i / 2 / SIDE * (SIDE + 1) + i / 2 % SIDE + 1;
    fprintf(file, i % 2 ? "f %d %d %d\n" : "f %d %d %d\n", i % 2 ? a + 1 : a, a + SIDE + 1,
            i % 2 ? a + SIDE + 2 : a + 1);
  }
}

/* VmHWM: the most memory this process ever had, in bytes. */
static size_t high_water(void) {
  FILE *file = fopen("/proc/self/status", "r");
  char line[128];
  size_t kilobytes = 0;
  while (file && fgets(line, sizeof line, file))
    if (sscanf(line, "VmHWM: %zu", &kilobytes) == 1) break;
  if (file) fclose(file);
  return kilobytes * 1024;
}

/* The next high water mark counts from what is in use now. */
static void forget_high_water(void) {
  FILE *file = fopen("/proc/self/clear_refs", "w");
  if (!file) return;
  fputs("5", file);
  fclose(file);
}

static void check(const char *ending, void (*write)(FILE *)) {
  char path[64];
  snprintf(path, sizeof path, "/tmp/penumbra-memory-%d.%s", (int)getpid(), ending);
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  write(file);
  assert_int_equal(fclose(file), 0);
  forget_high_water();
  size_t before = high_water();
  struct scene_request request = {.name = path, .ground = GROUND_OFF};
  struct scene *scene = NULL;
  int status = scene_load(&request, &scene);
  size_t after = high_water();
  unlink(path);
  assert_int_equal(status, 0);
  assert_int_equal(scene->triangle_count, TRIANGLES);
  assert_int_equal(scene->meshes[0].vertex_count, (SIDE + 1) * (SIDE + 1));
  struct rusage children;
  assert_int_equal(getrusage(RUSAGE_CHILDREN, &children), 0);
  double importing = (double)children.ru_maxrss * 1024 / TRIANGLES, afterwards = (double)(after - before) / TRIANGLES;
  printf("%s: %.0f bytes a triangle while importing, %.0f afterwards\n", ending, importing, afterwards);
  assert_true(importing <= 1024);
  assert_true(afterwards <= 300);
  scene_free(&scene);
}

/* Children's high water mark only rises, so the leanest format goes first. */
static void test_formats(void **state) {
  (void)state;
  check("stl", write_stl);
  check("ply", write_ply);
  check("obj", write_obj);
}

int main(int argc, char **argv) {
  import_serve(argc, argv);
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_formats)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
