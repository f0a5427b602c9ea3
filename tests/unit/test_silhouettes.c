/* Silhouettes on the GPU against those in C, bit for bit, and both against the faces' normals in double. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "silhouettes/silhouettes.h"
#include "model.h"
#include "stage.h"

typedef struct {
  pn_context *context;
  pn_casters *casters;
  pni_gpu *gpu;
} bench;

static void open_bench(bench *b) {
  assert_ok(pn_context_create(NULL, &b->context));
  assert_ok(pn_casters_create(b->context, &b->casters));
  b->gpu = &b->context->gpu;
}

static float *gpu_sides(bench *b, pni_mesh_data *mesh, const pni_matrix *light_from_object, bool sun) {
  pni_mesh_edges *edges;
  pni_enter(b->context);
  assert_ok(pni_mesh_edges_get(b->gpu, mesh, &edges));
  assert_non_null(edges);
  assert_ok(pni_silhouettes_draw(b->gpu, edges, light_from_object, sun, 0.01f));
  float *sides = gl_read_texture(edges->sides.id, 0, -1, edges->sides.width, edges->sides.height, 1);
  assert_ok(pni_leave(b->context, PN_OK));
  return sides;
}

static double triple(const float *a, const float *b, const float *c, const double light[3]) {
  double u[3], v[3], w[3];
  for (int i = 0; i < 3; i++) {
    u[i] = (double)b[i] - a[i];
    v[i] = (double)c[i] - a[i];
    w[i] = light[i] - a[i];
  }
  return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] + (u[0] * v[1] - u[1] * v[0]) * w[2];
}

/* By the definition: one face looks at the light, the other away. Faces seen almost from their edge are left out, and
 * so are edges of one face, which are silhouettes in any case. For edges of consistently wound faces only. */
static void check_definition(const pni_edge_list *list, const float *points, const float *sides) {
  const double light[3] = {0, 0, 0};
  size_t checked = 0;
  for (size_t i = 0; i < list->count; i++) {
    const pni_edge *e = &list->edges[i];
    if (e->opposite[0] == e->opposite[1]) continue;
    const float *a = points + 3 * e->ends[0], *b = points + 3 * e->ends[1];
    double first = triple(a, b, points + 3 * e->opposite[0], light),
           second = triple(b, a, points + 3 * e->opposite[1], light);
    double size = 0;
    for (int k = 0; k < 3; k++) size = fmax(size, fmax(fabs(a[k]), fabs(b[k])));
    double edge = fabs(a[0] - b[0]) + fabs(a[1] - b[1]) + fabs(a[2] - b[2]);
    if (fabs(first) < 1e-5 * size * edge * size || fabs(second) < 1e-5 * size * edge * size) continue;
    checked++;
    assert_int_equal(sides[i] > 0, (first > 0) != (second > 0));
  }
  assert_true(list->count < 100 || checked > list->count / 20);
}

/* One mesh in one pose from one light. */
static size_t compare(bench *b, pni_mesh_data *mesh, const float *positions, const pni_edge_list *list,
                      pni_matrix matrix, bool sun) {
  float m[16], *points = malloc(list->vertices * 12);
  pni_matrix_to_floats(&matrix, m);
  for (size_t v = 0; v < list->vertices; v++) pni_silhouette_point(m, positions + 3 * v, points + 3 * v);
  float *sides = gpu_sides(b, mesh, &matrix, sun);
  size_t differ = 0, silhouettes = 0;
  for (size_t i = 0; i < list->count; i++) {
    pni_side side = pni_silhouette_side(&list->edges[i], points, sun);
    float want = side == PNI_SIDE_LEFT ? 1.0f : side == PNI_SIDE_RIGHT ? 0.5f : 0.0f;
    differ += fabsf(sides[i] - want) > 0.01f;
    silhouettes += side != PNI_SIDE_NONE;
  }
  assert_int_equal(differ, 0);
  if (!sun) check_definition(list, points, sides);
  free(points);
  free(sides);
  return silhouettes;
}

