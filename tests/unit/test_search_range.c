/* What narrows a search's window: whatever keeps the ranges, that of a window holds every texel of it; the range
 * stack's single sample is one of the smallest neighbourhoods that cover the window, and its four samples see no more
 * than the window (Bitmask Soft Shadows, section 5). All windows of some maps, against the texels. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "glsl_call.h"
#include "light.h"

enum { MAP_MOST = 40, WINDOWS = 6000 };

typedef struct {
  float most, least;
} range;

typedef struct {
  int width, height;
  float *texels; /* largest and smallest w of each */
} map;

/* Texels from low to high, both included, of those that there are. */
static range range_of(const map *m, int x0, int y0, int x1, int y1) {
  range r = {-1e30f, 1e30f};
  for (int y = y0 < 0 ? 0 : y0; y <= y1 && y < m->height; y++)
    for (int x = x0 < 0 ? 0 : x0; x <= x1 && x < m->width; x++) {
      r.most = fmaxf(r.most, m->texels[2 * (y * m->width + x)]);
      r.least = fminf(r.least, m->texels[2 * (y * m->width + x) + 1]);
    }
  return r;
}

static int larger(int a, int b) { return a > b ? a : b; }
static int smaller(int a, int b) { return a < b ? a : b; }

/* Whether that is the range of a neighbourhood of size x size texels around a texel of the map, half of it before the
 * texel, which covers the window. */
static bool is_neighbourhood(const map *m, const int w[4], int size, range found) {
  int last_x = smaller(w[0] + size / 2, m->width - 1), last_y = smaller(w[1] + size / 2, m->height - 1);
  for (int y = larger(w[3] + size / 2 - size + 1, 0); y <= last_y; y++)
    for (int x = larger(w[2] + size / 2 - size + 1, 0); x <= last_x; x++) {
      int x0 = x - size / 2, y0 = y - size / 2;
      range r = range_of(m, x0, y0, x0 + size - 1, y0 + size - 1);
      if (r.most == found.most && r.least == found.least) return true;
    }
  return false;
}

static int size_for(int texels) {
  int size = 1;
  while (size < texels) size *= 2;
  return size;
}

static void check_window(const map *m, const char *hierarchy, const int w[4], range one, range four) {
  range truth = range_of(m, w[0], w[1], w[2], w[3]);
  int across = w[2] - w[0] + 1, up = w[3] - w[1] + 1, size = size_for(larger(across, up)),
      quarter = size_for((larger(across, up) + 1) / 2);
  if (one.most < truth.most || one.least > truth.least || four.most < truth.most || four.least > truth.least)
    fail_msg("%s, window %d..%d x %d..%d: a texel is left out", hierarchy, w[0], w[2], w[1], w[3]);
  if (strcmp(hierarchy, "mssm") != 0) return;
  if (!is_neighbourhood(m, w, size, one))
    fail_msg("window %d..%d x %d..%d: not the range of any %d x %d texels around it", w[0], w[2], w[1], w[3], size,
             size);
  if (smaller(across, up) >= quarter && (four.most != truth.most || four.least != truth.least))
    fail_msg("window %d..%d x %d..%d: four samples see more", w[0], w[2], w[1], w[3]);
}

static GLuint bind_maps(const stage *s) {
  GLuint buffer;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_UNIFORM_BUFFER, buffer);
  glBufferData(GL_UNIFORM_BUFFER, sizeof s->light->maps.block, &s->light->maps.block, GL_STATIC_DRAW);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, buffer);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D_ARRAY, s->light->maps.depth.id);
  glActiveTexture(GL_TEXTURE0 + 1);
  glBindTexture(GL_TEXTURE_2D_ARRAY, s->light->maps.range.id);
  return buffer;
}

