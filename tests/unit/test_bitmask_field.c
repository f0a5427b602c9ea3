/* Bit fields over the light, run by GL, against sample points one by one in double. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "glsl_call.h"

/* ---- the samples, as field.glsl describes them ---- */

enum { KINDS = 4 };
static const struct {
  int code, grid;
  const char *name;
} kinds[KINDS] = {{8, 8, "8"}, {16, 16, "16"}, {17, 16, "16j"}, {32, 32, "32"}};

typedef struct {
  double x, y;
} point;

static point sample_at(int kind, int i, int j) {
  int n = kinds[kind].grid;
  if (kinds[kind].code != 17) return (point){(i + 0.5) / n, (j + 0.5) / n};
  return (point){(i + (j & 1 ? 0.25 : 0.75)) / n, (j + (i & 1 ? 0.75 : 0.25)) / n};
}

/* Words of several rows, in which a column's bits stand together, as field.glsl says. */
static int bit_at(int kind, const uint32_t *words, int i, int j) {
  int rows = 32 / kinds[kind].grid, bit = rows * i + j % rows;
  if (kinds[kind].code == 17) bit = 4 * (i / 2) + 2 * (j % 2) + i % 2;
  return words[j / rows] >> bit & 1;
}

static int words_of(int kind) { return kinds[kind].grid * kinds[kind].grid / 32; }

/* ---- running ---- */

static stage s;

static uint32_t *run(int kind, const char *text, const float *inputs, int vectors, int count) {
  static const char *const paths[] = {"shaders/precision.glsl", "techniques/bitmask/field.glsl", NULL};
  char defines[64], whole[2000];
  snprintf(defines, sizeof defines, "PN_SAMPLES %d\n", kinds[kind].code);
  snprintf(whole, sizeof whole,
           "void give(pn_Field f) { for (int i = 0; i < PN_WORDS; i++) results[i] = f.bits[i]; }\n"
           "uint noise(inout uint h) { h ^= h << 13u; h ^= h >> 17u; h ^= h << 5u; return h; }\n%s",
           text);
  stage_open(&s);
  uint32_t *out = glsl_call(&s, &(glsl_function){paths, defines, whole}, inputs, vectors, count);
  stage_close(&s);
  return out;
}

/* ---- rectangles ---- */

/* On, next to and far from sample coordinates. */
static float adversary(uint64_t *seed) {
  static const float far[] = {-INFINITY, -1e30f, -1, -0.0f, 0, 1e-30f, 0.5f, 1, 1.0000001f, 7, 1e30f, INFINITY};
  int i = (int)random_in(seed, 0, 12), place = (int)random_in(seed, -2, 132);
  float at = (float)place / 128;
  switch ((int)random_in(seed, 0, 5)) {
  case 0: return far[i];
  case 1: return nextafterf(at, -9);
  case 2: return nextafterf(at, 9);
  case 3: return at;
  default: return (float)random_in(seed, -0.2, 1.2);
  }
}

/* Multiplying by the grid's size and taking off an offset below 1 are exact where it matters, so every bit must be
 * right. */
static void test_rectangles(void **state) {
  (void)state;
  enum { COUNT = 8192 };
  static float in[COUNT][4];
  for (int kind = 0; kind < KINDS; kind++) {
    uint64_t seed = 5;
    int covered = 0;
    for (int k = 0; k < COUNT; k++)
      for (int c = 0; c < 4; c++) in[k][c] = adversary(&seed);
    uint32_t *out = run(kind, "void call() { vec4 r = taken(0); give(pn_rectangle(r.xy, r.zw)); }", in[0], 1, COUNT);
    for (int k = 0; k < COUNT; k++) {
      const float *r = in[k];
      for (int j = 0; j < kinds[kind].grid; j++)
        for (int i = 0; i < kinds[kind].grid; i++) {
          point p = sample_at(kind, i, j);
          int want = p.x >= r[0] && p.x < r[2] && p.y >= r[1] && p.y < r[3], found = bit_at(kind, out + 32 * k, i, j);
          covered += want;
          if (found != want)
            fail_msg("%s: sample %d, %d is %d in [%.9g, %.9g) x [%.9g, %.9g)", kinds[kind].name, i, j, found, r[0],
                     r[2], r[1], r[3]);
        }
      for (int w = words_of(kind); w < 32; w++) assert_int_equal(out[32 * k + w], 0);
    }
    assert_true(covered > COUNT);
    free(out);
  }
}

/* Section 3: an 8 x 8 tiling of the rotated grid of 2 x 2 points: each row and each column of a tile's 4 x 4 cells is
 * hit once. */
