/* Rasterisers are farther off than depth's precision where they cut huge triangles: single pixels lie beside a surface
 * that is straight around them. Such a pixel of a lit plane, within the view or at its border, is lit like those around
 * it; and a real step is no such pixel. */
#include <stdlib.h>

#include "stage.h"

enum { SIZE = 64 };
static const double height = 2;

typedef struct {
  stage s;
  soup plane;
  view v;
  float *depths; /* as drawn */
} scene;

static void open_scene(scene *c) {
  *c = (scene){0};
  soup_patch(&c->plane, v3(0, 0, 0), v3(3, 0, 0), v3(0, 0, 3));
  camera k = {.width = SIZE,
              .height = SIZE,
              .eye = v3(0.3, 1.2, 2.1),
              .target = v3(0, 0, 0),
              .up = v3(0, 1, 0),
              .half_height = 0.25,
              .near = 0.1,
              .far = 30};
  view_draw(&c->v, &k, &c->plane);
  stage_open(&c->s);
  stage_cast(&c->s, &c->plane);
  c->depths = gl_read_depth(c->v.depth, -1, SIZE, SIZE);
}

static void close_scene(scene *c) {
  free(c->depths);
  stage_close(&c->s);
  view_free(&c->v);
  soup_free(&c->plane);
}

/* Visibility with every tenth pixel of every sixth row, and of the view's borders, farther by so many steps of
 * depth. */
static float *look(scene *c, int steps) {
  float *depths = malloc((size_t)(SIZE * SIZE) * sizeof *depths);
  assert_non_null(depths);
  for (int i = 0; i < SIZE * SIZE; i++) {
    int x = i % SIZE, y = i / SIZE;
    bool border = x == 0 || y == 0 || x == SIZE - 1 || y == SIZE - 1;
    bool astray =
        border ? (x + y) % 10 == 5 : x > 5 && y > 5 && x < SIZE - 6 && y < SIZE - 6 && y % 6 == 3 && x % 10 == 4;
    depths[i] = c->depths[i] + (astray ? (float)(steps * 0x1p-24) : 0.0f);
  }
  GLuint texture;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, SIZE, SIZE, 0, GL_DEPTH_COMPONENT, GL_FLOAT, depths);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  free(depths);
  pn_receiver_desc desc = view_desc(&c->v, true);
  desc.depth_texture = texture;
  assert_ok(pn_receiver_set(c->s.receiver, &desc));
  pn_light_desc light = light_at(v3(0.5, height, 0), v3(0, -1, 0), 0.3, 0.3, 256);
  float *out = stage_visibility(&c->s, &light, "bitmask");
  glDeleteTextures(1, &texture);
  return out;
}

static int dark_pixels(scene *c, int steps) {
  float *visibility = look(c, steps);
  int dark = 0;
  for (int i = 0; i < SIZE * SIZE; i++) dark += visibility[i] < 1;
  free(visibility);
  return dark;
}

static void test_stray(void **state) {
  (void)state;
  scene c;
  open_scene(&c);
  for (int i = 0; i < SIZE * SIZE; i++) assert_true(c.v.shown[i] >= 0);
  static const int steps[] = {0, 10, 40, 160};
  for (int i = 0; i < 4; i++) {
    int dark = dark_pixels(&c, steps[i]);
    if (dark) fail_msg("farther by %d steps of depth: %d pixels are dark", steps[i], dark);
  }
  assert_true(dark_pixels(&c, 40000) > 50); /* that far below the plane it is in its shadow */
  close_scene(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_stray)};
  return GL_RUN("depth that strays", tests);
}
