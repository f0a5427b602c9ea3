/* What debuggers of GL see: every object of the library's has a name, every draw lies in a named group, every shader
 * says what it was put together from. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "host.h"

enum { WIDTH = 48, HEIGHT = 36 };

static host h;

/* ---- a loader that listens --------------------------------------------------------------------------------------- */

enum { OBJECTS = 4096 };

typedef struct {
  GLenum kind;
  GLuint name;
  int labelled;
} object;

static object objects[OBJECTS];
static int object_count, made, unlabelled, odd_labels;
static int groups, deepest, draws, draws_outside, odd_groups;
static int sources, odd_sources;

static void note_made(GLenum kind, GLsizei count, const GLuint *names) {
  for (GLsizei i = 0; i < count; i++, made++) {
    assert_true(object_count < OBJECTS);
    objects[object_count++] = (object){kind, names[i], 0};
  }
}

static object *find_object(GLenum kind, GLuint name) {
  for (int i = 0; i < object_count; i++)
    if (objects[i].kind == kind && objects[i].name == name) return &objects[i];
  return NULL;
}

static void note_gone(GLenum kind, GLsizei count, const GLuint *names) {
  for (GLsizei i = 0; i < count; i++) {
    object *o = find_object(kind, names[i]);
    if (!o) continue;
    if (!o->labelled) {
      fprintf(stderr, "0x%x %u went without a label\n", kind, names[i]);
      unlabelled++;
    }
    *o = objects[--object_count];
  }
}

static int ours(const char *text, GLsizei length) {
  return length > 9 && (size_t)length == strlen(text) && strncmp(text, "penumbra ", 9) == 0 && !strchr(text, '\n');
}

#define LISTEN_NAMES(X) \
  X(Textures, GL_TEXTURE) \
  X(Buffers, GL_BUFFER) \
  X(Framebuffers, GL_FRAMEBUFFER) X(VertexArrays, GL_VERTEX_ARRAY) X(Samplers, GL_SAMPLER) X(Queries, GL_QUERY)

#define X(Kind, kind) \
  static void APIENTRY gen_##Kind(GLsizei count, GLuint *names) { \
    gl.Gen##Kind(count, names); \
    note_made(kind, count, names); \
  } \
  static void APIENTRY delete_##Kind(GLsizei count, const GLuint *names) { \
    note_gone(kind, count, names); \
    gl.Delete##Kind(count, names); \
  }
LISTEN_NAMES(X)
#undef X

static GLuint APIENTRY create_program(void) {
  GLuint name = gl.CreateProgram();
  note_made(GL_PROGRAM, 1, &name);
  return name;
}

static void APIENTRY delete_program(GLuint name) {
  note_gone(GL_PROGRAM, 1, &name);
  gl.DeleteProgram(name);
}

static PFNGLOBJECTLABELPROC real_label;
static void APIENTRY object_label(GLenum kind, GLuint name, GLsizei length, const GLchar *text) {
  object *o = find_object(kind, name);
  if (o) o->labelled = 1;
  if (!ours(text, length)) {
    fprintf(stderr, "label '%s'\n", text);
    odd_labels++;
  }
  real_label(kind, name, length, text);
}

static void APIENTRY push_group(GLenum source, GLuint id, GLsizei length, const GLchar *text) {
  groups++;
  if (groups > deepest) deepest = groups;
  if (!ours(text, length) || source != GL_DEBUG_SOURCE_THIRD_PARTY) odd_groups++;
  gl.PushDebugGroup(source, id, length, text);
}

static void APIENTRY pop_group(void) {
  groups--;
  gl.PopDebugGroup();
}

static void note_draw(void) {
  draws++;
  draws_outside += groups < 1;
}

