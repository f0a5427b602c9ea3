/* Models far from the origin, and models whose nodes take them far and back: the program sees them as it sees the same
 * model at the origin. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "experiment/experiment.h"
#include "scene/import_process.h"
#include "scene/load.h"
#include "scene/setup.h"

enum { WIDTH = 128, HEIGHT = 96, BOXES = 3, VERTICES = 8 * BOXES, INDICES = 36 * BOXES };

static char folder[] = "/tmp/penumbra-far-XXXXXX";

static int enter_folder(void **state) {
  (void)state;
  return mkdtemp(folder) && chdir(folder) == 0 ? 0 : -1;
}

static int leave_folder(void **state) {
  (void)state;
  char command[128];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return chdir("/") == 0 ? system(command) : -1;
}

/* ---- the model --------------------------------------------------------------------------------------------------- */

/* Three boxes, turned about y: one stands, one lies over it, one floats beside. One unit wide. */
static const struct {
  double at[3], half[3], turn;
} boxes[BOXES] = {{{-0.2, 0.3, 0.05}, {0.15, 0.3, 0.2}, 0.4},
                  {{-0.15, 0.68, 0}, {0.3, 0.05, 0.15}, -0.3},
                  {{0.3, 0.35, 0.1}, {0.12, 0.12, 0.12}, 0.8}};

static const uint32_t faces[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                   2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};

/* As a file keeps them: floats, scaled and then displaced. */
static void make_model(double scale, const double way[3], float positions[3 * VERTICES], uint32_t indices[INDICES]) {
  for (int i = 0; i < VERTICES; i++) {
    double side[3], c = cos(boxes[i / 8].turn), s = sin(boxes[i / 8].turn);
    for (int k = 0; k < 3; k++) side[k] = (i >> k & 1 ? 1 : -1) * boxes[i / 8].half[k];
    const double turned[3] = {c * side[0] + s * side[2], side[1], c * side[2] - s * side[0]};
    for (int k = 0; k < 3; k++)
      positions[3 * i + k] = (float)(scale * (double)(float)(boxes[i / 8].at[k] + turned[k]) + way[k]);
  }
  for (uint32_t i = 0; i < INDICES; i++) indices[i] = 8 * (i / 36) + faces[i % 36];
}

static void write_obj(const char *name, double scale, const double way[3]) {
  float positions[3 * VERTICES];
  uint32_t indices[INDICES];
  make_model(scale, way, positions, indices);
  FILE *file = fopen(name, "w");
  assert_non_null(file);
  for (int i = 0; i < VERTICES; i++)
    fprintf(file, "v %.9g %.9g %.9g\n", positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
  for (int i = 0; i < INDICES; i += 3)
    fprintf(file, "f %u %u %u\n", indices[i] + 1, indices[i + 1] + 1, indices[i + 2] + 1);
  assert_int_equal(fclose(file), 0);
}

/* nodes: the members of "nodes"; the mesh is number 0. */
static void write_gltf(double scale, const double way[3], const char *nodes) {
  float positions[3 * VERTICES], low[3], high[3];
  uint32_t indices[INDICES];
  make_model(scale, way, positions, indices);
  for (int i = 0; i < 3 * VERTICES; i++) {
    low[i % 3] = i < 3 ? positions[i] : fminf(low[i % 3], positions[i]);
    high[i % 3] = i < 3 ? positions[i] : fmaxf(high[i % 3], positions[i]);
  }
  FILE *file = fopen("model.bin", "wb");
  assert_non_null(file);
  fwrite(positions, sizeof positions, 1, file);
  fwrite(indices, sizeof indices, 1, file);
  assert_int_equal(fclose(file), 0);
  file = fopen("model.gltf", "w");
  assert_non_null(file);
  fprintf(file,
          "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[%s],"
          "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
          "\"buffers\":[{\"uri\":\"model.bin\",\"byteLength\":%zu}],"
          "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":%zu},"
          "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}],"
          "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%d,\"type\":\"VEC3\","
          "\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]},"
          "{\"bufferView\":1,\"componentType\":5125,\"count\":%d,\"type\":\"SCALAR\"}]}",
          nodes, sizeof positions + sizeof indices, sizeof positions, sizeof positions, sizeof indices, VERTICES,
          low[0], low[1], low[2], high[0], high[1], high[2], INDICES);
  assert_int_equal(fclose(file), 0);
}

/* ---- errors ------------------------------------------------------------------------------------------------------ */

static const char *const specs[] = {"bitmask", "hard",      "pcf",           "pcss", "average:samples=16",
                                    "ssm",     "smoothies", "backprojection"};
