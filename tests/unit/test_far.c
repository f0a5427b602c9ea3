/* What floats lose far from the origin: the bounds hold against the very operations in floats, and meshes in memory
 * lose nothing. */
#include <stdlib.h>
#include <string.h>

#include "casters/casters.h"
#include "casters/rounding.h"
#include "maps/origin.h"
#include "stage.h"

#include "context.h"

/* ---- bounds ------------------------------------------------------------------------------------------------------ */

/* As a vertex shader computes a row: from left to right, no product fused. */
static float float_row(const float m[16], int row, const float p[3]) {
  volatile float sum = m[row] * p[0], term = m[4 + row] * p[1];
  sum = sum + term;
  term = m[8 + row] * p[2];
  sum = sum + term;
  return sum + m[12 + row];
}

static double double_row(const pni_matrix *m, int row, const float p[3]) {
  return m->m[row] * p[0] + m->m[4 + row] * p[1] + m->m[8 + row] * p[2] + m->m[12 + row];
}

static double random_size(uint64_t *seed) { return pow(10, random_in(seed, -3, 6)); }

/* A rotation, scaled, that takes a middle far away to a place near by, or not. */
static pni_matrix random_transform(uint64_t *seed, vec middle) {
  vec z = random_direction(seed), x = unit(cross(z, random_direction(seed))), y = cross(z, x);
  double scale = pow(10, random_in(seed, -1, 1));
  pni_matrix out = {{scale * x.x, scale * x.y, scale * x.z, 0, scale * y.x, scale * y.y, scale * y.z, 0, scale * z.x,
                     scale * z.y, scale * z.z, 0, 0, 0, 0, 1}};
  const double at[3] = {middle.x, middle.y, middle.z};
  double moved[3];
  pni_matrix_point(&out, at, moved);
  double share = random_bits(seed) % 3 == 0 ? 0 : 1, near = random_size(seed);
  for (int i = 0; i < 3; i++) out.m[12 + i] = random_in(seed, -near, near) - share * moved[i];
  return out;
}

/* What the library adds for a far box, and what the same box around its middle has anyway, bound what is lost. */
static void test_box(void **state) {
  (void)state;
  uint64_t seed = 3;
  double tightest = INFINITY;
  for (int round = 0; round < TEST_ROUNDS(4000); round++) {
    double size = random_size(&seed);
    vec middle = random_point(&seed, random_size(&seed));
    const double at[3] = {middle.x, middle.y, middle.z};
    pni_matrix matrix = random_transform(&seed, middle);
    float floats[16], low[3], high[3];
    double lost[3];
    pni_matrix_to_floats(&matrix, floats);
    for (int i = 0; i < 3; i++) {
      low[i] = (float)(at[i] - size);
      high[i] = (float)(at[i] + random_in(&seed, 0, size));
    }
    pni_box_rounding(&matrix, low, high, lost);
    for (int row = 0; row < 3; row++) {
      double half = 0, centre = matrix.m[12 + row];
      for (int i = 0; i < 3; i++) {
        bool away = (double)high[i] - low[i] <= 0.5 * fmax(fabs(high[i]), fabs(low[i]));
        double from = away ? 0.5 * ((double)high[i] + low[i]) : 0;
        half += fabs(matrix.m[4 * i + row]) * fmax(fabs(high[i] - from), fabs(low[i] - from));
        centre += matrix.m[4 * i + row] * from;
      }
      double bound = lost[row] + 5 * 0x1p-24 * (half + fabs(centre)), worst = 0;
      for (int k = 0; k < 8; k++) {
        float p[3];
        for (int i = 0; i < 3; i++) p[i] = (float)random_in(&seed, low[i], high[i]);
        worst = fmax(worst, fabs(float_row(floats, row, p) - double_row(&matrix, row, p)));
      }
      assert_true(worst <= bound);
      if (worst > 0) tightest = fmin(tightest, bound / worst);
    }
  }
  assert_true(tightest < 4); /* a bound, not a guess: some are that near to it */
}

/* A box around its own origin loses nothing on top, wherever the transform takes it. */
static void test_box_at_home(void **state) {
  (void)state;
  static const float low[3] = {-1, -2, -3}, high[3] = {1, 2, 3};
  uint64_t seed = 4;
  for (int round = 0; round < 100; round++) {
    pni_matrix matrix = random_transform(&seed, v3(0, 0, 0));
    double lost[3];
    pni_box_rounding(&matrix, low, high, lost);
    for (int i = 0; i < 3; i++) assert_true(lost[i] <= 1e-15 * 1e8);
  }
}

