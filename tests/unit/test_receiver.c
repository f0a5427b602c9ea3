/* Surfaces from a host's depth: positions and tangent planes lie within the errors that the shaders declare for
 * them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gl/host.h"
#include "gl/program.h"
#include "gl/source.h"
#include "gl/bound.h"
#include "gl/state.h"
#include "receiver/receiver.h"
#include "stage.h"

enum { IMAGES = 3 };

typedef struct {
  camera camera;
  bool normals;
  const char *name;
} setup;

/* ---- surface.glsl run on a view ---- */

typedef struct {
  float *p, *n, *error;
  int width;
} surfaces; /* four floats a pixel: p and sigma, n, error */

static const char main_text[] =
    "layout(location = 0) out vec4 out_p; layout(location = 1) out vec4 out_n; layout(location = 2) out vec4 "
    "out_error;\n"
    "void main() {\n"
    "  ivec2 pixel = ivec2(gl_FragCoord.xy);\n"
    "  out_p = out_n = out_error = vec4(0.0);\n"
    "  if (!pn_receives(pixel)) return;\n"
    "  pn_Surface s = pn_surface(pixel);\n"
    "  out_p = vec4(s.p, s.sigma); out_n = vec4(s.n, 1.0); out_error = vec4(s.error, 1.0);\n"
    "}\n";
static const char vertex_text[] =
    "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }\n";

static GLuint surface_program(pni_gpu *gpu, pn_receiver *receiver, pni_program *names) {
  static const char *const paths[] = {"shaders/precision.glsl", "gather/shaded_point.glsl", "receiver/surface.glsl",
                                      NULL};
  enum { SAMPLERS = 3, UNIFORMS = 11 };
  static const char *const uniforms[UNIFORMS] = {
      "pn_depth", "pn_normal",  "pn_planes", "pn_light_from_pixel", "pn_pixel_from_light", "pn_light_from_normal",
      "pn_eye",   "pn_shining", "pn_view",   "pn_offset",           "pn_quantum"};
  char defines[PNI_RECEIVER_DEFINES], *text;
  pni_receiver_defines(receiver, defines);
  assert_ok(pni_shader_text(gpu, paths, defines, &text));
  char *whole = malloc(strlen(text) + sizeof main_text);
  sprintf(whole, "%s%s", text, main_text);
  pni_free(gpu, text);
  GLuint program = gl_program(vertex_text, whole);
  free(whole);
  *names = (pni_program){.id = program, .uniform_count = UNIFORMS};
  glUseProgram(program);
  for (int i = 0; i < UNIFORMS; i++) {
    pni_uniform *u = &names->uniforms[i];
    snprintf(u->name, PNI_UNIFORM_NAME, "%s", uniforms[i]);
    u->location = glGetUniformLocation(program, uniforms[i]);
    if (i < SAMPLERS) {
      u->target = GL_TEXTURE_2D;
      u->unit = i;
      glUniform1i(u->location, i);
    }
  }
  return program;
}

static surfaces run(stage *s, const view *v, const pni_frame *frame) {
  int width = v->camera.width, height = v->camera.height;
  pni_gpu *gpu = &s->context->gpu;
  pni_program names;
  pni_forget(gpu);
  assert_ok(pni_receiver_surfaces(s->receiver));
  GLuint program = surface_program(gpu, s->receiver, &names), framebuffer, array, images[IMAGES];
  static const GLenum all[IMAGES] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
  glGenTextures(IMAGES, images);
  glGenVertexArrays(1, &array);
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  for (int i = 0; i < IMAGES; i++) {
    glBindTexture(GL_TEXTURE_2D, images[i]);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, all[i], GL_TEXTURE_2D, images[i], 0);
  }
  glDrawBuffers(IMAGES, all);
  glViewport(0, 0, width, height);
  pni_forget(gpu);
  pni_ready(gpu);
  gpu->program = &names;
  glUseProgram(program);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  pni_receiver_uniforms(s->receiver, frame, NULL, &(pni_rounding){0}, 1);
  glBindVertexArray(array);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  surfaces out = {gl_read_texture(images[0], 0, -1, width, height, 4),
                  gl_read_texture(images[1], 0, -1, width, height, 4),
                  gl_read_texture(images[2], 0, -1, width, height, 4), width};
  pni_state_reset(gpu);
  pni_forget(gpu);
  glDeleteTextures(IMAGES, images);
  glDeleteVertexArrays(1, &array);
  glDeleteFramebuffers(1, &framebuffer);
  glDeleteProgram(program);
  return out;
}

