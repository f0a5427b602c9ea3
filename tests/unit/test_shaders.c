/* Every program the library can make, assembled and given to glslangValidator as GLSL 330, without and with gathers,
 * and as GLSL ES 300. */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "context.h"
#include "gl/embedded.h"
#include "gl/source.h"
#include "stage.h"
#include "silhouettes/mesh_edges.h"
#include "techniques/registry.h"

/* ---- the list of programs ---- */

typedef struct {
  char *vertex, *fragment, *more, *defines;
} program_key;
static program_key *keys;
static int key_count;

static char *copy_of(const char *text) { return strcpy(malloc(strlen(text) + 1), text); }

static void add_key(const char *vertex, const char *fragment, const char *more, const char *defines) {
  for (int i = 0; i < key_count; i++)
    if (!strcmp(keys[i].vertex, vertex) && !strcmp(keys[i].fragment, fragment) && !strcmp(keys[i].more, more) &&
        !strcmp(keys[i].defines, defines))
      return;
  keys = realloc(keys, (size_t)(key_count + 1) * sizeof *keys);
  keys[key_count++] = (program_key){copy_of(vertex), copy_of(fragment), copy_of(more), copy_of(defines)};
}

static const char *const screen = "shaders/screen.vert.glsl";

static void add_gathering(const char *shader, const char *own, int normals, int mask, int upsample, int area,
                          int debug) {
  char defines[PNI_TECHNIQUE_DEFINES + 128];
  snprintf(defines, sizeof defines, "%sPN_NORMALS %d\nPN_MASK %d\nPN_UPSAMPLE %d\nPN_AREA %d\nPN_DEBUG %d\n", own,
           normals, mask, upsample, area, debug);
  add_key(screen, "gather/visibility.glsl", shader, defines);
}

/* One set of a technique's defines: with every kind of receiver for the default one; the kinds do not look at the
 * technique's defines. */
static void add_variant(const pni_technique_class *c, const char *own, bool full) {
  for (int i = 0; i < 40; i++) {
    int normals = i % 5, mask = i / 5 & 1, upsample = i / 10 & 1, debug = i / 20;
    if (debug && (upsample || !c->gathering.searches)) continue;
    if (full || i % 20 == 0) add_gathering(c->gathering.shader, own, normals, mask, upsample, 0, debug);
    bool smooths = !strcmp(c->table.name, "bitmask") && !upsample;
    if (smooths && (full || i % 20 == 0)) add_gathering(c->gathering.shader, own, normals, mask, 0, 1, debug);
  }
  char defines[PNI_TECHNIQUE_DEFINES + 32];
  snprintf(defines, sizeof defines, "PN_LIGHTS %d\n%s", PN_FORWARD_LIGHTS_MAX, own);
  add_key("", "shaders/forward.glsl", c->gathering.shader, defines);
}

static int value_count(const pn_parameter *p) {
  return p->type == PN_CHOICE || p->type == PN_BOOL ? (int)p->most + 1 : 3;
}

static double value_at(const pn_parameter *p, int i) {
  if (p->type == PN_CHOICE || p->type == PN_BOOL) return i;
  return i == 0 ? p->least : i == 1 ? p->initial : p->most;
}

/* Whatever its parameters can be: every choice, and the ends of every range. */
static void add_technique(const pni_technique_class *c) {
  enum { VARIANTS = 1024 };
  static char seen[VARIANTS][PNI_TECHNIQUE_DEFINES];
  const pn_technique *t = &c->table;
  int count = 1, place[PNI_PARAMETERS_MAX] = {0}, at = 0;
  double values[PNI_PARAMETERS_MAX] = {0};
  for (int i = 0; i < t->parameter_count; i++) values[i] = t->parameters[i].initial;
  pni_gather_defines(&c->gathering, t, values, seen[0]);
  add_variant(c, seen[0], true);
  while (at < t->parameter_count) {
    for (int i = 0; i < t->parameter_count; i++) values[i] = value_at(&t->parameters[i], place[i]);
    pni_gather_defines(&c->gathering, t, values, seen[count]);
    int known = 0;
    while (strcmp(seen[known], seen[count])) known++;
    if (known == count) {
      add_variant(c, seen[count], false);
      assert_true(++count < VARIANTS);
    }
    for (at = 0; at < t->parameter_count && ++place[at] == value_count(&t->parameters[at]); at++) place[at] = 0;
  }
}

