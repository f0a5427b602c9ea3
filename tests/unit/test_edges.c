/* The edges of a mesh: against a list made the slow way, and on meshes that are open, crowded, turned about, broken. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "silhouettes/edges.h"
#include "gl_context.h"
#include "soup.h"

static pni_gpu none; /* the C library's memory, no log */

static pni_edge_list edges_of(const float *positions, size_t vertices, const uint32_t *indices, size_t count) {
  pni_edge_list list;
  assert_int_equal(pni_edges_find(&none, positions, vertices, indices, count, &list), PN_OK);
  assert_int_equal(list.vertices, vertices);
  /* Every edge is in the rings of its two ends, and nowhere else. */
  size_t entries = 0;
  for (size_t v = 0; v < vertices; v++)
    for (uint32_t i = 0; i < list.rings[v].count; i++, entries++) {
      pni_ring_entry entry = list.entries[list.rings[v].first + i];
      const uint32_t *ends = list.edges[entry.edge].ends;
      assert_true((ends[0] == v && ends[1] == entry.other) || (ends[1] == v && ends[0] == entry.other));
    }
  assert_int_equal(entries, 2 * list.count);
  return list;
}

static pni_edge_list edges_of_soup(const soup *s) {
  uint32_t *indices = malloc(3 * (size_t)s->count * sizeof *indices);
  for (int i = 0; i < 3 * s->count; i++) indices[i] = (uint32_t)i;
  pni_edge_list list = edges_of(s->list[0].p[0], 3 * (size_t)s->count, indices, 3 * (size_t)s->count);
  free(indices);
  return list;
}

/* Twelve triangles whose corners are all apart: twelve edges of the box and six diagonals, two faces each. */
static void test_box(void **state) {
  (void)state;
  soup s = {0};
  soup_box(&s, v3(0, 0, 0), v3(1, 2, 3));
  pni_edge_list list = edges_of_soup(&s);
  assert_int_equal(list.count, 18);
  assert_int_equal(list.open + list.crowded + list.opposed + list.dropped, 0);
  for (size_t i = 0; i < list.count; i++) assert_true(list.edges[i].opposite[0] != list.edges[i].opposite[1]);
  pni_edges_free(&none, &list);
  triangle turned = s.list[5]; /* one wound the other way: its three edges are told, and none is lost */
  memcpy(s.list[5].p[0], turned.p[1], 12);
  memcpy(s.list[5].p[1], turned.p[0], 12);
  list = edges_of_soup(&s);
  assert_int_equal(list.count, 18);
  assert_int_equal(list.opposed, 3);
  pni_edges_free(&none, &list);
  s.count--; /* a hole */
  list = edges_of_soup(&s);
  assert_int_equal(list.count, 18);
  assert_int_equal(list.open, 3);
  pni_edges_free(&none, &list);
  soup_free(&s);
}

static void test_few(void **state) {
  (void)state;
  soup s = {0};
  soup_triangle(&s, v3(0, 0, 0), v3(1, 0, 0), v3(0, 1, 0));
  pni_edge_list list = edges_of_soup(&s);
  assert_int_equal(list.count, 3);
  assert_int_equal(list.open, 3);
  pni_edges_free(&none, &list);
  soup_triangle(&s, v3(0, 0, 0), v3(0, 1, 0), v3(1, 0, 0)); /* the same once more, from behind */
  list = edges_of_soup(&s);
  assert_int_equal(list.count, 3);
  assert_int_equal(list.open, 3);
  pni_edges_free(&none, &list);
  soup_triangle(&s, v3(0, 0, 0), v3(1, 0, 0), v3(0, 0, 1)); /* three half planes around one edge */
  soup_triangle(&s, v3(0, 0, 0), v3(1, 0, 0), v3(0, -1, -1));
  list = edges_of_soup(&s);
  assert_int_equal(list.crowded, 1);
  assert_int_equal(list.count, 3 + 6); /* the shared edge once for each face */
  pni_edges_free(&none, &list);
  soup_free(&s);
}