static void test_rotated_grid(void **state) {
  (void)state;
  enum { SIDE = 32 };
  static float in[SIDE * SIDE][4];
  int rows[8][SIDE] = {{0}}, columns[SIDE][8] = {{0}}, each[256] = {0};
  for (int k = 0; k < SIDE * SIDE; k++)
    for (int c = 0; c < 4; c++) in[k][c] = (float)((c & 1 ? k / SIDE : k % SIDE) + c / 2) / SIDE;
  uint32_t *out = run(2, "void call() { vec4 r = taken(0); give(pn_rectangle(r.xy, r.zw)); }", in[0], 1, SIDE * SIDE);
  for (int k = 0; k < SIDE * SIDE; k++)
    for (int bit = 0; bit < 256; bit++) {
      if (!(out[32 * k + bit / 32] >> (bit % 32) & 1)) continue;
      each[bit]++;
      rows[k % SIDE / 4][k / SIDE]++;
      columns[k % SIDE][k / SIDE / 4]++;
    }
  for (int bit = 0; bit < 256; bit++) assert_int_equal(each[bit], 1);
  for (int tile = 0; tile < 8; tile++)
    for (int line = 0; line < SIDE; line++) assert_true(rows[tile][line] == 1 && columns[line][tile] == 1);
  free(out);
}

/* ---- triangles ---- */

static const char triangle_text[] = "void call() { pn_Field f = pn_field_empty(); vec4 a = taken(0), b = taken(1); "
                                    "pn_add_triangle(f, a.xy, a.zw, b.xy); give(f); }";

/* -1 outside, 1 inside, 0 too near to an edge to say: crossings of a row are wrong by six roundings of numbers up to
 * `size`. */
static int side_of(const point *corners, int count, point p, double size) {
  int crossings = 0;
  for (int i = 0; i < count; i++) {
    point a = corners[i], b = corners[(i + 1) % count];
    if ((a.y <= p.y) == (b.y <= p.y)) continue;
    double x = a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
    if (fabs(x - p.x) <= 8 * 0x1p-24 * size) return 0;
    crossings += x > p.x;
  }
  return crossings & 1 ? 1 : -1;
}

static float coordinate(uint64_t *seed, int round, double *size) {
  *size = round % 4 == 3 ? 100 : 4;
  if (round % 4 == 0) return (float)random_in(seed, -0.3, 1.3);
  if (round % 4 == 1) return (float)(int)random_in(seed, -8, 72) / 64; /* on sample rows and columns */
  if (round % 4 == 2) return (float)(0.5 + 0.03 * random_in(seed, -1, 1));
  return (float)random_in(seed, -20, 20);
}

static void test_triangles(void **state) {
  (void)state;
  enum { COUNT = 4096 };
  static float in[COUNT][8];
  for (int kind = 0; kind < KINDS; kind++) {
    uint64_t seed = 6;
    double size;
    int inside = 0, unclear = 0;
    for (int k = 0; k < COUNT; k++) {
      for (int c = 0; c < 8; c++) in[k][c] = coordinate(&seed, k, &size);
      if (k % 16 == 5) memcpy(in[k] + 4, in[k], 8);    /* two corners in one */
      if (k % 16 == 6) in[k][1] = in[k][3];            /* a level edge */
      if (k % 16 == 7) in[k][1] = in[k][3] = in[k][5]; /* flat */
      if (k % 16 == 8) in[k][4] = 0.5f * (in[k][0] + in[k][2]), in[k][5] = 0.5f * (in[k][1] + in[k][3]);
    }
    uint32_t *out = run(kind, triangle_text, in[0], 2, COUNT);
    for (int k = 0; k < COUNT; k++) {
      point corners[3];
      coordinate(&seed, k, &size);
      for (int c = 0; c < 3; c++) corners[c] = (point){in[k][2 * c], in[k][2 * c + 1]};
      for (int j = 0; j < kinds[kind].grid; j++)
        for (int i = 0; i < kinds[kind].grid; i++) {
          int side = side_of(corners, 3, sample_at(kind, i, j), size), found = bit_at(kind, out + 32 * k, i, j);
          inside += side > 0;
          unclear += side == 0;
          if (side && found != (side > 0))
            fail_msg("%s: sample %d, %d is %d in the triangle (%.9g, %.9g) (%.9g, %.9g) (%.9g, %.9g)", kinds[kind].name,
                     i, j, found, corners[0].x, corners[0].y, corners[1].x, corners[1].y, corners[2].x, corners[2].y);
        }
    }
    print_message("%s: %d inside, %d unclear\n", kinds[kind].name, inside, unclear);
    assert_true(inside > 2 * COUNT && unclear < inside / 20);
    free(out);
  }
}

/* A mesh over the whole light, its inner corners moved about, some onto samples: every sample lies in one triangle,
 * never in none or two. */
