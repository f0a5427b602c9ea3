/* The uniform block: what C writes into it lies where the compiler of maps/maps.glsl looks for it. And the other
 * numbers that are written down twice, in C and in GLSL. */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gather/gather.h"
#include "gl/source.h"
#include "maps/list.h"
#include "silhouettes/mesh_edges.h"
#include "stage.h"
#include "techniques/registry.h"

/* ---- a program that has the block -------------------------------------------------------------------------------- */

static GLuint program_of(int lights) {
  pni_gpu none = {0}; /* the embedded sources, the C library's memory */
  const char *paths[] = {"maps/maps.glsl", NULL};
  char defines[32], *text = NULL;
  static const char body[] =
      "layout(location = 0) out vec4 result;\n"
      "void main() { result = vec4(pn_parameter(0, 0), pn_map_w(PN_LIGHTS - 1, 0, 0.5), 0.0, 1.0); }\n";
  snprintf(defines, sizeof defines, "PN_LIGHTS %d\n", lights);
  assert_ok(pni_shader_text(&none, paths, defines, &text));
  size_t bytes = strlen(text) + sizeof body;
  char *fragment = malloc(bytes);
  snprintf(fragment, bytes, "%s%s", text, body);
  GLuint program = gl_program("void main() { gl_Position = vec4(0.0, 0.0, 0.0, 1.0); }\n", fragment);
  free(fragment);
  free(text);
  assert_true(program != 0);
  return program;
}

static GLint uniform(GLuint program, const char *name, GLenum what) {
  GLuint index = GL_INVALID_INDEX;
  GLint value = -1;
  glGetUniformIndices(program, 1, &name, &index);
  if (index == GL_INVALID_INDEX) fail_msg("the block has no %s", name);
  glGetActiveUniformsiv(program, 1, &index, what, &value);
  return value;
}

/* ---- members ----------------------------------------------------------------------------------------------------- */

typedef struct {
  const char *name;
  size_t offset, bytes;
} member;