/* Scene position in floats, then eye position in floats, as a host does it that has both matrices. */
static void test_view(void **state) {
  (void)state;
  uint64_t seed = 5;
  double tightest = INFINITY;
  for (int round = 0; round < TEST_ROUNDS(4000); round++) {
    double away = random_size(&seed);
    vec eye = random_point(&seed, away), z = random_direction(&seed), x = unit(cross(z, random_direction(&seed)));
    vec y = cross(z, x);
    pni_matrix exact = {
        {x.x, y.x, z.x, 0, x.y, y.y, z.y, 0, x.z, y.z, z.z, 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1}};
    float floats[16];
    const float p[3] = {(float)eye.x, (float)eye.y, (float)eye.z};
    pni_matrix_to_floats(&exact, floats);
    pni_matrix given = pni_matrix_from_floats(floats);
    double bound = pni_view_rounding(&given), squares = 0;
    for (int row = 0; row < 3; row++) {
      double error = float_row(floats, row, p) - double_row(&given, row, p);
      squares += error * error;
    }
    assert_true(sqrt(squares) <= bound);
    if (squares > 0) tightest = fmin(tightest, bound / sqrt(squares));
  }
  assert_true(tightest < 8);
}

static void test_view_at_home(void **state) {
  (void)state;
  pni_matrix one = pni_matrix_identity();
  assert_true(pni_view_rounding(&one) == 0);
  pni_matrix none = {{0}};
  assert_true(pni_view_rounding(&none) == 0);
}

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

enum { CORNERS = 12 };

static const pni_mesh_data *first_mesh(const stage *s) { return &s->casters->meshes[0]; }

static void read_vertices(const pni_mesh_data *mesh, float out[3 * CORNERS]) {
  glBindBuffer(GL_COPY_READ_BUFFER, mesh->own_positions.id);
  glGetBufferSubData(GL_COPY_READ_BUFFER, 0, 3 * CORNERS * sizeof *out, out);
  glBindBuffer(GL_COPY_READ_BUFFER, 0);
}

/* Middle plus vertex is the position that was given, to the last bit; and vertices are as small as the mesh, or as
 * near. */