/* ---- truth ---- */

static vec in_light(const pni_frame *f, vec p, double one) {
  vec o = v3(f->origin[0], f->origin[1], f->origin[2]), d = sub(p, mul(one, o));
  return v3(dot(d, v3(f->u[0], f->u[1], f->u[2])), dot(d, v3(f->v[0], f->v[1], f->v[2])),
            dot(d, v3(f->z[0], f->z[1], f->z[2])));
}

static vec at(const float *values, int i) { return v3(values[4 * i], values[4 * i + 1], values[4 * i + 2]); }

/* Whether depth tells the plane under a pixel: along each axis it goes on for two pixels to one side. */
static bool plane_is_known(const view *v, int x, int y) {
  vec n = normal_of(&v->surfaces->list[view_shown(v, x, y)]), p = corner_of(&v->surfaces->list[view_shown(v, x, y)], 0);
  for (int axis = 0; axis < 2; axis++) {
    bool known = false;
    for (int side = -1; side <= 1; side += 2) {
      bool same = true;
      for (int k = 1; k <= 2; k++) {
        int i = x + (axis ? 0 : side * k), j = y + (axis ? side * k : 0);
        bool inside = i >= 0 && j >= 0 && i < v->camera.width && j < v->camera.height && view_shown(v, i, j) >= 0;
        for (int c = 0; c < 3 && inside; c++)
          inside = fabs(dot(n, sub(corner_of(&v->surfaces->list[view_shown(v, i, j)], c), p))) < 1e-6;
        same = same && inside;
      }
      known = known || same;
    }
    if (!known) return false;
  }
  return true;
}

typedef struct {
  int pixels, planes, wrong_planes;
  double worst_p, worst_n;
} tally;

/* Cosine between the surface's normal and the ray. */
static double facing_of(const view *v, int x, int y) {
  vec to_eye = sub(v->camera.eye, v->camera.orthographic ? v->camera.target : view_point(v, x, y));
  return fabs(dot(view_normal(v, x, y), unit(to_eye)));
}

/* What the host's own float arithmetic adds: a vertex moves sideways by four roundings of its distance from the eye,
 * and a surface that the ray meets at a slant turns that into distance along the ray. */
static double host_error(const view *v, int x, int y) {
  double facing = facing_of(v, x, y);
  return 4 * 0x1p-24 * (length(v->camera.eye) + 4.3) * sqrt(fmax(1 - facing * facing, 0)) / facing;
}

static void check_pixel(const surfaces *s, const view *v, const pni_frame *frame, bool normals, int x, int y,
                        tally *out) {
  int i = y * s->width + x;
  vec p = in_light(frame, view_point(v, x, y), 1), n = in_light(frame, view_normal(v, x, y), 0);
  double host = host_error(v, x, y);
  vec off = sub(at(s->p, i), p), error = add(at(s->error, i), v3(host, host, host));
  out->pixels++;
  double share = fmax(fabs(off.x) / error.x, fmax(fabs(off.y) / error.y, fabs(off.z) / error.z));
  /* Right at an edge GL may show a point that lies a little beyond the triangle: vertices snap to 1/256 pixel. */
  bool inner = view_flat_around(v, x, y, 1);
  if (inner) out->worst_p = fmax(out->worst_p, share);
  if (!normals && !plane_is_known(v, x, y)) return;
  double angle = length(cross(at(s->n, i), n)),
         sigma = s->p[4 * i + 3] + 1e-6; /* as pn_receiver adds it for float arithmetic */
  out->planes++;
  if (dot(at(s->n, i), n) < 0 || angle > sigma) {
    if (normals ? inner : view_flat_around(v, x, y, 2)) out->worst_n = fmax(out->worst_n, angle / sigma);
    out->wrong_planes++;
  }
}

static tally check(const setup *t, const soup *scene, const pni_frame *frame) {
  view v;
  stage s;
  tally found = {0};
  view_draw(&v, &t->camera, scene);
  stage_open(&s);
  stage_receive(&s, &v, t->normals);
  surfaces out = run(&s, &v, frame);
  for (int y = 0; y < t->camera.height; y++)
    for (int x = 0; x < t->camera.width; x++) {
      bool something = view_shown(&v, x, y) >= 0;
      assert_true((out.n[4 * (y * out.width + x) + 3] == 1) == something);
      float depth = v.depths[y * out.width + x];
      /* Exactly 0 or 1: on a clipping plane, where the surface's own depth is cut off. */
      if (!something || depth <= 0 || depth >= 1) continue;
      /* Seen nearly from its side, a triangle is a sliver on the screen, and GL promises nothing about interpolation
       * along it. */
      if (facing_of(&v, x, y) < 0.05) continue;
      check_pixel(&out, &v, frame, t->normals, x, y, &found);
    }
  free(out.p);
  free(out.n);
  free(out.error);
  stage_close(&s);
  view_free(&v);
  return found;
}