static void add_others(void) {
  char defines[128];
  for (int i = 0; i < 8; i++) {
    snprintf(defines, sizeof defines, "PN_ALPHA %d\nPN_PEEL %d\nPN_FLOOR %d\n", i & 1, i >> 1 & 1, i >> 2);
    add_key("casters/caster.vert.glsl", "casters/caster.frag.glsl", "", defines);
  }
  for (int i = 0; i < 16; i++) {
    snprintf(defines, sizeof defines, "PN_FIRST %d\nPN_STACK %d\nPN_QUADS %d\nPN_CORNERS %d\n", i & 1, i >> 1 & 1,
             i >> 2 & 1, i >> 3);
    add_key(screen, "maps/range.frag.glsl", "", defines);
  }
  add_key(screen, "receiver/bounds.frag.glsl", "", "PN_FIRST 0\nPN_MASK 0\n");
  add_key(screen, "receiver/bounds.frag.glsl", "", "PN_FIRST 1\nPN_MASK 0\n");
  add_key(screen, "receiver/bounds.frag.glsl", "", "PN_FIRST 1\nPN_MASK 1\n");
  add_key(screen, "receiver/slopes.frag.glsl", "", "PN_MASK 0\n");
  add_key(screen, "receiver/slopes.frag.glsl", "", "PN_MASK 1\n");
  for (int i = 0; i < 4; i++) {
    snprintf(defines, sizeof defines, "PN_MASK %d\nPN_GIVEN %d\n", i & 1, i >> 1);
    add_key(screen, "receiver/patches.frag.glsl", "", defines);
  }
  add_key(screen, "gather/smooth.frag.glsl", "", "");
  add_key(screen, "maps/trim.frag.glsl", "", "");
  add_key(screen, "receiver/copy.frag.glsl", "", "");
  add_key(screen, "receiver/planes.frag.glsl", "", "");
  for (int i = 0; i < 10; i++) {
    snprintf(defines, sizeof defines, "PN_NORMALS %d\nPN_MASK %d\n", i % 5, i / 5);
    add_key(screen, "techniques/average/average.frag.glsl", "", defines);
  }
  add_key(screen, "techniques/average/resolve.frag.glsl", "", "");
  add_key(screen, "techniques/ssm/seen_range.frag.glsl", "", "");
  for (int i = 0; i < 20; i++) {
    snprintf(defines, sizeof defines, "PN_NORMALS %d\nPN_MASK %d\nPN_PEEL %d\n", i % 5, i / 5 & 1, i / 10);
    add_key("techniques/ssm/seen.vert.glsl", "techniques/ssm/seen.frag.glsl", "", defines);
    snprintf(defines, sizeof defines, "PN_NORMALS %d\nPN_MASK %d\nPN_BOUND %d\n", i % 5, i / 5 & 1, i / 10);
    add_key(screen, "techniques/ssm/lookup.frag.glsl", "", defines);
  }
  for (int i = 0; i < 2; i++) {
    for (int first = 0; first < 2; first++) {
      snprintf(defines, sizeof defines, "PN_FIRST %d\nPN_TILES %d\n", first, i);
      add_key(screen, "techniques/ssm/nodes.frag.glsl", "", defines);
    }
    snprintf(defines, sizeof defines, "PN_TILES %d\n", i);
    add_key("techniques/ssm/list.vert.glsl", "techniques/ssm/list.frag.glsl", "", defines);
    snprintf(defines, sizeof defines, "PN_SUM %d\n", i);
    add_key("techniques/ssm/patch.vert.glsl", "techniques/ssm/patch.frag.glsl", "", defines);
  }
  add_key("techniques/ssm/patch.vert.glsl", "techniques/ssm/patch.frag.glsl", "", "PN_SUM 2\n");
  add_key(screen, "techniques/ssm/arguments.frag.glsl", "", "");
  add_key(screen, "techniques/ssm/add.frag.glsl", "", "");
  add_key("", "casters/peel.glsl", "", "");
  static const char *const tables[] = {"silhouettes/points",         "silhouettes/silhouette",
                                       "techniques/smoothies/keep",  "techniques/smoothies/sum",
                                       "techniques/smoothies/count", "techniques/smoothies/list"};
  for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
    char path[64];
    snprintf(path, sizeof path, "%s.frag.glsl", tables[i]);
    add_key(screen, path, "", pni_edge_defines);
  }
  add_key("techniques/smoothies/smoothie.vert.glsl", "techniques/smoothies/smoothie.frag.glsl", "", pni_edge_defines);
  add_key("techniques/smoothies/smoothie.vert.glsl", "techniques/smoothies/alpha.frag.glsl", "", pni_edge_defines);
}