static PFNGLDRAWARRAYSINDIRECTPROC real_indirect;
static PFNGLCLEARBUFFERUIVPROC real_clear_integers;
static void APIENTRY draw_arrays(GLenum mode, GLint first, GLsizei count) {
  note_draw();
  gl.DrawArrays(mode, first, count);
}
static void APIENTRY draw_elements(GLenum mode, GLsizei count, GLenum type, const void *at) {
  note_draw();
  gl.DrawElements(mode, count, type, at);
}
static void APIENTRY draw_indirect(GLenum mode, const void *at) {
  note_draw();
  real_indirect(mode, at);
}
static void APIENTRY clear_floats(GLenum buffer, GLint index, const GLfloat *values) {
  note_draw();
  gl.ClearBufferfv(buffer, index, values);
}
static void APIENTRY clear_integers(GLenum buffer, GLint index, const GLuint *values) {
  note_draw();
  real_clear_integers(buffer, index, values);
}
static void APIENTRY blit(GLint a, GLint b, GLint c, GLint d, GLint e, GLint f, GLint g, GLint i, GLbitfield mask,
                          GLenum filter) {
  note_draw();
  gl.BlitFramebuffer(a, b, c, d, e, f, g, i, mask, filter);
}

/* ---- texts ------------------------------------------------------------------------------------------------------- */

/* The first line names files, and every define that follows it. */
static int headed(const char *text) {
  char heading[4096];
  size_t length = strcspn(text, "\n");
  if (strncmp(text, "// penumbra: ", 13) != 0 || length >= sizeof heading) return 0;
  memcpy(heading, text, length);
  heading[length] = 0;
  if (!strstr(heading, ".glsl")) return 0;
  for (text += length + 1; strncmp(text, "#define ", 8) == 0; text += length + 1) {
    char line[256];
    length = strcspn(text, "\n");
    snprintf(line, sizeof line, "%.*s", (int)(length - 8), text + 8);
    if (!strstr(heading, line)) return 0;
  }
  return 1;
}

static void APIENTRY shader_source(GLuint shader, GLsizei count, const GLchar *const *parts, const GLint *lengths) {
  static const char version[] = "#version 330 core\n";
  size_t bytes = 1;
  assert_null(lengths);
  for (GLsizei i = 0; i < count; i++) bytes += strlen(parts[i]);
  char *text = calloc(bytes, 1);
  for (GLsizei i = 0; i < count; i++) strcat(text, parts[i]);
  sources++;
  if (strncmp(text, version, sizeof version - 1) != 0 || !headed(text + sizeof version - 1)) {
    fprintf(stderr, "a shader begins with\n%.200s\n", text);
    odd_sources++;
  }
  free(text);
  gl.ShaderSource(shader, count, parts, lengths);
}

/* ---- the loader -------------------------------------------------------------------------------------------------- */

typedef union {
  void (*function)(void);
  void *object;
} pointer;

typedef struct {
  const char *name;
  void (*function)(void);
} listener;

#define LISTENER(name, function) \
  { name, (void (*)(void))function }

static const listener listeners[] = {
#define X(Kind, kind) LISTENER("glGen" #Kind, gen_##Kind), LISTENER("glDelete" #Kind, delete_##Kind),
    LISTEN_NAMES(X)
#undef X
        LISTENER("glCreateProgram", create_program),
    LISTENER("glDeleteProgram", delete_program),
    LISTENER("glObjectLabel", object_label),
    LISTENER("glPushDebugGroup", push_group),
    LISTENER("glPopDebugGroup", pop_group),
    LISTENER("glDrawArrays", draw_arrays),
    LISTENER("glDrawElements", draw_elements),
    LISTENER("glDrawArraysIndirect", draw_indirect),
    LISTENER("glClearBufferfv", clear_floats),
    LISTENER("glClearBufferuiv", clear_integers),
    LISTENER("glBlitFramebuffer", blit),
    LISTENER("glShaderSource", shader_source),
};

static void *listening_address(void *user, const char *name) {
  for (size_t i = 0; i < sizeof listeners / sizeof *listeners; i++) {
    pointer p = {listeners[i].function};
    if (strcmp(listeners[i].name, name) == 0) return p.object;
  }
  return gl_address(user, name);
}

/* ---- a frame with everything ------------------------------------------------------------------------------------- */

static pn_state_mode mode;
static camera view;
static depth_target target;

static void open_context(void) {
  pn_context_desc desc = host_context_desc(&h);
  desc.get_proc_address = listening_address;
  desc.state = mode;
  object_count = made = unlabelled = odd_labels = groups = deepest = draws = draws_outside = odd_groups = 0;
  sources = odd_sources = 0;
  assert_int_equal(pn_context_create(&desc, &h.context), PN_OK);
}

