/* The experiment that commands share: each step fills what it says, can be taken again, and gives back what it took. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "experiment/choice.h"
#include "experiment/experiment.h"
#include "experiment/findings.h"
#include "scene/load.h"
#include "scene/setup.h"

enum { WIDTH = 48, HEIGHT = 36, PIXELS = WIDTH * HEIGHT };

static struct scene *load(void) {
  struct scene_request request = {.name = "builtin:boxes"};
  struct scene *scene = NULL;
  assert_int_equal(scene_load(&request, &scene), 0);
  scene->setup.size[0] = WIDTH;
  scene->setup.size[1] = HEIGHT;
  scene->setup.map[0] = scene->setup.map[1] = 64;
  assert_int_equal(setup_finish(scene), 0);
  return scene;
}

static void assert_findings(const struct experiment *e) {
  struct findings findings;
  assert_int_equal(findings_make(e, 64, 1, &findings), 0);
  const struct report *report = &findings.report;
  assert_int_equal(report->technique_count, 2);
  assert_string_equal(report->techniques[1].name, "bitmask");
  assert_string_equal(report->techniques[1].file, "02-bitmask-merge=0.exr");
  assert_true(report->techniques[0].picture == e->entries[0].picture && report->techniques[1].searched);
  cJSON *json = report_json(report);
  assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "results")), 2);
  cJSON_Delete(json);
  findings_free(&findings);
  findings_free(&findings); /* empty now */
}

static void test_steps(void **state) {
  (void)state;
  static const char *const specs[] = {"hard", "bitmask:merge=0"};
  struct scene *scene = load();
  struct experiment e;
  assert_int_equal(experiment_open(&e, scene, "software", specs, 2), 0);
  assert_int_equal(experiment_measure(&e, 2, 1), 0);
  for (int i = 0; i < 2; i++) {
    assert_true(e.entries[i].timing.frames >= 1 && e.entries[i].timing.stage_count > 0);
    assert_int_equal(experiment_draw(&e, i), 0);
  }
  /* Dropped, looked into and drawn again, it is the same. */
  float before[PIXELS];
  memcpy(before, e.entries[1].visibility, sizeof before);
  experiment_drop(&e, 1);
  assert_null(e.entries[1].visibility);
  for (int i = 0; i < 2; i++) assert_int_equal(experiment_look(&e, 1, PN_DEBUG_SEARCH), 0);
  assert_true(e.entries[1].search.searched && e.entries[1].search.pixels > 0 && !e.entries[0].search.searched);
  for (int i = 0; i < 2; i++) assert_int_equal(experiment_draw(&e, 1), 0);
  assert_memory_equal(before, e.entries[1].visibility, sizeof before);
  for (int again = 0; again < 2; again++) {
    assert_int_equal(experiment_trace(&e, 64, 0), 0);
    assert_int_equal(experiment_errors(&e), 0);
    assert_int_equal(experiment_pictures(&e), 0);
  }
  /* A technique for soft shadows is nearer to the truth than one for hard ones. */
  assert_true(e.entries[1].error.pixels > 50 && e.entries[1].error.mae < 0.5 * e.entries[0].error.mae);
  assert_memory_not_equal(e.entries[0].picture, e.reference_picture, 3 * PIXELS);
  assert_findings(&e);
  experiment_close(&e);
  assert_null(e.view);
  scene_free(&scene);
}

/* What fails half way can be closed, also twice. */
static void test_failure(void **state) {
  (void)state;
  static const char *const specs[] = {"hard", "pcss:samples=x"};
  struct scene *scene = load();
  struct experiment e;
  assert_int_equal(experiment_open(&e, scene, "99", specs, 2), 2);
  experiment_close(&e);
  assert_int_equal(experiment_open(&e, scene, "software", specs, 2), 0);
  assert_int_equal(experiment_measure(&e, 1, 0), 2);
  experiment_close(&e);
  experiment_close(&e);
  scene_free(&scene);
}

/* All techniques but the one that takes seconds a frame. */
static void test_choice(void **state) {
  (void)state;
  static const char *const given[] = {"average:samples=4", "hard"};
  int count = 0;
  const char **specs = technique_choice(given, 2, &count);
  assert_int_equal(count, 2);
  assert_true(specs[0] == given[0] && specs[1] == given[1]);
  free(specs);
  specs = technique_choice(NULL, 0, &count);
  assert_int_equal(count, pn_technique_count() - 1);
  for (int i = 0; i < count; i++) assert_string_not_equal(specs[i], "average");
  free(specs);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_steps),
      cmocka_unit_test(test_failure),
      cmocka_unit_test(test_choice),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
