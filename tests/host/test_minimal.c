/* The example: it needs at most 40 lines of penumbra, and its window shows a lit floor with a soft shadow. Arguments:
 * its source, its executable, and a command in front of it (a virtual display) or "". */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "image_file.h"

static const char *source, *executable, *display;

static int blank(const char *line) { return line[strspn(line, " \t\r\n")] == 0; }

static void test_lines(void **state) {
  char line[1024];
  int inside = 0, count = 0, marks = 0, outside = 0;
  (void)state;
  FILE *file = fopen(source, "r");
  assert_non_null(file);
  while (fgets(line, sizeof line, file)) {
    if (strstr(line, "/* penumbra */")) {
      inside = 1, marks++;
    } else if (strstr(line, "/* end */")) {
      inside = 0;
    } else if (inside) {
      count += !blank(line);
    } else {
      /* Nothing of the library's hides between the marked parts. */
      outside += strstr(line, "pn_") != NULL || strstr(line, "PN_") != NULL;
    }
  }
  fclose(file);
  printf("%d lines of penumbra in %d places\n", count, marks);
  assert_true(marks > 0 && !inside);
  assert_true(count > 0 && count <= 40);
  assert_int_equal(outside, 0);
}

/* Grey (the floor) is bright, dark, and in between; the red box is there. */
static void test_window(void **state) {
  char command[1024];
  int width = 0, height = 0, bright = 0, dark = 0, between = 0, red = 0;
  (void)state;
  remove("minimal.ppm");
  snprintf(command, sizeof command, "%s '%s' --frames 2 --screenshot minimal.ppm", display, executable);
  assert_int_equal(system(command), 0);
  unsigned char *pixels = ppm_pixels("minimal.ppm", &width, &height);
  assert_non_null(pixels);
  assert_true(width >= 640 && height >= 480);
  for (int i = 0; i < width * height; i++) {
    const unsigned char *p = pixels + 3 * i;
    if (p[0] > p[1] + 40) red++;
    else if (p[0] >= p[2] && p[0] > 150) bright++;
    else if (p[0] >= p[2] && p[0] < 75) dark++;
    else if (p[0] >= p[2] && p[0] > 80 && p[0] < 145) between++;
  }
  free(pixels);
  printf("floor: %d bright, %d dark, %d between; box %d\n", bright, dark, between, red);
  assert_true(bright > width * height / 10);
  assert_true(dark > width * height / 200);
  assert_true(between > width * height / 200);
  assert_true(red > width * height / 100);
}

static void test_bad_option(void **state) {
  char command[1024];
  (void)state;
  snprintf(command, sizeof command, "'%s' --nonsense 2> minimal.err", executable);
  assert_int_equal(system(command) / 256, 2);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_lines), cmocka_unit_test(test_window),
                                     cmocka_unit_test(test_bad_option)};
  if (argc < 4) return 77;
  source = argv[1], executable = argv[2], display = argv[3];
  return cmocka_run_group_tests_name("minimal", tests, NULL, NULL);
}
