/* Soft shadow maps: lists of micropatches from GPU and CPU, a plate's closed form, sums in 16 bits, the error's bound, and
 * scenes that ask for trouble. */
#include <stdlib.h>
#include <string.h>

#include "light.h"
#include "stage.h"
#include "techniques/ssm/ssm.h"

/* The light looks down from (0, L, 0); u is x, v is -z. The ground y = 0 only receives, unless a test says so. */
static const double L = 4;
static const double half_u = 0.5, half_v = 0.3, plate = 0.6, plate_h = 1.5;

enum { SIZE = 48 };

typedef struct {
  stage s;
  view v;
  soup ground, casters;
} scene;

static void scene_open(scene *c, double half_height) {
  camera k = {.width = SIZE, .height = SIZE, .eye = v3(0.013, 10, 0.007), .target = v3(0.013, 0, 0.007), .up = v3(0, 0, -1),
              .orthographic = true, .half_height = half_height, .near = 1, .far = 20};
  soup_patch(&c->ground, v3(0, 0, 0), v3(9, 0, 0), v3(0, 0, 9));
  view_draw(&c->v, &k, &c->ground);
  stage_open(&c->s);
  if (c->casters.count) stage_cast(&c->s, &c->casters);
  stage_receive(&c->s, &c->v, true);
}

static void scene_close(scene *c) {
  stage_close(&c->s);
  view_free(&c->v);
  soup_free(&c->ground);
  soup_free(&c->casters);
}

static pn_light_desc light_above(int map) { return light_at(v3(0, L, 0), v3(0, -1, 0), half_u, half_v, map); }

static void add_plate(scene *c) { soup_patch(&c->casters, v3(0, plate_h, 0), v3(plate, 0, 0), v3(0, 0, plate)); }

/* Boxes at several heights, and a tilted plate: blocks that merge and blocks that do not. */
static void add_clutter(scene *c) {
  add_plate(c);
  soup_box(&c->casters, v3(-1.2, 0.3, -1), v3(-0.8, 1.1, -0.2));
  soup_quad(&c->casters, v3(0.7, 0.4, -0.8), v3(0.5, 0.5, 0), v3(0, 0.2, 1.1));
}

/* ---- lists ------------------------------------------------------------------------------------------------------- */

/* The list that the last draw left, of its last side and layer: 8 floats an entry. */
static float *read_list(pn_pair *pair, int count) {
  float *out = malloc((size_t)(count ? count : 1) * 8 * sizeof *out);
  for (int half = 0; half < 2; half++) {
    const pn_texture *t = &pair->work[SSM_LIST + half];
    float *texels = gl_read_texture(t->id, 0, -1, t->width, t->height, 4);
    for (int i = 0; i < count; i++) memcpy(out + 8 * i + 4 * half, texels + 4 * i, 4 * sizeof *out);
    free(texels);
  }
  return out;
}

static int gpu_total(scene *c, pn_pair *pair) {
  const pn_texture *t = &pair->work[SSM_COUNTS];
  GLuint top[4] = {0};
  (void)c;
  glBindTexture(GL_TEXTURE_2D, t->id);
  glGetTexImage(GL_TEXTURE_2D, t->levels - 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, top);
  return (int)top[0];
}

/* The same patches in the same order. What they serve follows from float arithmetic that two compilers may order
 * differently, and the farthest receiver in reach from one comparison with a texel's border: both to a part in 10^5. */
static void check_lists(const char *spec, int map) {
  scene c = {0};
  add_clutter(&c);
  scene_open(&c, 2.2);
  pn_light_desc light = light_above(map);
  free(stage_visibility(&c.s, &light, spec));
  pn_pair *pair = pn_pair_find(&c.s.light->object, &c.s.receiver->object);
  assert_non_null(pair);
  int count = gpu_total(&c, pair), cpu_count;
  float *gpu = read_list(pair, count), *cpu;
  pn_visibility_request request = {.gpu = &c.s.context->gpu, .maps = &c.s.light->maps, .pair = pair};
  ssm_list list = {.request = &request, .layer = c.s.light->maps.layers - 1, .share = c.s.light->values[4] / 100};
  assert_ok(ssm_cpu_list(&list, &cpu, &cpu_count));
  print_message("%s, %d: %d and %d patches\n", spec, map, count, cpu_count);
  assert_true(count > 0);
  int different = 0;
  for (int i = 0; i < count && i < cpu_count; i++)
    for (int k = 0; k < 7; k++) different += fabs(gpu[8 * i + k] - cpu[8 * i + k]) > 1e-5 * fabs(cpu[8 * i + k]);
  assert_int_equal(count, cpu_count);
  assert_true(different <= count / 1000);
  free(gpu);
  pn_free(&c.s.context->gpu, cpu);
  scene_close(&c);
}

static void gpu_and_cpu_lists_agree(void **state) {
  (void)state;
  check_lists("ssm:merge=0,layers=1,sides=front", 64);
  check_lists("ssm:merge=0,layers=1", 61);
  check_lists("ssm:merge=1,layers=1,sides=front", 128);
  check_lists("ssm:merge=5,layers=1,size=50", 128);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(gpu_and_cpu_lists_agree),
  };
  return GL_RUN("ssm", tests);
}
