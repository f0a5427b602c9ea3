/* cap: no more primitives along an axis of a pixel's window than it says, in each layer, whatever narrows the window
 * and wherever it begins on the grid; and where there is no cap, the host is told that large windows are searched in
 * blocks all the same. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "over_ground.h"

enum { SIDE = 40 };

static void open_leaves(over_ground *c) {
  uint64_t seed = 4;
  for (int i = 0; i < 40; i++) {
    vec at = v3(random_in(&seed, -1, 1), random_in(&seed, 0.5, 1.5), random_in(&seed, -1, 1));
    soup_patch(&c->casters, at, mul(0.2, random_direction(&seed)), mul(0.2, random_direction(&seed)));
  }
  over_ground_open(c, SIDE, 1);
}

/* Most blocks that a pixel visited. */
static int most_visited(over_ground *c, const pn_light_desc *light, const char *spec) {
  free(stage_visibility(&c->s, light, spec));
  pn_image image;
  const char *name;
  float most = 0;
  for (int i = 0; pn_debug_image(c->s.light, c->s.receiver, i, &name, &image); i++) {
    if (strcmp(name, "search") != 0) continue;
    float *search = gl_read_texture(image.texture, 0, -1, image.width, image.height, 4);
    for (int k = 0; k < image.width * image.height; k++) most = fmaxf(most, search[4 * k + 1]);
    free(search);
  }
  return (int)most;
}

static void test_cap(void **state) {
  (void)state;
  static const char *const hierarchies[] = {"none", "hsm", "mssm", "hybrid"}, *const primitives[] = {"patch", "quad"};
  static const int caps[] = {1, 2, 3, 7, 18, 19};
  over_ground c = {0};
  open_leaves(&c);
  assert_ok(pn_debug(c.s.context, PN_DEBUG_SEARCH));
  pn_light_desc light = light_over_ground(0.7, 0.5, 100);
  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 6; k++) {
      /* A quad needs two blocks. */
      int cap = caps[k], allowed = i % 2 && cap == 1 ? 2 : cap;
      char spec[120];
      snprintf(spec, sizeof spec, "bitmask:merge=0,primitive=%s,hierarchy=%s,cap=%d", primitives[i % 2],
               hierarchies[i / 2], cap);
      int most = most_visited(&c, &light, spec);
      if (most == 0 || most > 2 * allowed * allowed) fail_msg("%s: %d blocks of two maps", spec, most);
    }
  over_ground_close(&c);
}

static void test_told(void **state) {
  (void)state;
  over_ground c = {0};
  open_leaves(&c);
  const struct {
    const char *spec;
    int map, told;
  } cases[] = {{"bitmask:merge=0,cap=18", 600, 0}, {"bitmask:merge=0", 400, 0}, {"bitmask", 600, 0},
               {"bitmask:merge=0", 600, 1},        {"bitmask:merge=0", 600, 0}, {"backprojection:merge=0", 640, 1}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    pn_light_desc light = light_over_ground(0.01, 0.01, cases[i].map);
    int before = c.s.messages[PN_MESSAGE_SEARCH_COARSER];
    free(stage_visibility(&c.s, &light, cases[i].spec));
    assert_int_equal(c.s.messages[PN_MESSAGE_SEARCH_COARSER] - before, cases[i].told);
  }
  over_ground_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_cap), cmocka_unit_test(test_told)};
  return GL_RUN("cap", tests);
}
