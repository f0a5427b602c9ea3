/* Stage times. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "light.h"
#include "stage.h"

enum { SIZE = 256, CAPACITY = 16 };

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

typedef struct {
  stage s;
  view v;
  soup solids;
  pn_light_desc light;
} bench;

static void bench_open(bench *b) {
  memset(b, 0, sizeof *b);
  soup_patch(&b->solids, v3(0, 0, 0), v3(2, 0, 0), v3(0, 0, 2));
  soup_box(&b->solids, v3(-0.4, 0.3, -0.4), v3(0.4, 0.9, 0.4));
  camera k = {.width = SIZE,
              .height = SIZE,
              .eye = v3(1, 3, 2.5),
              .up = v3(0, 1, 0),
              .half_height = 0.4,
              .near = 0.1,
              .far = 20};
  view_draw(&b->v, &k, &b->solids);
  stage_open(&b->s);
  stage_cast(&b->s, &b->solids);
  stage_receive(&b->s, &b->v, false);
  b->light = light_at(v3(0, 3, 0), v3(0, -1, 0), 0.5, 0.5, 512);
  b->light.fit = PN_FIT_VISIBLE;
  assert_ok(pn_light_technique(b->s.light, "pcss", NULL, 0));
  assert_ok(pn_light_set(b->s.light, &b->light));
}

static void bench_close(bench *b) {
  stage_close(&b->s);
  view_free(&b->v);
  soup_free(&b->solids);
}

static void frame(bench *b) {
  assert_ok(pn_maps_update(b->s.light, b->s.casters, PN_GROUPS_ALL, &b->s.receiver, 1));
  assert_ok(pn_visibility(b->s.light, b->s.receiver));
}

static void test_off_at_first(void **state) {
  (void)state;
  bench b;
  pn_time times[CAPACITY];
  bench_open(&b);
  frame(&b);
  assert_int_equal(pn_times(b.s.light, times, CAPACITY, 1), 0);
  bench_close(&b);
}

/* The best share of a frame's wall time that its stages add up to. */
static double best_share(bench *b, int frames) {
  double best = 0;
  for (int i = 0; i < frames; i++) {
    pn_time times[CAPACITY];
    glFinish();
    double start = now();
    frame(b);
    glFinish();
    double wall = now() - start, sum = 0;
    int count = pn_times(b->s.light, times, CAPACITY, 0);
    assert_in_range(count, 3, CAPACITY);
    for (int k = 0; k < count; k++) {
      assert_true(times[k].milliseconds >= 0);
      for (int j = 0; j < k; j++) assert_string_not_equal(times[j].stage, times[k].stage);
      sum += times[k].milliseconds;
    }
    assert_true(sum > 0 && sum <= wall);
    best = fmax(best, sum / wall);
  }
  return best;
}

/* On software GL every stage ends in glFinish: stages are positive, lie one after the other inside the calls, and
 * together they are all of the calls but for state saving and the like. How much that is depends on the machine's load,
 * so the best of some frames must be near: half would already be a wrong clock, not a slow day. */
static void test_sum(void **state) {
  (void)state;
  bench b;
  pn_info info;
  bench_open(&b);
  assert_ok(pn_context_info(b.s.context, &info));
  if (!info.software) {
    bench_close(&b);
    skip();
  }
  assert_ok(pn_timing(b.s.context, 1));
  frame(&b); /* compiles */
  assert_true(best_share(&b, 8) > 0.5);
  bench_close(&b);
}

static bool has_stage(const pn_time *times, int count, const char *name) {
  for (int i = 0; i < count; i++)
    if (!strcmp(times[i].stage, name)) return times[i].milliseconds > 0;
  return false;
}

