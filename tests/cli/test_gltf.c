/* glTF of the tests' own making: what its reader puts together is where the specification says. */
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

#include "files/image.h"
#include "scene/import_process.h"
#include "scene/load.h"

static char folder[] = "/tmp/penumbra-gltf-XXXXXX";

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

static void write_bytes(const char *name, const void *bytes, size_t size) {
  FILE *file = fopen(name, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, size, file), size);
  assert_int_equal(fclose(file), 0);
}

/* The corner k of the unit square in the plane z = 0, and its two triangles: (0,0), (1,0), (1,1), (0,1). */
static const float corners[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
static const uint16_t quad[6] = {0, 1, 2, 0, 2, 3};
enum { MORE = 60 }; /* where the case's own bytes begin, in view 2 */

/* What differs between the cases; NULL: the plain square. primitive and accessors end in a comma. */
struct document {
  const char *nodes, *primitive, *position, *accessors, *views, *rest, *mesh;
  const void *more;
  size_t more_size;
};

static const char *or_else(const char *text, const char *otherwise) { return text ? text : otherwise; }

/* Accessors: 0 positions, 1 indices, then the case's own. Views: 0, 1, 2 (the rest of the bytes), then its own. */
static int make(const char *name, const struct document *d, char *out, size_t room) {
  uint8_t bytes[1024] = {0};
  assert_true(MORE + d->more_size <= sizeof bytes);
  memcpy(bytes, corners, sizeof corners);
  memcpy(bytes + sizeof corners, quad, sizeof quad);
  if (d->more) memcpy(bytes + MORE, d->more, d->more_size);
  write_bytes("the data.bin", bytes, sizeof bytes);
  int size =
      snprintf(out, room,
               "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[%s],"
               "\"meshes\":[{\"primitives\":[{%s \"attributes\":{\"POSITION\":0%s},\"indices\":1}]%s}],"
               "\"accessors\":[{%s},{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}%s],"
               "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":12},"
               "{\"buffer\":0,\"byteOffset\":60,\"byteLength\":900}%s],"
               "\"buffers\":[{\"byteLength\":1024%s}]%s}",
               or_else(d->nodes, "{\"mesh\":0}"), or_else(d->primitive, ""), "", or_else(d->mesh, ""),
               or_else(d->position, "\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\""),
               or_else(d->accessors, ""), or_else(d->views, ""),
               strstr(name, ".glb") ? "" : ",\"uri\":\"the%20data.bin\"", or_else(d->rest, ""));
  assert_true(size > 0 && (size_t)size < room);
  return size;
}

static void write_gltf(const char *name, const struct document *d) {
  char text[8192];
  write_bytes(name, text, (size_t)make(name, d, text, sizeof text));
}

static int status_of(const char *name) {
  struct scene_request request = {.name = name, .ground = GROUND_OFF};
  struct scene *scene = NULL;
  int status = scene_load(&request, &scene);
  scene_free(&scene);
  return status;
}

/* The bounds are what they should be; v: least x, y, z, then most. */
static void check_bounds(const char *name, int triangles, const double v[6]) {
  struct scene_request request = {.name = name, .ground = GROUND_OFF};
  struct scene *scene = NULL;
  assert_int_equal(scene_load(&request, &scene), 0);
  assert_int_equal(scene->triangle_count, triangles);
  for (int k = 0; k < 3; k++) {
    assert_true(fabs((double)scene->bounds_min[k] - v[k]) < 1e-5);
    assert_true(fabs((double)scene->bounds_max[k] - v[3 + k]) < 1e-5);
  }
  scene_free(&scene);
}

static void check(const char *name, const struct document *d, int triangles, const double v[6]) {
  write_gltf(name, d);
  check_bounds(name, triangles, v);
}

#define BOX(...) ((const double[6]){__VA_ARGS__})