static void test_broken(void **state) {
  (void)state;
  const float positions[7][3] = {{0, 0, 0},   {1, 0, 0},        {0, 1, 0}, {-0.0f, 0, 0},
                                 {NAN, 0, 0}, {0, INFINITY, 0}, {2, 0, 0}};
  const uint32_t indices[] = {0, 1, 2, /* sound */
                              0, 1, 3, /* 3 is where 0 is */
                              0, 1, 4, 0, 5, 1, 0, 1, 77, 0, 0xffffffffu, 2, 0, 1, 6 /* no area, but three places */};
  pni_edge_list list = edges_of(positions[0], 7, indices, sizeof indices / 4);
  assert_int_equal(list.dropped, 5);
  assert_int_equal(list.count, 3 + 2);
  pni_edges_free(&none, &list);
  list = edges_of(positions[0], 7, indices, 0);
  assert_int_equal(list.count, 0);
  pni_edges_free(&none, &list);
}

/* Random triangles on few places: each pair of places with a triangle on it, counted one by one. */
static void test_brute(void **state) {
  (void)state;
  enum { PLACES = 9, TRIANGLES = 40 };
  uint64_t seed = 5;
  for (int round = 0; round < TEST_ROUNDS(200); round++) {
    float positions[3 * TRIANGLES][3];
    uint32_t indices[3 * TRIANGLES], place[3 * TRIANGLES];
    for (uint32_t i = 0; i < 3 * TRIANGLES; i++) { /* every corner a vertex of its own */
      indices[i] = i;
      place[i] = (uint32_t)random_in(&seed, 0, PLACES);
      for (int c = 0; c < 3; c++) positions[i][c] = (float)(place[i] * (c + 1) % 7);
    }
    static char faces[PLACES][PLACES][PLACES];
    memset(faces, 0, sizeof faces);
    size_t dropped = 0, count = 0, open = 0, crowded = 0;
    for (int t = 0; t < TRIANGLES; t++) {
      const uint32_t *p = place + 3 * t;
      bool whole = true;
      for (int i = 0; i < 3; i++) /* equal coordinates are one place, whatever their number */
        whole = whole && memcmp(positions[3 * t + i], positions[3 * t + (i + 1) % 3], 12) != 0;
      dropped += !whole;
      for (int i = 0; whole && i < 6; i++)
        faces[p[i % 3] % 7][p[(i + (i < 3 ? 1 : 2)) % 3] % 7][p[(i + (i < 3 ? 2 : 1)) % 3] % 7] = 1;
    }
    for (int a = 0; a < 7; a++)
      for (int b = a + 1; b < 7; b++) {
        size_t here = 0;
        for (int c = 0; c < 7; c++) here += (size_t)faces[a][b][c];
        open += here == 1;
        crowded += here > 2;
        count += here == 2 ? 1 : here;
      }
    pni_edge_list list = edges_of(positions[0], 3 * TRIANGLES, indices, 3 * TRIANGLES);
    assert_int_equal(list.dropped, dropped);
    assert_int_equal(list.count, count);
    assert_int_equal(list.open, open);
    assert_int_equal(list.crowded, crowded);
    pni_edges_free(&none, &list);
  }
}

/* Triangles in a row around their first corner. All of a vertex's edges may be looked at for each of them, as long as
 * that is no more than 2^32 pairs and 65535 at a time. */
static void check_fan(size_t triangles) {
  float *positions = malloc((triangles + 2) * 3 * sizeof *positions);
  uint32_t *indices = malloc(triangles * 3 * sizeof *indices);
  for (size_t i = 0; i < triangles + 2; i++) memcpy(positions + 3 * i, (const float[3]){(float)i, i != 0, 0}, 12);
  for (size_t i = 0; i < triangles; i++)
    memcpy(indices + 3 * i, (const uint32_t[3]){0, (uint32_t)i + 1, (uint32_t)i + 2}, 12);
  pni_edge_list list = edges_of(positions, triangles + 2, indices, triangles * 3);
  assert_int_equal(list.rings[0].count, triangles + 1);
  double tip = (double)triangles + 1, others = 9.0 * (double)triangles, most = list.ring_most;
  assert_true(tip * fmin(tip, most) + others <= 0x1p32 && most <= 65535);
  if (most < 65535) assert_true(tip * (2 * most + 1) + others > 0x1p32);
  pni_edges_free(&none, &list);
  free(positions);
  free(indices);
}

static void test_fan(void **state) {
  (void)state;
  check_fan(300);
  check_fan(60000);
  check_fan(200000);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_box), cmocka_unit_test(test_few),
                                     cmocka_unit_test(test_broken), cmocka_unit_test(test_brute),
                                     cmocka_unit_test(test_fan)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