/* ---- scenes ---- */

static soup make_scene(uint64_t *seed) {
  soup scene = {0};
  soup_patch(&scene, v3(0, 0, 0), v3(1.5, 0, 0),
             v3(0, 0, 1.5)); /* ends before the near plane: clipping makes new vertices */
  for (int i = 0; i < 4; i++) {
    vec a = random_direction(seed), b = unit(cross(a, random_direction(seed)));
    soup_block(&scene, add(v3(0, 0.5, 0), random_point(seed, 0.8)), mul(0.3, a), mul(0.3, b), mul(0.3, cross(a, b)));
  }
  return scene;
}

static setup random_setup(uint64_t *seed) {
  static const struct {
    GLenum format;
    bool reversed, orthographic;
    const char *name;
  } kinds[] = {{GL_DEPTH_COMPONENT32F, false, false, "perspective D32F"},
               {GL_DEPTH_COMPONENT24, false, false, "perspective D24"},
               {GL_DEPTH_COMPONENT16, false, false, "perspective D16"},
               {GL_DEPTH_COMPONENT32F, true, false, "perspective reversed"},
               {GL_DEPTH_COMPONENT32F, false, true, "orthographic D32F"},
               {GL_DEPTH_COMPONENT24, false, true, "orthographic D24"},
               {GL_DEPTH_COMPONENT16, false, true, "orthographic D16"},
               {GL_DEPTH_COMPONENT32F, true, true, "orthographic reversed"}};
  int i = (int)random_in(seed, 0, epoxy_has_gl_extension("GL_ARB_clip_control") ? 8 : 3);
  setup t = {.name = kinds[i].name, .normals = random_bits(seed) & 1};
  vec from = random_direction(seed);
  from.y = fabs(from.y) + 0.1;
  t.camera = (camera){.width = 61,
                      .height = 47,
                      .eye = mul(4, unit(from)),
                      .target = v3(0, 0.3, 0),
                      .up = v3(0, 1, 0.01),
                      .orthographic = kinds[i].orthographic,
                      .half_height = kinds[i].orthographic ? 1.6 : 0.4,
                      .near = random_in(seed, 0.05, 0.5),
                      .far = 20,
                      .reversed = kinds[i].reversed,
                      .depth_format = kinds[i].format};
  return t;
}

static void test_declared_errors(void **state) {
  (void)state;
  uint64_t seed = 1;
  tally total = {0};
  for (int round = 0; round < 60; round++) {
    soup scene = make_scene(&seed);
    setup t = random_setup(&seed);
    static const float z[3] = {0.3f, -1, 0.2f}, u[3] = {1, 0.1f, 0};
    pni_frame frame = {.origin = {-0.5, random_in(&seed, 2, 40), 0.3},
                       .projection = random_bits(&seed) & 1 ? PNI_PARALLEL : PNI_CENTRAL};
    assert_true(pni_frame_axes(z, u, &frame));
    tally found = check(&t, &scene, &frame);
    if (found.worst_p > 1 || found.worst_n > 1)
      print_message("%s%s: position off by %.2f of its error, plane by %.2f\n", t.name,
                    t.normals ? " with normals" : "", found.worst_p, found.worst_n);
    total.pixels += found.pixels;
    total.planes += found.planes;
    total.wrong_planes += found.wrong_planes;
    total.worst_p = fmax(total.worst_p, found.worst_p);
    total.worst_n = fmax(total.worst_n, found.worst_n);
    soup_free(&scene);
  }
  print_message("%d pixels, off by %.2f of the declared error at most; %d planes, %.2f; %d wrong at edges\n",
                total.pixels, total.worst_p, total.planes, total.worst_n, total.wrong_planes);
  assert_true(total.pixels > 60 * 500 && total.planes > 60 * 400);
  assert_true(total.worst_p <= 1);
  assert_true(total.worst_n <= 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_declared_errors)};
  return GL_RUN("receiver", tests);
}