enum { SPECS = sizeof specs / sizeof *specs };

struct picture {
  double mae[SPECS];
  struct view view; /* of it position alone */
};

static struct scene *load(const char *file) {
  struct scene_request request = {.name = file};
  struct scene *scene = NULL;
  assert_int_equal(scene_load(&request, &scene), 0);
  scene->setup.size[0] = WIDTH;
  scene->setup.size[1] = HEIGHT;
  scene->setup.map[0] = scene->setup.map[1] = 512;
  return scene;
}

static void make_sun(struct light *light) {
  light->shape = PN_LIGHT_SUN;
  light->center[0] += 0.7 * (light->center[1] - light->target[1]); /* slanting */
  light->size[0] = light->size[1] = 6;
}

static struct picture draw(const char *file, int sun, int from_depth, int count) {
  struct picture out = {{0}, {0}};
  struct experiment e;
  struct scene *scene = load(file);
  if (sun) make_sun(&scene->setup.light);
  scene->setup.normals_from_depth = from_depth;
  assert_int_equal(setup_finish(scene), 0);
  assert_int_equal(experiment_open(&e, scene, "software", specs, count), 0);
  assert_int_equal(experiment_measure(&e, 1, 0), 0);
  for (int i = 0; i < count; i++) assert_int_equal(experiment_draw(&e, i), 0);
  assert_int_equal(experiment_trace(&e, 256, 0), 0);
  assert_int_equal(experiment_errors(&e), 0);
  for (int i = 0; i < count; i++) out.mae[i] = e.entries[i].error.mae;
  assert_true(e.entries[0].error.pixels > 300);
  out.view = *e.view;
  e.view->position = NULL;
  experiment_close(&e);
  scene_free(&scene);
  return out;
}

static void check_errors(const char *what, const struct picture *there, const struct picture *here, int count) {
  for (int i = 0; i < count; i++) {
    printf("%s, %s: %.4f, at the origin %.4f\n", what, specs[i], there->mae[i], here->mae[i]);
    assert_true(there->mae[i] <= 1.1 * here->mae[i] + 0.001);
  }
}

/* Positions are those at the origin, scaled and displaced, up to rounding of the vertices in the file (step), of a few
 * floats as large as the scene, and of the depth buffer behind them. */
static void check_positions(const struct picture *there, const struct picture *here, double scale, const double way[3],
                            double step) {
  int differing = 0;
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    const float *p = there->view.position + 3 * i, *q = here->view.position + 3 * i;
    int far = isnan(p[0]) != isnan(q[0]);
    for (int k = 0; k < 3 && !isnan(p[0]) && !isnan(q[0]); k++)
      far |= fabs(there->view.origin[k] + p[k] - (scale * (here->view.origin[k] + q[k]) + way[k])) >
             8 * step + 1e-4 * scale;
    differing += far;
  }
  assert_true(differing <= 100); /* pixels on edges of boxes, where another face may be seen */
}

static void free_picture(struct picture *p) { free(p->view.position); }

static const double nowhere[3] = {0, 0, 0};

static void compare(const char *what, const char *file, double scale, const double way[3], double step, int sun,
                    int from_depth, int count) {
  write_obj("here.obj", 1, nowhere);
  struct picture here = draw("here.obj", sun, from_depth, count), there = draw(file, sun, from_depth, count);
  check_errors(what, &there, &here, count);
  check_positions(&there, &here, scale, way, step);
  free_picture(&here);
  free_picture(&there);
}

/* ---- the family -------------------------------------------------------------------------------------------------- */

/* The file's floats are far away: what they round to is the model, for the truth too. */
static void test_vertices(void **state) {
  (void)state;
  static const double ways[][3] = {{300, 0, 600}, {-6000, 4000, 7000}};
  for (int i = 0; i < 2; i++) {
    write_obj("model.obj", 1, ways[i]);
    compare("vertices", "model.obj", 1, ways[i], ldexp(1, i ? -12 : -15), i, !i, i ? SPECS : 2);
  }
}

static void test_node(void **state) {
  (void)state;
  static const double way[3] = {1e6, -5e5, 2e6};
  write_gltf(1, nowhere, "{\"mesh\":0,\"translation\":[1e6,-5e5,2e6]}");
  compare("a node", "model.gltf", 1, way, 0, 0, 0, 2);
  compare("a node, sun", "model.gltf", 1, way, 0, 1, 1, 2);
}