/* A call of the library's: no group is left open after it. */
#define CALL(call) \
  do { \
    assert_int_equal(call, PN_OK); \
    assert_int_equal(groups, 0); \
  } while (0)

static void draw_one(const char *spec, pn_receiver *receiver, pn_fit fit) {
  pn_light *light = NULL;
  pn_light_desc desc = host_light_desc();
  desc.map_width = 32;
  desc.fit = fit;
  CALL(host_light(&h, &desc, spec, &light));
  CALL(pn_maps_update(light, h.casters, PN_GROUPS_ALL, &receiver, 1));
  CALL(pn_visibility(light, receiver));
  CALL(pn_maps_update(light, h.casters, 0, &receiver, 1)); /* nothing casts */
  CALL(pn_visibility(light, receiver));
  pn_light_destroy(&light);
  assert_int_equal(groups, 0);
}

/* Meshes from memory and from buffers, timed, with debug images, at two scales, from a texture and from a framebuffer.
 * */
static void draw_all(void) {
  pn_receiver *receiver = NULL;
  CALL(pn_timing(h.context, 1));
  CALL(pn_debug(h.context, PN_DEBUG_SEARCH | PN_DEBUG_BOUND));
  CALL(pn_receiver_create(h.context, &receiver));
  for (int i = 0; host_spec(i); i++) {
    pn_receiver_desc desc = host_receiver_desc(&view, &target);
    desc.scale = 1 + i % 2;
    if (i % 3 == 2) desc.depth_texture = 0, desc.depth_framebuffer = target.framebuffer, desc.use_framebuffer = 1;
    CALL(host_cast(&h, i % 2 ? CAST_BUFFERS : CAST_MEMORY));
    CALL(pn_receiver_set(receiver, &desc));
    draw_one(host_spec(i), receiver, i % 2 ? PN_FIT_VISIBLE : PN_FIT_CASTERS);
    host_uncast(&h);
    assert_int_equal(groups, 0);
  }
  CALL(pn_prepare(h.context, "hard", NULL));
  pn_receiver_destroy(&receiver);
  assert_int_equal(groups, 0);
}

static int has_labels(void) { return gl.PushDebugGroup && (gl_version() >= 43 || gl_has("GL_KHR_debug")); }

/* ---- the tests --------------------------------------------------------------------------------------------------- */

static void test_objects(void **state) {
  (void)state;
  if (!has_labels()) skip();
  open_context();
  draw_all();
  for (int i = 0; i < object_count; i++) {
    if (objects[i].labelled) continue;
    fprintf(stderr, "0x%x %u has no label\n", objects[i].kind, objects[i].name);
    unlabelled++;
  }
  printf("%d objects were made, %d are left\n", made, object_count);
  assert_true(made > 100);
  assert_int_equal(unlabelled, 0);
  assert_int_equal(odd_labels, 0);
  pn_context_destroy(&h.context);
  assert_int_equal(object_count, 0); /* the same list shows that every object goes */
  assert_int_equal(unlabelled, 0);
}

/* GL has the label too. */
static void test_result(void **state) {
  (void)state;
  if (!has_labels() || !gl.GetObjectLabel) skip();
  lit_view lit;
  pn_light_desc desc = host_light_desc();
  pn_image image;
  char text[64] = "";
  open_context();
  assert_int_equal(host_lit_view(&h, CAST_MEMORY, &desc, "hard", &lit), PN_OK);
  free(host_visibility(&h, lit.light, &lit.v));
  assert_int_equal(pn_result_image(lit.light, lit.v.receiver, &image), PN_OK);
  gl.GetObjectLabel(GL_TEXTURE, image.texture, sizeof text, NULL, text);
  assert_string_equal(text, "penumbra visibility");
  host_lit_view_close(&h, &lit);
}