static void assert_kept(const stage *s, const float positions[3 * CORNERS]) {
  float kept[3 * CORNERS];
  read_vertices(first_mesh(s), kept);
  for (int k = 0; k < 3; k++) {
    float low = positions[k], high = positions[k];
    for (int i = k; i < 3 * CORNERS; i += 3) {
      low = fminf(low, positions[i]);
      high = fmaxf(high, positions[i]);
    }
    for (int i = k; i < 3 * CORNERS; i += 3) {
      assert_true(first_mesh(s)->center[k] + kept[i] == positions[i]);
      assert_true(fabsf(kept[i]) <= 2 * (high - low));
    }
  }
  pni_matrix matrix = pni_from_vertex(first_mesh(s), &s->casters->instances[0].scene_from_object);
  for (int i = 0; i < CORNERS; i++) {
    const double vertex[3] = {kept[3 * i], kept[3 * i + 1], kept[3 * i + 2]};
    const double position[3] = {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
    double a[3], b[3];
    pni_matrix_point(&matrix, vertex, a);
    pni_matrix_point(&s->casters->instances[0].scene_from_object, position, b);
    for (int k = 0; k < 3; k++) assert_true(fabs(a[k] - b[k]) <= 0x1p-50 * 1e7);
  }
}

static void random_positions(uint64_t *seed, float out[3 * CORNERS]) {
  double size = random_in(seed, 0.5, 2);
  vec middle = random_point(seed, random_size(seed));
  for (int i = 0; i < CORNERS; i++) {
    vec p = add(middle, random_point(seed, size));
    out[3 * i] = (float)p.x, out[3 * i + 1] = (float)p.y, out[3 * i + 2] = (float)p.z;
  }
}

static void test_mesh(void **state) {
  (void)state;
  static const float place[16] = {0, 0, -2, 0, 0, 2, 0, 0, 2, 0, 0, 0, 1e6f, -1e6f, 3, 1};
  uint64_t seed = 6;
  for (int round = 0; round < 40; round++) {
    float positions[3 * CORNERS];
    random_positions(&seed, positions);
    stage s;
    stage_open(&s);
    pn_mesh mesh;
    pn_mesh_desc desc = {.positions = {.data = positions, .count = CORNERS}};
    assert_ok(pn_mesh_add(s.casters, &desc, &mesh));
    assert_ok(pn_instance_add(s.casters, mesh, place, 0, NULL));
    if (s.messages[PN_MESSAGE_MESH_DROPPED] == 0) assert_kept(&s, positions);
    /* deformed to somewhere else */
    random_positions(&seed, positions);
    pn_span span = {.data = positions, .count = CORNERS};
    assert_ok(pn_mesh_moved(s.casters, mesh, &span, NULL));
    if (s.messages[PN_MESSAGE_MESH_DROPPED] == 0) assert_kept(&s, positions);
    stage_close(&s);
  }
}

/* Of what is seen from its middle the map loses nothing, of the host's buffer it does; the host's depth both. */
static void test_casters(void **state) {
  (void)state;
  static const float positions[9] = {1000, 0, 0, 1001, 0, 0, 1000, 1, 0}, low[3] = {1000, 0, 0}, high[3] = {1001, 1, 0};
  static const float back[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1000, 0, 0, 1};
  pni_frame frame = {{0, 0, 5}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, PNI_CENTRAL};
  for (int in_buffer = 0; in_buffer < 2; in_buffer++) {
    stage s;
    stage_open(&s);
    GLuint buffer = 0;
    pn_mesh mesh;
    pn_mesh_desc desc = {.positions = {.data = positions, .count = 3}};
    if (in_buffer) {
      glGenBuffers(1, &buffer);
      glBindBuffer(GL_ARRAY_BUFFER, buffer);
      glBufferData(GL_ARRAY_BUFFER, sizeof positions, positions, GL_STATIC_DRAW);
      desc.positions = (pn_span){.buffer = buffer, .count = 3};
      memcpy(desc.bounds_min, low, sizeof low);
      memcpy(desc.bounds_max, high, sizeof high);
    }
    assert_ok(pn_mesh_add(s.casters, &desc, &mesh));
    assert_ok(pn_instance_add(s.casters, mesh, back, 0, NULL));
    pni_rounding rounding = pni_casters_rounding(s.casters, PN_GROUPS_ALL, &frame);
    /* 1001 and 1000 are multiplied and added, where a half around 0.5 would do: 2001 - 1 times 5 * 2^-24. */
    double expected = 5 * 0x1p-24 * 2000;
    assert_true(fabs(rounding.host - expected) < 1e-9);
    assert_true(fabs(rounding.map[0] - (in_buffer ? expected : 0)) < 1e-9 && rounding.map[1] < 1e-9);
    assert_true(pni_casters_rounding(s.casters, 0, &frame).host == 0);
    stage_close(&s);
    glDeleteBuffers(1, &buffer);
  }
}

/* ---- a sun's frame ----------------------------------------------------------------------------------------------- */

static void test_sun(void **state) {
  (void)state;
  static const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  stage s;
  stage_open(&s);
  pn_mesh mesh;
  pn_instance instance;
  pn_mesh_desc desc = {.positions = {.data = corners, .count = 3}};
  float place[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  assert_ok(pn_mesh_add(s.casters, &desc, &mesh));
  assert_ok(pn_instance_add(s.casters, mesh, place, 0, &instance));
  pni_frame sun = {{7, 7, 7}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, PNI_PARALLEL};
  double last = 0;
  int steps = 0;
  for (int i = 0; i <= 400; i++) {
    double x = i < 40 ? 0.25 * i : 1000 + 0.25 * i;
    place[12] = (float)x;
    assert_ok(pn_instance_move(s.casters, instance, place));
    pni_frame_place(&sun, s.casters, PN_GROUPS_ALL);
    if (i < 40) assert_true(sun.origin[0] == 0 && sun.origin[1] == 0); /* near enough */
    else assert_true(fabs(sun.origin[0] - x) <= 4); /* half a step of four extents, and half an extent */
    steps += i > 40 && sun.origin[0] != last;
    last = sun.origin[0];
  }
  assert_true(steps > 0 && steps <= 24); /* 90 units by steps of four */
  pni_frame rectangle = {{7, 7, 7}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, PNI_CENTRAL};
  pni_frame_place(&rectangle, s.casters, PN_GROUPS_ALL);
  assert_true(rectangle.origin[0] == 7);
  pni_frame_place(&sun, s.casters, 0); /* nothing casts */
  assert_true(sun.origin[0] == 0);
  stage_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_box),          cmocka_unit_test(test_box_at_home), cmocka_unit_test(test_view),
      cmocka_unit_test(test_view_at_home), cmocka_unit_test(test_mesh),        cmocka_unit_test(test_casters),
      cmocka_unit_test(test_sun),
  };
  return GL_RUN("far", tests);
}