/* A quarter turn far away, and back: exact in floats, as products of sines would not be. */
static void test_nodes_that_cancel(void **state) {
  (void)state;
  write_gltf(1, nowhere,
             "{\"children\":[1],\"matrix\":[0,0,-1,0,0,1,0,0,1,0,0,0,1e6,-1e6,3e5,1]},"
             "{\"children\":[2],\"matrix\":[0,0,1,0,0,1,0,0,-1,0,0,0,0,0,0,1]},"
             "{\"mesh\":0,\"translation\":[-1e6,1e6,-3e5]}");
  compare("nodes that cancel", "model.gltf", 1, nowhere, 0, 0, 0, 2);
}

/* 2^20 units away the steps of floats are 1/8: coarser than this model, so it is made larger there. */
static void test_vertices_brought_back(void **state) {
  (void)state;
  static const double away[3] = {1048576, -524288, 2097152};
  write_gltf(16384, away,
             "{\"children\":[1],\"scale\":[6.103515625e-05,6.103515625e-05,6.103515625e-05]},"
             "{\"mesh\":0,\"translation\":[-1048576,524288,-2097152]}");
  compare("vertices brought back", "model.gltf", 1, nowhere, 0x1p-17, 0, 1, 2);
}

static void test_scales(void **state) {
  (void)state;
  write_obj("model.obj", 1e-6, nowhere);
  compare("a millionth", "model.obj", 1e-6, nowhere, 0, 0, 0, 2);
  write_gltf(1, nowhere, "{\"mesh\":0,\"scale\":[1e6,1e6,1e6]}");
  compare("a million", "model.gltf", 1e6, nowhere, 0, 0, 0, 2);
  write_gltf(1e6, nowhere, "{\"mesh\":0,\"scale\":[1e-6,1e-6,1e-6]}");
  compare("a million, scaled down", "model.gltf", 1, nowhere, 0, 1, 0, 2);
}

/* What position.exr holds: scene space, to the last bit that a float has there. */
static void test_positions(void **state) {
  (void)state;
  static const double way[3] = {1e6, -5e5, 2e6};
  write_obj("here.obj", 1, nowhere);
  write_gltf(1, nowhere, "{\"mesh\":0,\"translation\":[1e6,-5e5,2e6]}");
  struct picture here = draw("here.obj", 0, 0, 1), there = draw("model.gltf", 0, 0, 1);
  static float positions[3 * WIDTH * HEIGHT];
  view_positions(&there.view, positions);
  int differing = 0;
  for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
    float exact = (float)(here.view.origin[i % 3] + here.view.position[i] + way[i % 3]);
    assert_true(isnan(exact) == isnan(positions[i]));
    differing += !isnan(exact) && fabsf(exact - positions[i]) > 0;
  }
  assert_true(differing < WIDTH * HEIGHT / 100); /* where 1e-6 of the scene decides to which side it is rounded */
  free_picture(&here);
  free_picture(&there);
}

/* ---- nothing is rounded ------------------------------------------------------------------------------------------ */

static void test_centers(void **state) {
  (void)state;
  static const double ways[][3] = {{0, 0, 0}, {0.4, -7, 0}, {3e4, 0, -5e6}};
  for (int i = 0; i < 3; i++) {
    float positions[3 * VERTICES];
    uint32_t indices[INDICES];
    make_model(1, ways[i], positions, indices);
    write_gltf(1, ways[i], "{\"mesh\":0}");
    struct scene *scene = load("model.gltf");
    const struct mesh *mesh = &scene->meshes[0];
    for (uint32_t c = 0, corner = 0; c < INDICES && i < 2; c++, corner++)
      for (int k = 0; k < 3; k++)
        assert_true(mesh->center[k] + mesh->positions[3 * mesh->indices[corner] + (uint32_t)k] ==
                    positions[3 * indices[c] + (uint32_t)k]);
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
      for (int k = 0; k < 3; k++) assert_true(fabsf(mesh->positions[3 * v + (uint32_t)k]) <= 1.5f);
    /* What is drawn is as small as the scene, wherever that lies. */
    for (int n = 0; n < scene->instance_count; n++)
      for (int k = 12; k < 15; k++) assert_true(fabsf(scene->instances[n].placed[k]) <= 3);
    scene_free(&scene);
  }
}

int main(int argc, char **argv) {
  import_serve(argc, argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_vertices),
      cmocka_unit_test(test_node),
      cmocka_unit_test(test_nodes_that_cancel),
      cmocka_unit_test(test_vertices_brought_back),
      cmocka_unit_test(test_scales),
      cmocka_unit_test(test_positions),
      cmocka_unit_test(test_centers),
  };
  return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