/* A buffer's name with a space as a URI; a byte-order mark; the same in one binary file. */
static void test_containers(void **state) {
  (void)state;
  const struct document plain = {0};
  char text[8192];
  check("plain.gltf", &plain, 2, BOX(0, 0, 0, 1, 1, 0));
  memcpy(text, "\xef\xbb\xbf", 3);
  int size = make("mark.gltf", &plain, text + 3, sizeof text - 3);
  write_bytes("mark.gltf", text, (size_t)size + 3);
  check_bounds("mark.gltf", 2, BOX(0, 0, 0, 1, 1, 0));
  static uint8_t glb[16384];
  size = make("whole.glb", &plain, (char *)glb + 20, sizeof glb - 20);
  while (size % 4) glb[20 + size++] = ' ';
  const uint32_t json_size = (uint32_t)size, buffer_size = 1024, total = 28 + json_size + buffer_size;
  const uint32_t head[5] = {0x46546c67, 2, total, json_size, 0x4e4f534a}, chunk[2] = {buffer_size, 0x004e4942};
  memcpy(glb, head, sizeof head);
  memcpy(glb + 20 + size, chunk, sizeof chunk);
  memcpy(glb + 28 + size, corners, sizeof corners);
  memcpy(glb + 28 + size + sizeof corners, quad, sizeof quad);
  write_bytes("whole.glb", glb, total);
  check_bounds("whole.glb", 2, BOX(0, 0, 0, 1, 1, 0));
  write_bytes("cut.glb", glb, total / 2);
  assert_int_equal(status_of("cut.glb"), 2);
}

/* KHR_mesh_quantization: shorts, normalized or not, four bytes apart from what they hold. */
static void test_quantized(void **state) {
  (void)state;
  const int16_t whole[16] = {0, 0, 0, 0, 32767, 0, 0, 0, 32767, 32767, 0, 0, -32768, 32767, 0, 0};
  const char rest[] = ",\"extensionsRequired\":[\"KHR_mesh_quantization\"]";
  const char views[] = ",{\"buffer\":0,\"byteOffset\":60,\"byteLength\":32,\"byteStride\":8}";
  struct document d = {.more = whole, .more_size = sizeof whole, .rest = rest, .views = views};
  d.position = "\"bufferView\":3,\"componentType\":5122,\"normalized\":true,\"count\":4,\"type\":\"VEC3\"";
  check("normalized.gltf", &d, 2, BOX(-1, 0, 0, 1, 1, 0));
  d.position = "\"bufferView\":3,\"componentType\":5122,\"count\":4,\"type\":\"VEC3\"";
  check("whole.gltf", &d, 2, BOX(-32768, 0, 0, 32767, 32767, 0));
  const uint8_t bytes[16] = {0, 0, 0, 9, 255, 0, 0, 9, 255, 51, 0, 9, 0, 51, 0, 9};
  d.more = bytes;
  d.more_size = sizeof bytes;
  d.views = ",{\"buffer\":0,\"byteOffset\":60,\"byteLength\":16,\"byteStride\":4}";
  d.position = "\"bufferView\":3,\"componentType\":5121,\"normalized\":true,\"count\":4,\"type\":\"VEC3\"";
  check("bytes.gltf", &d, 2, BOX(0, 0, 0, 1, 0.2, 0));
}

/* The third corner is put elsewhere; and all from nothing. */
static void test_sparse(void **state) {
  (void)state;
  struct {
    uint16_t place[2];
    float value[3];
  } more = {{2, 0}, {5, 6, 7}};
  const char views[] = ",{\"buffer\":0,\"byteOffset\":64,\"byteLength\":12}";
  struct document d = {.more = &more, .more_size = sizeof more, .views = views};
  d.position =
      "\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":"
      "{\"bufferView\":2,\"componentType\":5123},\"values\":{\"bufferView\":3}}";
  check("sparse.gltf", &d, 2, BOX(0, 0, 0, 5, 6, 7));
  more.place[0] = 4;
  write_gltf("behind.gltf", &d);
  assert_int_equal(status_of("behind.gltf"), 2);
}