/* A turn, a stretch, and a distance before the light. */
static pni_matrix pose(uint64_t *seed, double size, bool mirrored) {
  vec x = random_direction(seed), y = unit(cross(x, random_direction(seed))), z = cross(x, y);
  pni_matrix m = pni_matrix_identity();
  const vec axes[3] = {mul(random_in(seed, 0.5, 2), x), y, mul(mirrored ? -1 : 1, z)};
  for (int c = 0; c < 3; c++) {
    m.m[4 * c] = axes[c].x;
    m.m[4 * c + 1] = axes[c].y;
    m.m[4 * c + 2] = axes[c].z;
  }
  m.m[12] = random_in(seed, -1, 1) * size;
  m.m[13] = random_in(seed, -1, 1) * size;
  m.m[14] = random_in(seed, 1, 6) * size;
  return m;
}

static double extent(const float *positions, size_t vertices) {
  double size = 0;
  for (size_t i = 0; i < 3 * vertices; i++) size = fmax(size, fabs(positions[i]));
  return size;
}

static pni_mesh_data *add_mesh(bench *b, const float *positions, size_t vertices, const uint32_t *indices, size_t count,
                               pn_mesh *mesh) {
  pn_mesh_desc desc = {.positions = {.data = positions, .count = vertices},
                       .indices = {.data = indices, .count = count},
                       .index_bytes = 4};
  assert_ok(pn_mesh_add(b->casters, &desc, mesh));
  return pni_find_mesh(b->casters, mesh->id);
}

static void test_models(void **state) {
  (void)state;
  int read = 0;
  for (int i = 0; model_name(i); i++) {
    char path[256];
    model m;
    snprintf(path, sizeof path, "/usr/share/glmark2/models/%s", model_name(i));
    if (!model_read(path, &m)) continue;
    read++;
    bench b;
    pn_mesh mesh;
    pni_edge_list list;
    uint64_t seed = 7;
    open_bench(&b);
    pni_mesh_data *data = add_mesh(&b, m.positions, m.vertices, m.indices, m.index_count, &mesh);
    assert_ok(pni_edges_find(b.gpu, m.positions, m.vertices, m.indices, m.index_count, &list));
    double size = extent(m.positions, m.vertices);
    size_t found = 0;
    for (int k = 0; k < 4; k++) found += compare(&b, data, m.positions, &list, pose(&seed, size, k == 2), k == 3);
    print_message("%s: %zu triangles, %zu edges, %zu silhouettes in four views\n", model_name(i), m.index_count / 3,
                  list.count, found);
    assert_true(found > 0);
    pni_edges_free(b.gpu, &list);
    pn_context_destroy(&b.context);
    model_free(&m);
  }
  if (!read) skip();
}

/* A grid that waves, in memory; and the same in a GL buffer of the host's with other numbers between the positions. */
enum { GRID = 40, VERTICES = GRID * GRID, INDICES = 6 * (GRID - 1) * (GRID - 1) };

static void wave(float *positions, int stride, double phase) {
  for (int i = 0; i < VERTICES; i++) {
    double x = i % GRID / (GRID - 1.0) - 0.5, y = i / GRID / (GRID - 1.0) - 0.5;
    float *p = positions + stride * i;
    p[0] = (float)x;
    p[1] = (float)y;
    p[2] = (float)(0.2 * sin(20 * x + phase) * cos(13 * y - phase));
  }
}

static void grid_indices(uint32_t *out) {
  for (uint32_t y = 0; y < GRID - 1; y++)
    for (uint32_t x = 0; x < GRID - 1; x++) {
      uint32_t a = y * GRID + x;
      const uint32_t quad[6] = {a, a + 1, a + GRID, a + 1, a + GRID + 1, a + GRID};
      memcpy(out, quad, sizeof quad);
      out += 6;
    }
}