static void list_programs(void) {
  if (key_count) return;
  for (int i = 0; i < pn_technique_count(); i++) {
    const pni_technique_class *c = pni_technique_class_of(pn_technique_at(i));
    if (c->gathering.shader) add_technique(c);
  }
  add_others();
}

/* ---- their texts ---- */

/* A forward or caster snippet is no shader by itself: a host's main() comes after it. */
static const char *host_main(const program_key *key) {
  if (!strcmp(key->fragment, "shaders/forward.glsl"))
    return "uniform vec3 host_p; layout(location = 0) out vec4 host_out;\n"
           "void main() { host_out = vec4(pn_visibility(2, host_p, host_p.yzx)); }\n";
  if (!strcmp(key->fragment, "casters/peel.glsl")) return "void main() { pn_peel(); }\n";
  return "";
}

static char *text_of(const char *path, const char *more, const char *defines) {
  pni_gpu none = {0}; /* the embedded sources, the C library's memory */
  const char *paths[] = {path, *more ? more : NULL, NULL};
  char *text = NULL;
  assert_ok(pni_shader_text(&none, paths, defines, &text));
  return text;
}

static bool desktop_only(const char *path) { return !strcmp(path, "receiver/copy.frag.glsl"); }

/* ---- glslangValidator ---- */

static char directory[] = "shaders-XXXXXX";

static void write_shader(const char *name, const char *version, const char *text, const char *rest, FILE *list) {
  char path[256];
  snprintf(path, sizeof path, "%s/%s", directory, name);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fprintf(file, "#version %s\n%s%s%s", version, strcmp(version, "300 es") ? "" : "precision highp float;\n", text,
          rest);
  fclose(file);
  fprintf(list, "%s\n", path);
}

static const char *const with_gathers = "330 core\n#extension GL_ARB_texture_gather : enable\n#define PN_GATHER 1";

static void write_all(const char *version, FILE *list) {
  for (int i = 0; i < key_count; i++) {
    const program_key *k = &keys[i];
    char name[64];
    bool es = !strcmp(version, "300 es"), gathers = version == with_gathers;
    if (es && desktop_only(k->fragment)) continue;
    char *text = text_of(k->fragment, k->more, k->defines);
    snprintf(name, sizeof name, "%s-%04d.frag", es ? "es" : gathers ? "gather" : "gl", i);
    if (!gathers || strstr(text, "PN_GATHER")) write_shader(name, version, text, host_main(k), list);
    free(text);
    if (!*k->vertex || gathers) continue;
    text = text_of(k->vertex, "", k->defines);
    snprintf(name, sizeof name, "%s-%04d.vert", es ? "es" : "gl", i);
    write_shader(name, version, text, "", list);
    free(text);
  }
}

static void test_validator(void **state) {
  (void)state;
  list_programs();
  assert_non_null(mkdtemp(directory));
  char command[512];
  snprintf(command, sizeof command, "%s/list", directory);
  FILE *list = fopen(command, "w");
  write_all("330 core", list);
  write_all(with_gathers, list);
  write_all("300 es", list);
  fclose(list);
  snprintf(command, sizeof command, "xargs glslangValidator < %s/list > %s/log 2>&1", directory, directory);
  int status = system(command);
  if (status) {
    snprintf(command, sizeof command, "grep -h -B1 -A3 ERROR %s/log | head -40; echo 'see %s'", directory, directory);
    if (system(command)) print_message("no log\n");
  }
  assert_int_equal(status, 0);
  snprintf(command, sizeof command, "rm -r %s", directory);
  assert_int_equal(system(command), 0);
  print_message("%d programs\n", key_count);
}

/* ---- nothing is forgotten ---- */