static void test_meshes(void **state) {
  (void)state;
  enum { CELLS = 5, MESHES = 60, EACH = CELLS * CELLS * 2 };
  static float in[MESHES * EACH][8];
  for (int kind = 0; kind < KINDS; kind++) {
    uint64_t seed = 7;
    for (int m = 0; m < MESHES; m++) {
      float at[CELLS + 1][CELLS + 1][2];
      for (int j = 0; j <= CELLS; j++)
        for (int i = 0; i <= CELLS; i++)
          for (int c = 0; c < 2; c++) {
            int place = c ? j : i;
            double moved =
                (place + (place > 0 && place < CELLS ? random_in(&seed, -0.24, 0.24) : 0)) / CELLS * 1.2 - 0.1;
            at[j][i][c] = (float)(m & 1 ? round(moved * 64) / 64 : moved);
          }
      for (int k = 0; k < EACH; k++) {
        int i = k / 2 % CELLS, j = k / 2 / CELLS, flip = (m >> 1) & 1;
        const float *corner[4] = {at[j][i], at[j][i + 1], at[j + 1][i], at[j + 1][i + 1]};
        static const int cut[2][2][3] = {{{0, 1, 2}, {1, 3, 2}}, {{3, 0, 1}, {0, 3, 2}}};
        for (int c = 0; c < 3; c++) memcpy(in[m * EACH + k] + 2 * c, corner[cut[flip][k & 1][c]], 8);
      }
    }
    uint32_t *out = run(kind, triangle_text, in[0], 2, MESHES * EACH);
    for (int m = 0; m < MESHES; m++)
      for (int j = 0; j < kinds[kind].grid; j++)
        for (int i = 0; i < kinds[kind].grid; i++) {
          int times = 0;
          for (int k = 0; k < EACH; k++) times += bit_at(kind, out + 32 * (m * EACH + k), i, j);
          if (times != 1) fail_msg("%s: mesh %d covers sample %d, %d %d times", kinds[kind].name, m, i, j, times);
        }
    free(out);
  }
}

/* ---- counting, horizon ---- */

static void test_count(void **state) {
  (void)state;
  enum { COUNT = 1024 };
  static float in[COUNT][4];
  for (int k = 0; k < COUNT; k++) in[k][0] = (float)(k + 1);
  for (int kind = 0; kind < KINDS; kind++) {
    /* The field is given back where it leaves a word free; 32 x 32 is made again here. */
    uint32_t *out = run(kind,
                        "void call() { uint h = uint(taken(0).x) * 2654435761u; pn_Field f = pn_field_empty();\n"
                        "  for (int i = 0; i < PN_WORDS; i++) for (int c = 0; c < (PN_GRID == 8 ? 2 : 4); c++)\n"
                        "    f.bits[i][c] = uint(taken(0).x) % 7u == 0u ? 0xffffffffu : noise(h) & noise(h);\n"
                        "  give(f); results[7].w ^= floatBitsToUint(pn_field_count(f)); }",
                        in[0], 1, COUNT);
    for (int k = 0; k < COUNT; k++) {
      uint32_t h = (uint32_t)(k + 1) * 2654435761u, last = 0;
      int want = 0;
      for (int w = 0; w < words_of(kind); w++) {
        uint32_t word = 0xffffffffu;
        for (int turn = 0; turn < 2 && (k + 1) % 7; turn++) {
          h ^= h << 13;
          h ^= h >> 17;
          h ^= h << 5;
          word &= h;
        }
        for (int bit = 0; bit < 32; bit++) want += word >> bit & 1;
        if (w == 31) last = word;
      }
      assert_true(as_float(out[32 * k + 31] ^ last) == (float)want);
    }
    free(out);
  }
}

/* Above: extent u v, normal n_u n_v, k; the light's point (x, y) = (2 p - 1) extent is above where n . (x, y) > k. */
static void test_horizon(void **state) {
  (void)state;
  enum { COUNT = 2048 };
  static float in[COUNT][8];
  uint64_t seed = 8;
  for (int k = 0; k < COUNT; k++) {
    for (int c = 0; c < 2; c++) in[k][c] = (float)exp2(random_in(&seed, -6, 3));
    for (int c = 2; c < 4; c++) in[k][c] = k % 5 == c ? 0 : (float)random_in(&seed, -1, 1);
    in[k][4] = (float)random_in(&seed, -1.2, 1.2) * (fabsf(in[k][0] * in[k][2]) + fabsf(in[k][1] * in[k][3]));
    if (k % 7 == 0) in[k][4] = 0;
  }
  for (int kind = 0; kind < KINDS; kind++) {
    uint32_t *out =
        run(kind, "void call() { give(pn_field_horizon(taken(0).xy, taken(0).zw, taken(1).x)); }", in[0], 2, COUNT);
    int above = 0, below = 0;
    for (int k = 0; k < COUNT; k++) {
      const float *a = in[k];
      double size = fabs(a[0] * a[2]) + fabs(a[1] * a[3]) + fabs(a[4]);
      for (int j = 0; j < kinds[kind].grid; j++)
        for (int i = 0; i < kinds[kind].grid; i++) {
          point p = sample_at(kind, i, j);
          double h = (2 * p.x - 1) * (double)a[0] * a[2] + (2 * p.y - 1) * (double)a[1] * a[3] - a[4];
          if (fabs(h) <= 12 * 0x1p-24 * size) continue;
          assert_int_equal(bit_at(kind, out + 32 * k, i, j), h > 0);
          above += h > 0;
          below += h < 0;
        }
    }
    assert_true(above > 10 * COUNT && below > 10 * COUNT);
    free(out);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_rectangles), cmocka_unit_test(test_rotated_grid),
                                     cmocka_unit_test(test_triangles),  cmocka_unit_test(test_meshes),
                                     cmocka_unit_test(test_count),      cmocka_unit_test(test_horizon)};
  return GL_RUN("bit fields", tests);
}