#define MEMBER(type, name) \
  { #name, offsetof(type, name), sizeof(((type *)NULL)->name) }

static const member of_light[] = {
    MEMBER(pni_light_block, scene_u),   MEMBER(pni_light_block, scene_v),      MEMBER(pni_light_block, scene_z),
    MEMBER(pni_light_block, scene_error), MEMBER(pni_light_block, extent), MEMBER(pni_light_block, parallel),
    MEMBER(pni_light_block, w_reach), MEMBER(pni_light_block, map_count), MEMBER(pni_light_block, w_near),
    MEMBER(pni_light_block, w_far), MEMBER(pni_light_block, w_error), MEMBER(pni_light_block, raster_error),
    MEMBER(pni_light_block, layers), MEMBER(pni_light_block, texel), MEMBER(pni_light_block, parameters),
};

static const member of_map[] = {
    MEMBER(pni_map_block, origin),      MEMBER(pni_map_block, density), MEMBER(pni_map_block, w_of_depth),
    MEMBER(pni_map_block, light_point), MEMBER(pni_map_block, size),    MEMBER(pni_map_block, first_layer),
    MEMBER(pni_map_block, layers),
};

#define COUNT(table) (int)(sizeof table / sizeof *table)

/* No member of the C struct is left out of the tables above: they end where the next one begins. */
static void test_tables(void **state) {
  (void)state;
  size_t at = 0;
  for (int i = 0; i < COUNT(of_light); at += of_light[i++].bytes) assert_int_equal(of_light[i].offset, at);
  assert_int_equal(at, offsetof(pni_light_block, maps));
  at = 0;
  for (int i = 0; i < COUNT(of_map); at += of_map[i++].bytes) assert_int_equal(of_map[i].offset, at);
  assert_int_equal(at, sizeof(pni_map_block));
}

/* Bytes of a float, of a vec2, of a vec4: what a member of C may be. */
static size_t type_bytes(GLenum type) {
  return type == GL_FLOAT ? 4 : type == GL_FLOAT_VEC2 ? 8 : type == GL_FLOAT_VEC4 ? 16 : 0;
}

static void check_member(GLuint program, const char *prefix, const member *m, size_t base) {
  char name[80];
  bool array = !strcmp(m->name, "parameters");
  snprintf(name, sizeof name, "%s.%s%s", prefix, m->name, array ? "[0]" : "");
  GLint offset = uniform(program, name, GL_UNIFORM_OFFSET), size = uniform(program, name, GL_UNIFORM_SIZE);
  size_t bytes = type_bytes((GLenum)uniform(program, name, GL_UNIFORM_TYPE)) * (size_t)size;
  if ((size_t)offset != base + m->offset || bytes != m->bytes)
    fail_msg("%s: %zu bytes at %d in GLSL, %zu at %zu in C", name, bytes, offset, m->bytes, base + m->offset);
  if (array) assert_int_equal(uniform(program, name, GL_UNIFORM_ARRAY_STRIDE), 16);
}

static void check_light(GLuint program, int light) {
  char prefix[40];
  size_t base = (size_t)light * sizeof(pni_light_block);
  snprintf(prefix, sizeof prefix, "pn_lights[%d]", light);
  for (int i = 0; i < COUNT(of_light); i++) check_member(program, prefix, &of_light[i], base);
  for (int map = 0; map < PNI_MAPS_MAX; map++) {
    snprintf(prefix, sizeof prefix, "pn_lights[%d].maps[%d]", light, map);
    size_t at = base + offsetof(pni_light_block, maps) + (size_t)map * sizeof(pni_map_block);
    for (int i = 0; i < COUNT(of_map); i++) check_member(program, prefix, &of_map[i], at);
  }
}

static void test_offsets(void **state) {
  (void)state;
  static const int lights[2] = {1, PN_FORWARD_LIGHTS_MAX};
  for (int k = 0; k < 2; k++) {
    GLuint program = program_of(lights[k]);
    GLint bytes = 0, members = 0;
    for (int light = 0; light < lights[k]; light++) check_light(program, light);
    GLuint block = glGetUniformBlockIndex(program, "pn_block");
    glGetActiveUniformBlockiv(program, block, GL_UNIFORM_BLOCK_DATA_SIZE, &bytes);
    glGetActiveUniformBlockiv(program, block, GL_UNIFORM_BLOCK_ACTIVE_UNIFORMS, &members);
    assert_int_equal(bytes, lights[k] * (int)sizeof(pni_light_block));
    /* GLSL has no member that C has not. */
    assert_int_equal(members, lights[k] * (COUNT(of_light) + PNI_MAPS_MAX * COUNT(of_map)));
    glDeleteProgram(program);
  }
}

/* One map more, one parameter more would be outside of it. */
static void test_sizes(void **state) {
  (void)state;
  GLuint program = program_of(1);
  const char *beyond = "pn_lights[0].maps[16].origin";
  GLuint index = 0;
  assert_int_equal(PNI_MAPS_MAX, 16);
  glGetUniformIndices(program, 1, &beyond, &index);
  assert_int_equal(index, GL_INVALID_INDEX);
  assert_int_equal(4 * uniform(program, "pn_lights[0].parameters[0]", GL_UNIFORM_SIZE), PNI_PARAMETERS_MAX);
  glDeleteProgram(program);
}

/* GL promises 16384 bytes for a block. */
static void test_block_fits(void **state) {
  (void)state;
  assert_true(PN_FORWARD_LIGHTS_MAX * sizeof(pni_light_block) <= 16384);
}

/* ---- tables of techniques ---------------------------------------------------------------------------------------- */

static void test_parameters_fit(void **state) {
  (void)state;
  for (int i = 0; i < pn_technique_count(); i++) {
    const pni_technique_class *c = pni_technique_class_of(pn_technique_at(i));
    const pn_technique *t = &c->table;
    double values[PNI_PARAMETERS_MAX] = {0};
    char defines[PNI_TECHNIQUE_DEFINES];
    assert_in_range(t->parameter_count, 0, PNI_PARAMETERS_MAX);
    for (int k = 0; k < t->parameter_count; k++) values[k] = t->parameters[k].initial;
    pni_gather_defines(&c->gathering, t, values, defines);
    assert_true(strlen(defines) < sizeof defines / 2);
    pni_maps_want want;
    c->want(values, &want);
    assert_in_range(pni_want_layers(&want), 0, PNI_LAYERS_MAX + 1);
  }
}

/* ---- tables of edges --------------------------------------------------------------------------------------------- */

static int defined(const char *name) {
  const char *at = strstr(pni_edge_defines, name);
  assert_non_null(at);
  return atoi(at + strlen(name));
}

static void test_rows(void **state) {
  (void)state;
  assert_int_equal(defined("PN_EDGE_ROW "), PNI_EDGE_ROW);
  assert_int_equal(defined("PN_POSITION_ROW "), PNI_POSITION_ROW);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_tables), cmocka_unit_test(test_parameters_fit),
                                     cmocka_unit_test(test_rows), cmocka_unit_test(test_block_fits)};
  const struct CMUnitTest with_gl[] = {cmocka_unit_test(test_offsets), cmocka_unit_test(test_sizes)};
  int failed = cmocka_run_group_tests_name("block", tests, NULL, NULL), gl = GL_RUN("block in GLSL", with_gl);
  return failed ? failed : gl;
}