static uint32_t *window_ranges(stage *s, const float *windows, int layer) {
  static const char *const paths[] = {"shaders/precision.glsl", "gather/channels.glsl",
                                      "techniques/bitmask/bitmask.glsl", NULL};
  char defines[PNI_TECHNIQUE_DEFINES], text[600];
  pni_gather_defines(&s->light->technique->gathering, &s->light->technique->table, s->light->values, defines);
  snprintf(text, sizeof text,
           "void call() {\n"
           "  ivec4 w = ivec4(taken(0));\n"
           "  vec4 one = pn_window_range(0, pn_range, 0, %d, w.xy, w.zw, false);\n"
           "  vec4 four = pn_window_range(0, pn_range, 0, %d, w.xy, w.zw, true);\n"
           "  results[0] = floatBitsToUint(vec4(one.xy, four.xy));\n"
           "}",
           layer, layer);
  GLuint buffer = bind_maps(s);
  uint32_t *out = glsl_call(s, &(glsl_function){paths, defines, text}, windows, 1, WINDOWS);
  glDeleteBuffers(1, &buffer);
  return out;
}

static void fill(const map *m, float *windows) {
  uint64_t seed = 3;
  for (int i = 0; i < WINDOWS; i++) {
    float *w = windows + 4 * i;
    int most = larger(m->width, m->height), across = 1 + (int)random_in(&seed, 0, most),
        up = i % 3 ? across : 1 + (int)random_in(&seed, 0, most);
    across = smaller(across, m->width);
    up = smaller(up, m->height);
    w[0] = floorf((float)random_in(&seed, 0, m->width - across + 1));
    w[1] = floorf((float)random_in(&seed, 0, m->height - up + 1));
    w[2] = w[0] + (float)(across - 1);
    w[3] = w[1] + (float)(up - 1);
  }
}

static void check_map(const char *hierarchy, const char *primitive, int width, int height) {
  stage s;
  soup leaves = {0};
  uint64_t seed = 9;
  char spec[120];
  stage_open(&s);
  for (int i = 0; i < 60; i++) {
    vec at = v3(random_in(&seed, -3, 3), random_in(&seed, -5, -3), random_in(&seed, -3, 3));
    soup_patch(&leaves, at, mul(0.4, random_direction(&seed)), mul(0.4, random_direction(&seed)));
  }
  stage_cast(&s, &leaves);
  pn_light_desc light = light_at(v3(0, 0, 0), v3(0, -1, 0), 0.5, 0.5, width);
  light.map_height = height;
  snprintf(spec, sizeof spec, "bitmask:merge=0,primitive=%s,hierarchy=%s", primitive, hierarchy);
  assert_ok(pn_light_technique(s.light, spec, NULL, 0));
  assert_ok(pn_light_set(s.light, &light));
  assert_ok(pn_maps_update(s.light, s.casters, PN_GROUPS_ALL, NULL, 0));
  const pni_maps *maps = &s.light->maps;
  assert_int_equal(maps->block.map_count, 1);
  int levels = maps->range.layers / maps->depth.layers;
  map m = {width, height, NULL};
  static float windows[WINDOWS][4];
  fill(&m, windows[0]);
  for (int layer = 0; layer < 2; layer++) {
    m.texels = gl_read_texture(maps->range.id, 0, layer * levels, width, height, 2);
    uint32_t *out = window_ranges(&s, windows[0], layer);
    for (int i = 0; i < WINDOWS; i++) {
      const int w[4] = {(int)windows[i][0], (int)windows[i][1], (int)windows[i][2], (int)windows[i][3]};
      const uint32_t *o = out + 32 * i;
      check_window(&m, hierarchy, w, (range){as_float(o[0]), as_float(o[1])}, (range){as_float(o[2]), as_float(o[3])});
    }
    free(out);
    free(m.texels);
  }
  soup_free(&leaves);
  stage_close(&s);
}

static void check(const char *hierarchy) {
  static const int sizes[][2] = {{16, 16}, {MAP_MOST, MAP_MOST}, {17, 5}, {3, 31}, {1, 1}};
  for (int k = 0; k < 5; k++) check_map(hierarchy, k & 1 ? "patch" : "quad", sizes[k][0], sizes[k][1]);
}

static void test_pyramid(void **state) {
  (void)state;
  check("hsm");
}

static void test_hybrid(void **state) {
  (void)state;
  check("hybrid");
}

static void test_stack(void **state) {
  (void)state;
  check("mssm");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_pyramid), cmocka_unit_test(test_stack),
                                     cmocka_unit_test(test_hybrid)};
  return GL_RUN("ranges of windows", tests);
}
