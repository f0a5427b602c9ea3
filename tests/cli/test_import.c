/* Models of the tests' own making: transforms, alpha-tested materials, what is dropped, what is missing. */
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "files/image.h"
#include "host/device.h"
#include "scene/import_process.h"
#include "scene/load.h"
#include "scene/vector.h"

static char folder[] = "/tmp/penumbra-import-XXXXXX";

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

static void write_text(const char *name, const char *text) {
  FILE *file = fopen(name, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
  assert_int_equal(fclose(file), 0);
}

static struct scene *load(const char *name, int up_is_z) {
  struct scene_request request = {.name = name, .ground = GROUND_OFF, .up_is_z = up_is_z};
  struct scene *scene = NULL;
  assert_int_equal(scene_load(&request, &scene), 0);
  return scene;
}

/* One quad in the plane z = 0 with x, y in [0, 1], texture coordinates equal to them in glTF's sense (v downwards),
 * 16-bit indices. */
static void write_quad_bin(const char *name) {
  const float positions[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, texcoords[8] = {0, 1, 1, 1, 1, 0, 0, 0};
  const uint16_t indices[6] = {0, 1, 2, 0, 2, 3};
  FILE *file = fopen(name, "wb");
  assert_non_null(file);
  fwrite(positions, sizeof positions, 1, file);
  fwrite(texcoords, sizeof texcoords, 1, file);
  fwrite(indices, sizeof indices, 1, file);
  assert_int_equal(fclose(file), 0);
}

/* nodes: the members of "nodes"; materials: of "materials". */
static void write_gltf(const char *name, const char *nodes, const char *materials) {
  char text[4096];
  snprintf(
      text, sizeof text,
      "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[%s],"
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"indices\":2,\"material\":0}]}],"
      "\"materials\":[%s],\"textures\":[{\"source\":0,\"sampler\":0}],\"images\":[{\"uri\":\"the%%20holes.png\"}],"
      "\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648}],"
      "\"buffers\":[{\"uri\":\"quad.bin\",\"byteLength\":92}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,"
      "\"byteLength\":48},"
      "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":32},{\"buffer\":0,\"byteOffset\":80,\"byteLength\":12}],"
      "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":["
      "1,1,0]},"
      "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
      "{\"bufferView\":2,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}]}",
      nodes, materials);
  write_text(name, text);
  write_quad_bin("quad.bin");
}

/* A hole in the picture's upper left quarter, everything else opaque at 200 of 255. */
static void write_holes(void) {
  enum { N = 8 };
  uint8_t rgba[N * N * 4];
  for (int i = 0; i < N * N; i++) {
    memset(&rgba[4 * i], 90, 3);
    rgba[4 * i + 3] = i / N < N / 2 && i % N < N / 2 ? 0 : 200;
  }
  assert_int_equal(png_write("the holes.png", N, N, 4, rgba), 0);
}

static const char mask_material[] =
    "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},\"alphaMode\":\"MASK\",\"alphaCutoff\":0.7}";

static void test_gltf_mask(void **state) {
  (void)state;
  write_holes();
  write_gltf("mask.gltf", "{\"mesh\":0}", mask_material);
  struct scene *scene = load("mask.gltf", 0);
  assert_int_equal(scene->texture_count, 1);
  const struct mesh *mesh = &scene->meshes[0];
  const struct texture *texture = &scene->textures[0];
  assert_int_equal(mesh->texture, 0);
  assert_true(fabsf(mesh->cutoff - 0.7f) < 1e-6f);
  assert_int_equal(texture->wrap_u, WRAP_CLAMP);
  assert_int_equal(texture->wrap_v, WRAP_MIRROR);
  /* The picture's upper left is the quad's corner x = 0, y = 1, whatever v is called on the way. */
  for (uint32_t i = 0; i < mesh->vertex_count; i++) {
    float x = mesh->positions[3 * i], y = mesh->positions[3 * i + 1];
    float u = mesh->texcoords[2 * i] * 0.5f + 0.25f, v = mesh->texcoords[2 * i + 1] * 0.5f + 0.25f;
    float alpha = texture_alpha(texture, u, v);
    assert_true(x == 0 && y == 1 ? alpha == 0 : fabsf(alpha - 200 / 255.0f) < 1e-6f);
  }
  scene_free(&scene);
}

/* The factor scales the texture's alpha; without a texture it decides alone. */
static void test_gltf_factor(void **state) {
  (void)state;
  write_holes();
  write_gltf("factor.gltf", "{\"mesh\":0}",
             "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0},\"baseColorFactor\":[1,1,1,0.5]},"
             "\"alphaMode\":\"MASK\"}");
  struct scene *scene = load("factor.gltf", 0);
  assert_true(scene->meshes[0].cutoff == 0.5f);
  assert_true(fabsf(texture_alpha(&scene->textures[0], 0.75f, 0.25f) - 100 / 255.0f) < 1e-6f);
  scene_free(&scene);
  write_gltf("solid.gltf", "{\"mesh\":0}",
             "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.6]},\"alphaMode\":\"MASK\"}");
  scene = load("solid.gltf", 0);
  assert_int_equal(scene->meshes[0].texture, -1);
  assert_null(scene->meshes[0].texcoords);
  scene_free(&scene);
  write_gltf("nothing.gltf", "{\"mesh\":0}",
             "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.4]},\"alphaMode\":\"MASK\"}");
  struct scene_request request = {.name = "nothing.gltf"};
  assert_int_equal(scene_load(&request, &scene), 2);
}

/* OPAQUE is opaque, whatever the texture holds; what is blended casts where its opacity is at least one half; a
 * texture that is missing or broken leaves the material opaque. */
static void test_opaque(void **state) {
  (void)state;
  write_holes();
  write_gltf("opaque.gltf", "{\"mesh\":0}",
             "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0},\"baseColorFactor\":[1,1,1,0.1]}}");
  struct scene *scene = load("opaque.gltf", 0);
  assert_int_equal(scene->meshes[0].texture, -1);
  assert_int_equal(scene->texture_count, 0);
  scene_free(&scene);
  write_gltf("blend.gltf", "{\"mesh\":0}",
             "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}},\"alphaMode\":\"BLEND\"}");
  scene = load("blend.gltf", 0);
  assert_int_equal(scene->meshes[0].texture, 0);
  assert_true(scene->meshes[0].cutoff == 0.5f);
  scene_free(&scene);
  write_gltf("missing.gltf", "{\"mesh\":0}", mask_material);
  for (int broken = 0; broken < 2; broken++) {
    if (broken) write_text("the holes.png", "\x89PNG\r\n\x1a\nno");
    else unlink("the holes.png");
    scene = load("missing.gltf", 0);
    assert_int_equal(scene->meshes[0].texture, -1);
    assert_int_equal(scene->triangle_count, 2);
    scene_free(&scene);
  }
}

/* OBJ's map_d: grey is opacity. */
static void test_obj_opacity(void **state) {
  (void)state;
  const uint8_t grey[4] = {255, 0, 255, 255};
  assert_int_equal(png_write("d.png", 2, 2, 1, grey), 0);
  write_text("d.mtl", "newmtl m\nKd 1 1 1\nmap_d d.png\n");
  write_text("d.obj", "mtllib d.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n");
  struct scene *scene = load("d.obj", 0);
  assert_int_equal(scene->meshes[0].texture, 0);
  assert_true(texture_alpha(&scene->textures[0], 0.75f, 0.75f) == 0); /* upper right */
  assert_true(texture_alpha(&scene->textures[0], 0.25f, 0.75f) == 1);
  scene_free(&scene);
}

/* Node over node: translate (0, 0, 5) after scaling by (2, -3, 1), which mirrors. */
static void test_nested_transforms(void **state) {
  (void)state;
  write_gltf("nested.gltf", "{\"children\":[1],\"translation\":[0,0,5]},{\"mesh\":0,\"scale\":[2,-3,1]}", "{}");
  struct scene *scene = load("nested.gltf", 0);
  const float low[3] = {0, -3, 5}, high[3] = {2, 0, 5};
  for (int k = 0; k < 3; k++) {
    assert_true(fabs(scene->bounds_min[k] - (double)low[k]) < 1e-6);
    assert_true(fabs(scene->bounds_max[k] - (double)high[k]) < 1e-6);
  }
  scene_free(&scene);
  scene = load("nested.gltf", 1); /* the file's z is up: (x, y, z) stands at (x, z, -y) */
  const float low_z[3] = {0, 5, 0}, high_z[3] = {2, 5, 3};
  for (int k = 0; k < 3; k++) {
    assert_true(fabs(scene->bounds_min[k] - (double)low_z[k]) < 1e-6);
    assert_true(fabs(scene->bounds_max[k] - (double)high_z[k]) < 1e-6);
  }
  scene_free(&scene);
}

/* Bad triangles go, good ones stay, and vertices that coincide are one. */
static void test_dropped(void **state) {
  (void)state;
  write_text("some.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv nan 0 0\nv 1e38 0 0\nv 0 0 0\nv 1 1 0\nf 1 2 3\nf 7 8 "
                         "4\nf 1 2 5\nf 1 2 6\nf 1 1 2\nf 1 2 2\n");
  struct scene *scene = load("some.obj", 0);
  assert_int_equal(scene->triangle_count, 2);
  assert_int_equal(scene->meshes[0].vertex_count, 4);
  scene_free(&scene);
}

/* The whole way: the square caster's hole lets the light through to the ground. */
static void test_holes_in_the_shadow(void **state) {
  (void)state;
  const char *program = getenv("PENUMBRA_PROGRAM");
  if (!program) skip();
  char command[1024];
  snprintf(command, sizeof command,
           "'%s' render lifted.obj --split --size 96x96 --map 512 --frames 1 -t hard -o lifted.png --light-center "
           "0,9,0 --light-target 0,0,0 "
           "--light-size 0.1 --camera-position 0,0.9,0 --camera-target 0,0,0 --camera-up 0,0,-1 --fov 70 >/dev/null",
           program);
  const uint8_t grey[4] = {0, 255, 255, 255}; /* a hole in the upper left */
  assert_int_equal(png_write("l.png", 2, 2, 1, grey), 0);
  write_text("l.mtl", "newmtl m\nmap_d l.png\nnewmtl n\n");
  /* The quad at y = 1, its picture's top towards -z; a tiny triangle at y = 0 puts the ground there. */
  write_text(
      "lifted.obj",
      "mtllib l.mtl\nv -0.5 1 0.5\nv 0.5 1 0.5\nv 0.5 1 -0.5\nv -0.5 1 -0.5\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\n"
      "f 1/1 2/2 3/3 4/4\nusemtl n\nv 3 0 0\nv 3.01 0 0\nv 3 0 0.01\nf 5 6 7\n");
  assert_int_equal(system(command), 0);
  FILE *file = fopen("lifted.png", "rb");
  assert_non_null(file);
  static uint8_t bytes[1 << 16];
  size_t size = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  int width = 0, height = 0;
  uint8_t *rgba = NULL;
  char why[100];
  assert_int_equal(png_decode(bytes, size, &width, &height, &rgba, why, sizeof why), 0);
  /* The camera sees x, z in [-0.63, 0.63] of the ground; the quad's shadow reaches to 0.5 * 9 / 8. */
  int at_left = 96 / 2 - 96 * 25 / 126, at_right = 96 / 2 + 96 * 25 / 126;
  int upper_left = rgba[4 * (at_left * 96 + at_left)], upper_right = rgba[4 * (at_left * 96 + at_right)];
  int lower_left = rgba[4 * (at_right * 96 + at_left)], lower_right = rgba[4 * (at_right * 96 + at_right)];
  free(rgba);
  assert_true(upper_left > 200);
  assert_true(upper_right < 60 && lower_left < 60 && lower_right < 60);
}

/* ---- where and when ---------------------------------------------------------------------------------------------- */

/* As a viewer does it: on another thread, while GL runs on this one. */
struct job {
  const char *name;
  struct scene *scene;
  int status;
};

static void *import(void *user) {
  struct job *job = user;
  struct scene_request request = {.name = job->name, .ground = GROUND_OFF};
  job->status = scene_load(&request, &job->scene);
  return NULL;
}

/* A strip of count quads, as a text that takes the importer some time. */
static void write_strip(const char *name, int count) {
  FILE *file = fopen(name, "wb");
  assert_non_null(file);
  for (int i = 0; i <= count; i++) fprintf(file, "v %d 0 0\nv %d 1 0\n", i, i);
  for (int i = 0; i < count; i++) fprintf(file, "f %d %d %d %d\n", 2 * i + 1, 2 * i + 3, 2 * i + 4, 2 * i + 2);
  assert_int_equal(fclose(file), 0);
}

static int count_descriptors(void) {
  int count = 0;
  for (int fd = 0; fd < 256; fd++) count += fcntl(fd, F_GETFD) >= 0;
  return count;
}

/* A GL context and its driver's threads and locks are there; two imports run at once, a third fails. */
static void test_after_gl_and_on_threads(void **state) {
  (void)state;
  enum { JOBS = 3, QUADS = 40000 };
  write_strip("a.obj", QUADS);
  write_strip("b.obj", QUADS / 2);
  write_text("broken.obj", "v 0 0 0\n");
  struct device *device = NULL;
  assert_int_equal(device_open("software", &device), 0);
  int descriptors = count_descriptors();
  struct scene *here = load("a.obj", 0);
  assert_int_equal(here->triangle_count, 2 * QUADS);
  scene_free(&here);
  for (int round = 0; round < 3; round++) {
    struct job jobs[JOBS] = {{.name = "a.obj"}, {.name = "b.obj"}, {.name = "broken.obj"}};
    pthread_t threads[JOBS];
    for (int i = 0; i < JOBS; i++) assert_int_equal(pthread_create(&threads[i], NULL, import, &jobs[i]), 0);
    for (int i = 0; i < JOBS; i++) assert_int_equal(pthread_join(threads[i], NULL), 0);
    assert_int_equal(jobs[0].status, 0);
    assert_int_equal(jobs[1].status, 0);
    assert_int_equal(jobs[2].status, 2);
    assert_int_equal(jobs[0].scene->triangle_count, 2 * QUADS);
    assert_int_equal(jobs[1].scene->triangle_count, QUADS);
    assert_null(jobs[2].scene);
    scene_free(&jobs[0].scene);
    scene_free(&jobs[1].scene);
  }
  assert_int_equal(count_descriptors(), descriptors);
  assert_int_equal(waitpid(-1, NULL, WNOHANG), -1); /* and no process is left */
  device_close(&device);
}

int main(int argc, char **argv) {
  import_serve(argc, argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_gltf_mask),
      cmocka_unit_test(test_gltf_factor),
      cmocka_unit_test(test_opaque),
      cmocka_unit_test(test_obj_opacity),
      cmocka_unit_test(test_nested_transforms),
      cmocka_unit_test(test_dropped),
      cmocka_unit_test(test_after_gl_and_on_threads),
      cmocka_unit_test(test_holes_in_the_shadow),
  };
  return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