static void test_stages(void **state) {
  (void)state;
  bench b;
  pn_time times[CAPACITY];
  bench_open(&b);
  assert_ok(pn_timing(b.s.context, 1));
  frame(&b);
  int count = pn_times(b.s.light, times, CAPACITY, 1);
  assert_true(count <= CAPACITY);
  assert_true(has_stage(times, count, "depth_map"));
  assert_true(has_stage(times, count, "range"));
  assert_true(has_stage(times, count, "visibility"));
  /* Asked for fewer, it still says how many there are, and writes no more than there is room for. */
  pn_time one[2] = {{"untouched", -1}, {"untouched", -1}};
  assert_int_equal(pn_times(b.s.light, one, 1, 0), count);
  assert_string_equal(one[1].stage, "untouched");
  assert_int_equal(pn_times(b.s.light, NULL, 0, 0), count);
  assert_int_equal(pn_times(NULL, times, CAPACITY, 0), 0);
  bench_close(&b);
}

/* ---- long frames ------------------------------------------------------------------------------------------------- */

/* Both sides, on eight layers of receivers, from a map with more texels than one list of micropatches takes: two marks
 * a list. */
static const char long_frame[] = "ssm:layers=8,sides=both,size=64";
enum { LONG_MAP = 1040 };

static int marks_of(const bench *b) {
  const pni_pair *pair = pni_pair_find(&b->s.light->object, &b->s.receiver->object);
  assert_non_null(pair);
  return pair->clock.frames[pair->clock.current].count;
}

/* None is left out, however many marks a frame has, and each stage is told once. */
static void check_stages(const bench *b) {
  static const char *const stages[] = {"fit",     "depth_map",  "range",     "receiver_map",
                                       "extents", "accumulate", "visibility"};
  enum { STAGES = sizeof stages / sizeof *stages };
  pn_time times[CAPACITY];
  int count = pn_times(b->s.light, times, CAPACITY, 1);
  assert_int_equal(count, STAGES);
  for (int k = 0; k < STAGES; k++) assert_true(has_stage(times, count, stages[k]));
  assert_true(marks_of(b) > 48);
}

static void test_long_frame(void **state) {
  (void)state;
  bench b;
  pn_info info;
  bench_open(&b);
  assert_ok(pn_light_technique(b.s.light, long_frame, NULL, 0));
  b.light.map_width = b.light.map_height = LONG_MAP;
  assert_ok(pn_light_set(b.s.light, &b.light));
  assert_ok(pn_timing(b.s.context, 1));
  frame(&b);
  check_stages(&b);
  assert_ok(pn_context_info(b.s.context, &info));
  if (info.software) assert_true(best_share(&b, 1) > 0.5);
  else frame(&b);
  check_stages(&b);
  bench_close(&b);
}

/* A short frame after a long one tells of itself alone. */
static void test_short_after_long(void **state) {
  (void)state;
  bench b;
  pn_time times[CAPACITY];
  bench_open(&b);
  assert_ok(pn_timing(b.s.context, 1));
  assert_ok(pn_light_technique(b.s.light, "ssm", NULL, 0));
  frame(&b);
  assert_ok(pn_light_technique(b.s.light, "hard", NULL, 0));
  frame(&b);
  int count = pn_times(b.s.light, times, CAPACITY, 1);
  assert_int_equal(count, 3); /* fit, depth_map, visibility */
  assert_false(has_stage(times, count, "accumulate"));
  bench_close(&b);
}

/* ---- the host's queries ------------------------------------------------------------------------------------------ */

/* Hosts may be in the middle of a query of their own. */
static void test_inside_a_query(void **state) {
  (void)state;
  bench b;
  GLuint query, passed = 0;
  bench_open(&b);
  assert_ok(pn_timing(b.s.context, 1));
  frame(&b);
  glGenQueries(1, &query);
  glBeginQuery(GL_SAMPLES_PASSED, query);
  frame(&b);
  glEndQuery(GL_SAMPLES_PASSED);
  glGetQueryObjectuiv(query, GL_QUERY_RESULT, &passed);
  glDeleteQueries(1, &query);
  bench_close(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_off_at_first),     cmocka_unit_test(test_sum),
                                     cmocka_unit_test(test_stages),           cmocka_unit_test(test_long_frame),
                                     cmocka_unit_test(test_short_after_long), cmocka_unit_test(test_inside_a_query)};
  return GL_RUN("clock", tests);
}