static void test_groups(void **state) {
  (void)state;
  if (!has_labels()) skip();
  static const pn_state_mode modes[3] = {PN_STATE_RESTORE, PN_STATE_SCOPED, PN_STATE_RESET};
  for (int i = 0; i < 3; i++) {
    mode = modes[i];
    open_context();
    assert_int_equal(pn_state_begin(h.context), PN_OK);
    draw_all();
    assert_int_equal(pn_state_end(h.context), PN_OK);
    printf("mode %d: %d draws and clears\n", i, draws);
    assert_true(draws > 200);
    assert_int_equal(draws_outside, 0);
    assert_int_equal(odd_groups, 0);
    assert_int_equal(deepest, 1);
    pn_context_destroy(&h.context);
  }
}

/* ---- a host that uses groups itself ------------------------------------------------------------------------------ */

static GLint stack_depth(void) {
  GLint depth = 0;
  gl.GetIntegerv(GL_DEBUG_GROUP_STACK_DEPTH, &depth);
  return depth;
}

static int fill_stack(int room) {
  GLint most = 0;
  int pushed = 0;
  gl.GetIntegerv(GL_MAX_DEBUG_GROUP_STACK_DEPTH, &most);
  for (; stack_depth() < most - room; pushed++) gl.PushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, "the host's");
  return pushed;
}

static void empty_stack(int pushed) {
  for (; pushed > 0; pushed--) gl.PopDebugGroup();
}

static void check_full(int room, int before_context) {
  int pushed = before_context ? fill_stack(room) : 0;
  open_context();
  if (!before_context) pushed = fill_stack(room);
  GLint depth = stack_depth();
  assert_int_equal(pn_state_begin(h.context), PN_OK);
  draw_all();
  assert_int_equal(pn_state_end(h.context), PN_OK);
  assert_int_equal(stack_depth(), depth);
  assert_int_equal(gl_errors(), 0);
  assert_int_equal(deepest, room > 0);
  pn_context_destroy(&h.context);
  assert_int_equal(stack_depth(), depth);
  empty_stack(pushed);
}

/* Its groups stay open through every call; where there is no room for one more, the library's are left out. */
static void test_full_stack(void **state) {
  (void)state;
  if (!has_labels()) skip();
  for (int room = 0; room < 2; room++) {
    mode = PN_STATE_RESTORE;
    check_full(room, 0);
    mode = PN_STATE_SCOPED;
    check_full(room, 0);
    mode = PN_STATE_RESET;
    check_full(room, 1);
  }
}

/* ---- texts ------------------------------------------------------------------------------------------------------- */

static void test_headings(void **state) {
  (void)state;
  open_context();
  draw_all();
  assert_true(sources > 50);
  assert_int_equal(odd_sources, 0);
  for (int i = 0; i < pn_technique_count(); i++) {
    const pn_technique *t = pn_technique_at(i);
    const char *text = t->forward ? pn_glsl(h.context, t->name, 330, 0) : NULL;
    if (t->forward) assert_true(text && headed(text));
  }
  assert_true(headed(pn_glsl(h.context, "caster", 330, 0)));
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static int setup(void **state) {
  (void)state;
  if (!host_open(&h)) exit(77);
  pointer label = {.object = gl_address(NULL, "glObjectLabel")},
          indirect = {.object = gl_address(NULL, "glDrawArraysIndirect")};
  pointer clear = {.object = gl_address(NULL, "glClearBufferuiv")};
  real_label = (PFNGLOBJECTLABELPROC)label.function;
  real_indirect = (PFNGLDRAWARRAYSINDIRECTPROC)indirect.function;
  real_clear_integers = (PFNGLCLEARBUFFERUIVPROC)clear.function;
  view = camera_sized(0, WIDTH, HEIGHT);
  if (!target_open(&target, &view)) return -1;
  renderer_depth(&h.draw, &h.world, &view, &target);
  return gl_errors();
}

static int teardown(void **state) {
  (void)state;
  target_close(&target);
  host_close(&h);
  return 0;
}

static int clean(void **state) {
  (void)state;
  mode = PN_STATE_RESTORE;
  pn_context_destroy(&h.context);
  h.casters = NULL;
  return gl_errors();
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(test_objects, clean),  cmocka_unit_test_teardown(test_result, clean),
      cmocka_unit_test_teardown(test_groups, clean),   cmocka_unit_test_teardown(test_full_stack, clean),
      cmocka_unit_test_teardown(test_headings, clean),
  };
  return cmocka_run_group_tests_name("labels", tests, setup, teardown);
}