/* Every file of shaders is part of some program of the list. */
static void test_every_file_is_used(void **state) {
  (void)state;
  list_programs();
  for (int f = 0; f < pni_embedded_shader_count; f++) {
    const char *body = pni_embedded_shaders[f].text, *end;
    while (!strncmp(body, "#include", 8) || *body == '\n') body = strchr(body, '\n') + 1;
    end = strstr(body, "#include"); /* up to where another file would be put in */
    size_t length = end ? (size_t)(end - body) : strlen(body);
    char *start = strncpy(calloc(length + 1, 1), body, length);
    bool used = false;
    for (int i = 0; i < key_count && !used; i++)
      for (int part = 0; part < 2 && !used; part++) {
        if (part == 0 && !*keys[i].vertex) continue;
        char *text = part ? text_of(keys[i].fragment, keys[i].more, keys[i].defines)
                          : text_of(keys[i].vertex, "", keys[i].defines);
        used = strstr(text, start) != NULL;
        free(text);
      }
    free(start);
    if (!used) fail_msg("%s is in no program of this test's list", pni_embedded_shaders[f].path);
  }
}

static bool in_list(const char *key) {
  for (int i = 0; i < key_count; i++) {
    char text[4096];
    snprintf(text, sizeof text, "%s %s %s%s%s", keys[i].vertex, keys[i].fragment, keys[i].more,
             *keys[i].more ? " " : "", keys[i].defines);
    if (!strcmp(text, key)) return true;
  }
  return false;
}

/* A frame of every technique with every kind of receiver: each program that was compiled is in the list. */
static void test_compiled_programs_are_listed(void **state) {
  (void)state;
  list_programs();
  soup patch = {0};
  soup_patch(&patch, v3(0, 0, 0), v3(1, 0, 0), v3(0, 0, 1));
  camera k = {
      .width = 8, .height = 8, .eye = v3(0, 2, 1), .up = v3(0, 1, 0), .half_height = 0.5, .near = 0.1, .far = 9};
  view v;
  stage s;
  view_draw(&v, &k, &patch);
  stage_open(&s);
  stage_cast(&s, &patch);
  pn_light_desc light = light_at(v3(0, 3, 0), v3(0, -1, 0), 0.5, 0.5, 8);
  light.fit = PN_FIT_VISIBLE;
  for (int i = 0; i < pn_technique_count(); i++)
    for (int variant = 0; variant < 8; variant++) {
      pn_receiver_desc desc = view_desc(&v, variant & 1);
      desc.mask_texture = variant & 2 ? v.normal : 0;
      desc.scale = variant & 4 ? 2 : 1;
      assert_ok(pn_receiver_set(s.receiver, &desc));
      const char *name = pn_technique_at(i)->name;
      free(stage_visibility(&s, &light, strcmp(name, "average") ? name : "average:samples=2"));
      assert_ok(pn_prepare(s.context, name, &desc));
    }
  int count = 0;
  for (const pni_program *p = s.context->gpu.programs; p; p = p->next, count++)
    if (!in_list(p->key)) fail_msg("a program of this test's list is missing: %s", p->key);
  assert_true(count > 20);
  stage_close(&s);
  view_free(&v);
  soup_free(&patch);
}

/* What ES 3.00 and WebGL 2 have not; geometry shaders have no place in a program's key. */
static void test_discipline(void **state) {
  (void)state;
  static const char *const words[] = {"samplerBuffer", "EmitVertex", "gl_Layer",  "#extension",
                                      "#version",      "double ",    "imageLoad", "sampler1D"};
  for (int f = 0; f < pni_embedded_shader_count; f++)
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
      if (strstr(pni_embedded_shaders[f].text, words[i])) fail_msg("%s has %s", pni_embedded_shaders[f].path, words[i]);
}

int main(void) {
  const struct CMUnitTest with_gl[] = {cmocka_unit_test(test_compiled_programs_are_listed)};
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_file_is_used), cmocka_unit_test(test_discipline)};
  const struct CMUnitTest validator[] = {cmocka_unit_test(test_validator)};
  int failed = cmocka_run_group_tests(tests, NULL, NULL), gl = GL_RUN("compiled programs", with_gl);
  bool installed = system("command -v glslangValidator > /dev/null 2>&1") == 0;
  int invalid = installed ? cmocka_run_group_tests(validator, NULL, NULL) : 77;
  for (int i = 0; i < key_count; i++) {
    free(keys[i].vertex);
    free(keys[i].fragment);
    free(keys[i].more);
    free(keys[i].defines);
  }
  free(keys);
  if (failed || gl == 1 || invalid == 1 || (invalid && installed)) return 1;
  return installed ? 0 : 77;
}