/* Shapes move corners by their weights, the node's before the mesh's. */
static void test_shapes(void **state) {
  (void)state;
  const float up[12] = {0, 0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 2};
  struct document d = {.more = up,
                       .more_size = sizeof up,
                       .primitive = "\"targets\":[{\"POSITION\":2}],",
                       .accessors = ",{\"bufferView\":2,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}",
                       .mesh = ",\"weights\":[0.5]"};
  check("mesh.gltf", &d, 2, BOX(0, 0, 1, 1, 1, 1));
  d.nodes = "{\"mesh\":0,\"weights\":[1.5]}";
  check("node.gltf", &d, 2, BOX(0, 0, 3, 1, 1, 3));
  d.nodes = "{\"children\":[1,2]},{\"mesh\":0,\"weights\":[1.5]},{\"mesh\":0}";
  check("both.gltf", &d, 4, BOX(0, 0, 1, 1, 1, 3));
}

static void test_instances(void **state) {
  (void)state;
  const float more[6] = {0, 0, 0, 10, 20, 30};
  struct document d = {.more = more,
                       .more_size = sizeof more,
                       .accessors = ",{\"bufferView\":2,\"componentType\":5126,\"count\":2,\"type\":\"VEC3\"}",
                       .rest = ",\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"]"};
  d.nodes =
      "{\"mesh\":0,\"scale\":[2,2,2],\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":2}"
      "}}}";
  check("instances.gltf", &d, 4, BOX(0, 0, 0, 22, 42, 60));
}

/* A strip of four corners is two triangles, a fan of four too. */
static void test_strips(void **state) {
  (void)state;
  struct document d = {.primitive = "\"mode\":5,"};
  check("strip.gltf", &d, 3, BOX(0, 0, 0, 1, 1, 0)); /* of 012, 120, 202 and 023 three have an area */
  d.primitive = "\"mode\":1,";
  write_gltf("lines.gltf", &d);
  assert_int_equal(status_of("lines.gltf"), 2);
}

/* A joint at (4, 0, 3), bound at (1, 0, 0), moves the mesh by (3, 0, 3), wherever the mesh's own node is. */
static void test_joints(void **state) {
  (void)state;
  struct {
    uint8_t joints[4][4];
    float weights[4][4], bind[16];
  } more = {.weights = {{1}, {1}, {1}, {0.5f}},
            .bind = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1}}; /* sums other than 1 are made 1 */
  char primitive[8192], text[8192];
  struct document d = {
      .more = &more,
      .more_size = sizeof more,
      .nodes = "{\"children\":[1,2]},{\"mesh\":0,\"skin\":0,\"translation\":[9,9,9]},{\"translation\":[4,0,3]}",
      .accessors = ",{\"bufferView\":2,\"componentType\":5121,\"count\":4,\"type\":\"VEC4\"},"
                   "{\"bufferView\":2,\"byteOffset\":16,\"componentType\":5126,\"count\":4,\"type\":\"VEC4\"},"
                   "{\"bufferView\":2,\"byteOffset\":80,\"componentType\":5126,\"count\":1,\"type\":\"MAT4\"}",
      .rest = ",\"skins\":[{\"joints\":[2],\"inverseBindMatrices\":4}]"};
  make("joints.gltf", &d, primitive, sizeof primitive);
  char *at = strstr(primitive, "\"POSITION\":0");
  assert_non_null(at);
  int size = snprintf(text, sizeof text, "%.*s\"JOINTS_0\":2,\"WEIGHTS_0\":3,%s", (int)(at - primitive), primitive, at);
  write_bytes("joints.gltf", text, (size_t)size);
  check_bounds("joints.gltf", 2, BOX(3, 0, 3, 4, 1, 3));
}