static void test_deforming(void **state) {
  (void)state;
  static float positions[3 * VERTICES], spread[5 * VERTICES + 2];
  static uint32_t indices[INDICES];
  bench b;
  pn_mesh mesh, hosts;
  pni_edge_list list;
  GLuint buffer;
  uint64_t seed = 3;
  size_t most = 0;
  open_bench(&b);
  wave(positions, 3, 0);
  wave(spread + 2, 5, 0);
  grid_indices(indices);
  pni_mesh_data *data = add_mesh(&b, positions, VERTICES, indices, INDICES, &mesh);
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, sizeof spread, spread, GL_STREAM_DRAW);
  pn_mesh_desc desc = {.positions = {.buffer = buffer, .offset = 8, .stride = 20, .count = VERTICES},
                       .indices = {.data = indices, .count = INDICES},
                       .index_bytes = 4,
                       .bounds_min = {-1, -1, -1},
                       .bounds_max = {1, 1, 1}};
  assert_ok(pn_mesh_add(b.casters, &desc, &hosts));
  data = pni_find_mesh(b.casters, mesh.id);
  assert_ok(pni_edges_find(b.gpu, positions, VERTICES, indices, INDICES, &list));
  assert_int_equal(list.open, 4 * (GRID - 1));
  for (int k = 0; k < 6; k++) {
    pni_matrix at = pose(&seed, 1, k == 4);
    pn_span span = {.data = positions, .count = VERTICES};
    wave(positions, 3, 0.7 * k);
    wave(spread + 2, 5, 0.7 * k);
    assert_ok(pn_mesh_moved(b.casters, mesh, &span, NULL));
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glBufferSubData(GL_ARRAY_BUFFER, 0, sizeof spread, spread);
    assert_ok(pn_mesh_moved(b.casters, hosts, NULL, NULL));
    size_t found = compare(&b, data, positions, &list, at, k & 1);
    assert_int_equal(compare(&b, pni_find_mesh(b.casters, hosts.id), positions, &list, at, k & 1), found);
    assert_true(found >= 4 * (GRID - 1)); /* its border, and folds */
    most = found > most ? found : most;
  }
  assert_true(most > 6 * (GRID - 1));
  glDeleteBuffers(1, &buffer);
  pni_edges_free(b.gpu, &list);
  pn_context_destroy(&b.context);
}

/* Turning faces about changes no silhouette. */
static void test_winding(void **state) {
  (void)state;
  static float positions[3 * VERTICES];
  static uint32_t indices[INDICES], turned[INDICES];
  uint64_t seed = 11;
  wave(positions, 3, 1);
  grid_indices(indices);
  for (int t = 0; t < INDICES; t += 3) {
    bool turn = random_in(&seed, 0, 1) < 0.3;
    for (int i = 0; i < 3; i++) turned[t + i] = indices[t + (turn ? 2 - i : i)];
  }
  bench b;
  pn_mesh first, second;
  pni_edge_list lists[2];
  open_bench(&b);
  add_mesh(&b, positions, VERTICES, indices, INDICES, &first);
  add_mesh(&b, positions, VERTICES, turned, INDICES, &second);
  assert_ok(pni_edges_find(b.gpu, positions, VERTICES, indices, INDICES, &lists[0]));
  assert_ok(pni_edges_find(b.gpu, positions, VERTICES, turned, INDICES, &lists[1]));
  assert_true(lists[1].opposed > 100 && lists[0].opposed == 0);
  assert_int_equal(lists[0].count, lists[1].count);
  pni_matrix at = pose(&seed, 1, false);
  float *a = gpu_sides(&b, pni_find_mesh(b.casters, first.id), &at, false);
  float *c = gpu_sides(&b, pni_find_mesh(b.casters, second.id), &at, false);
  assert_memory_equal(a, c, lists[0].count * sizeof *a);
  free(a);
  free(c);
  pni_edges_free(b.gpu, &lists[0]);
  pni_edges_free(b.gpu, &lists[1]);
  pn_context_destroy(&b.context);
}

/* A box under a sun along its sides, whose faces are seen exactly from their edges: the four edges that end the top and
 * the four of the bottom are silhouettes, those between side faces lie on no side. */
static void test_faces_from_their_edge(void **state) {
  (void)state;
  static const uint32_t indices[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                       2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  float corners[24];
  for (int i = 0; i < 24; i++) corners[i] = i / 3 >> i % 3 & 1 ? 1.0f : -1.0f;
  bench b;
  pn_mesh mesh;
  pni_edge_list list;
  open_bench(&b);
  pni_mesh_data *data = add_mesh(&b, corners, 8, indices, 36, &mesh);
  assert_ok(pni_edges_find(b.gpu, corners, 8, indices, 36, &list));
  assert_int_equal(compare(&b, data, corners, &list, pni_matrix_identity(), true), 8);
  pni_edges_free(b.gpu, &list);
  pn_context_destroy(&b.context);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_models), cmocka_unit_test(test_deforming),
                                     cmocka_unit_test(test_winding), cmocka_unit_test(test_faces_from_their_edge)};
  return GL_RUN("silhouettes", tests);
}
