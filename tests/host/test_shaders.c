/* Live editing: a directory whose files stand in for the embedded shaders. A broken one is an error with the driver's
 * words, and the mended one works without a new context. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sys/stat.h>

#include <cmocka.h>

#include "agreement.h"
#include "host.h"

static const char *const directory = "host-shaders", *const edited = "host-shaders/techniques/hard/hard.glsl";

static void write_shader(const char *text) {
  mkdir(directory, 0777);
  mkdir("host-shaders/techniques", 0777);
  mkdir("host-shaders/techniques/hard", 0777);
  remove(edited);
  if (!text) return;
  FILE *file = fopen(edited, "w");
  assert_non_null(file);
  fputs(text, file);
  assert_int_equal(fclose(file), 0);
}

static pn_result prepare_with(host *h, const char *text) {
  memset(&h->log, 0, sizeof h->log);
  write_shader(text);
  assert_int_equal(pn_reload_shaders(h->context), PN_OK);
  return pn_prepare(h->context, "hard", NULL);
}

static void test_broken(void **state) {
  host *h = *state;
  pn_light_desc desc = host_light_desc();
  lit_view lit;
  assert_int_equal(host_lit_view(h, CAST_MEMORY, &desc, "hard", &lit), PN_OK);
  float *before = host_visibility(h, lit.light, &lit.v);
  assert_non_null(before);
  assert_true(dark_pixels(before, CAMERA_WIDTH, CAMERA_HEIGHT) > 1000);
  assert_int_equal(prepare_with(h, "this is no shader\n"), PN_ERROR_SHADER);
  assert_int_equal(h->log.counts[PN_MESSAGE_SHADER_COMPILE], 1);
  assert_int_equal(pn_visibility(lit.light, lit.v.receiver), PN_ERROR_SHADER);
  assert_int_equal(prepare_with(h, "#include \"nowhere/at/all.glsl\"\n"), PN_ERROR_SHADER);
  assert_int_equal(h->log.counts[PN_MESSAGE_SHADER_MISSING], 1);
  assert_non_null(strstr(h->log.last, "nowhere/at/all.glsl"));
  assert_int_equal(prepare_with(h, NULL), PN_OK);
  float *after = host_visibility(h, lit.light, &lit.v);
  assert_non_null(after);
  assert_memory_equal(before, after, CAMERA_WIDTH * CAMERA_HEIGHT * sizeof *before);
  free(before), free(after);
  host_lit_view_close(h, &lit);
}

/* What is in the directory is what runs: everything in shadow. */
static void test_edited(void **state) {
  host *h = *state;
  assert_int_equal(
      prepare_with(h, "pn_Visibility pn_technique(int light, highp sampler2DArray maps, highp sampler2DArray range, "
                      "pn_ShadedPoint r) { return 0.0; }\n"),
      PN_OK);
  pn_light_desc desc = host_light_desc();
  lit_view lit;
  assert_int_equal(host_lit_view(h, CAST_MEMORY, &desc, "hard", &lit), PN_OK);
  float *image = host_visibility(h, lit.light, &lit.v);
  assert_non_null(image);
  assert_true(dark_pixels(image, CAMERA_WIDTH, CAMERA_HEIGHT) > CAMERA_WIDTH * CAMERA_HEIGHT / 3);
  free(image);
  host_lit_view_close(h, &lit);
  write_shader(NULL);
}

static int setup(void **state) {
  write_shader(NULL);
  if (host_setup(state) != 0) return -1;
  host *h = *state;
  pn_context_destroy(&h->context);
  pn_context_desc desc = host_context_desc(h);
  desc.shader_directory = directory;
  return pn_context_create(&desc, &h->context);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test_teardown(test_broken, host_check),
                                     cmocka_unit_test_teardown(test_edited, host_check)};
  return cmocka_run_group_tests_name("shaders", tests, setup, host_teardown);
}