/* What a file needs and cannot have is refused; what no surface depends on is not. */
static void test_required(void **state) {
  (void)state;
  static const struct {
    const char *name;
    int status;
  } cases[] = {{"KHR_draco_mesh_compression", 2}, {"EXT_meshopt_compression", 2}, {"VENDOR_thing", 2},
               {"KHR_texture_basisu", 0},         {"KHR_materials_unlit", 0},     {"KHR_lights_punctual", 0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char rest[128];
    snprintf(rest, sizeof rest, ",\"extensionsRequired\":[\"%s\"]", cases[i].name);
    write_gltf("required.gltf", &(struct document){.rest = rest});
    assert_int_equal(status_of("required.gltf"), cases[i].status);
  }
}

/* Deep trees are drawn whole; circles and files that stand for more than anybody can draw end soon. */
static void test_trees(void **state) {
  (void)state;
  enum { DEEP = 5000, ROOM = 64 * DEEP };
  char *nodes = malloc(ROOM), *text = malloc(2 * ROOM);
  assert_true(nodes && text);
  size_t length = 0;
  for (int i = 0; i < DEEP; i++)
    length += (size_t)snprintf(nodes + length, ROOM - length, "{\"translation\":[0.5,0,0],\"children\":[%d]},", i + 1);
  snprintf(nodes + length, ROOM - length, "{\"mesh\":0}");
  struct document d = {.nodes = nodes};
  write_bytes("deep.gltf", text, (size_t)make("deep.gltf", &d, text, 2 * ROOM));
  check_bounds("deep.gltf", 2, BOX(2500, 0, 0, 2501, 1, 0));
  length = 0;
  for (int i = 0; i < 40; i++)
    length += (size_t)snprintf(nodes + length, ROOM - length, "{\"children\":[%d,%d]},", i + 1, i + 1);
  snprintf(nodes + length, ROOM - length, "{\"mesh\":0}");
  write_gltf("bomb.gltf", &d);
  assert_int_equal(status_of("bomb.gltf"), 2);
  snprintf(nodes + length, ROOM - length, "{}");
  write_gltf("nothing.gltf", &d);
  assert_int_equal(status_of("nothing.gltf"), 2);
  free(nodes);
  free(text);
  write_gltf("circle.gltf", &(struct document){.nodes = "{\"children\":[1]},{\"children\":[0]}"});
  assert_int_equal(status_of("circle.gltf"), 2);
  write_gltf("nobody.gltf", &(struct document){.nodes = "{\"mesh\":0,\"children\":[7]}"});
  assert_int_equal(status_of("nobody.gltf"), 2);
}

/* KHR_texture_transform, by the formula of its specification: scaled, then turned, then moved, v downwards. */
static void test_texture_transform(void **state) {
  (void)state;
  const float uv[8] = {0, 1, 1, 1, 1, 0, 0, 0}; /* of corner k, v downwards */
  const uint8_t pixel[16] = {255, 255, 255, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255};
  const double sx = 2, sy = 3, angle = 0.5, ox = 0.1, oy = 0.7;
  char text[8192], moved[8192];
  assert_int_equal(png_write("a.png", 2, 2, 4, pixel), 0);
  struct document d = {.more = uv,
                       .more_size = sizeof uv,
                       .primitive = "\"material\":0,",
                       .accessors = ",{\"bufferView\":2,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"}",
                       .rest = ",\"images\":[{\"uri\":\"a.png\"}],\"textures\":[{\"source\":0}],\"materials\":[{"
                               "\"alphaMode\":\"MASK\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,"
                               "\"extensions\":{\"KHR_texture_transform\":{\"offset\":[0.1,0.7],\"scale\":[2,3],"
                               "\"rotation\":0.5}}}}}]"};
  make("moved.gltf", &d, text, sizeof text);
  char *at = strstr(text, "\"POSITION\":0");
  assert_non_null(at);
  int size = snprintf(moved, sizeof moved, "%.*s\"TEXCOORD_0\":2,%s", (int)(at - text), text, at);
  write_bytes("moved.gltf", moved, (size_t)size);
  struct scene_request request = {.name = "moved.gltf", .ground = GROUND_OFF};
  struct scene *scene = NULL;
  assert_int_equal(scene_load(&request, &scene), 0);
  const struct mesh *mesh = &scene->meshes[0];
  assert_int_equal(mesh->texture, 0);
  for (uint32_t i = 0; i < mesh->vertex_count; i++) {
    double u = 0, v = 0, x = mesh->bounds_max[0], y = mesh->bounds_max[1];
    u = mesh->positions[3 * i] >= x ? 1 : 0; /* the square's own coordinates, as uv[] has them */
    v = mesh->positions[3 * i + 1] >= y ? 0 : 1;
    double wanted_u = ox + cos(angle) * sx * u + sin(angle) * sy * v;
    double wanted_v = oy - sin(angle) * sx * u + cos(angle) * sy * v;
    assert_true(fabs((double)mesh->texcoords[2 * i] - wanted_u) < 1e-5);
    assert_true(fabs((double)mesh->texcoords[2 * i + 1] - (1 - wanted_v)) < 1e-5);
  }
  scene_free(&scene);
}

/* Twenty materials with one picture are one texture. */
static void test_shared_picture(void **state) {
  (void)state;
  enum { MATERIALS = 20 };
  const float uv[8] = {0, 1, 1, 1, 1, 0, 0, 0};
  char rest[4096] = ",\"images\":[{\"uri\":\"a.png\"}],\"textures\":[{\"source\":0}],\"materials\":[";
  char nodes[2048] = "{\"children\":[1]},{\"mesh\":0}", text[8192], whole[16384] = "";
  for (int i = 0; i < MATERIALS; i++)
    strcat(rest, i ? ",{\"alphaMode\":\"MASK\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}"
                   : "{\"alphaMode\":\"MASK\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}");
  strcat(rest, "]");
  const uint8_t pixel[8] = {255, 255, 255, 0, 255, 255, 255, 255};
  assert_int_equal(png_write("a.png", 2, 1, 4, pixel), 0);
  struct document d = {.more = uv,
                       .more_size = sizeof uv,
                       .nodes = nodes,
                       .accessors = ",{\"bufferView\":2,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"}",
                       .rest = rest};
  make("many.gltf", &d, text, sizeof text);
  const char *at = strstr(text, "{ \"attributes\""), *end = at ? strchr(at, ']') : NULL;
  assert_non_null(end);
  size_t length = (size_t)snprintf(whole, sizeof whole, "%.*s", (int)(at - text), text);
  for (int i = 0; i < MATERIALS; i++)
    length += (size_t)snprintf(whole + length, sizeof whole - length,
                               "%s{\"material\":%d,\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":2},\"indices\":1}",
                               i ? "," : "", i);
  length += (size_t)snprintf(whole + length, sizeof whole - length, "%s", end);
  write_bytes("many.gltf", whole, length);
  struct scene_request request = {.name = "many.gltf", .ground = GROUND_OFF};
  struct scene *scene = NULL;
  assert_int_equal(scene_load(&request, &scene), 0);
  assert_int_equal(scene->mesh_count, MATERIALS);
  assert_int_equal(scene->texture_count, 1);
  scene_free(&scene);
}

int main(int argc, char **argv) {
  import_serve(argc, argv);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_containers),     cmocka_unit_test(test_quantized),         cmocka_unit_test(test_sparse),
      cmocka_unit_test(test_shapes),         cmocka_unit_test(test_instances),         cmocka_unit_test(test_strips),
      cmocka_unit_test(test_joints),         cmocka_unit_test(test_required),          cmocka_unit_test(test_trees),
      cmocka_unit_test(test_shared_picture), cmocka_unit_test(test_texture_transform),
  };
  return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
