/* One odd piece of host state at a time: the same bits as without it, for every technique, and the state as it was
 * afterwards. In a core context, or with the argument "compatibility" in one that has all that outlives shaders too. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "host.h"
#include "state.h"

enum { WIDTH = 40, HEIGHT = 30, PIXELS = WIDTH * HEIGHT };

static host h;
static int compatible;
static camera view;
static depth_target target;
static pn_receiver *receiver;

/* ---- what GL/glcorearb.h has not --------------------------------------------------------------------------------- */

enum {
  ALPHA_TEST = 0x0BC0,
  POLYGON_STIPPLE = 0x0B42,
  POINT_SMOOTH = 0x0B10,
  FOG = 0x0B60,
  LIGHTING = 0x0B50,
  CLAMP_FRAGMENT_COLOR = 0x891B,
  FIXED_ONLY = 0x891D,
  RED_SCALE = 0x0D14,
  RED_BIAS = 0x0D15,
  DEPTH_SCALE = 0x0D1E,
  DEPTH_BIAS = 0x0D1F,
  MAP_COLOR = 0x0D10,
  TEXTURE_FILTER_CONTROL = 0x8500,
  FLAT = 0x1D00,
  SMOOTH = 0x1D01,
  DEPTH_BOUNDS_TEST = 0x8890
};

static void(APIENTRY *alpha_func)(GLenum function, GLfloat reference);
static void(APIENTRY *polygon_stipple)(const GLubyte *mask);
static void(APIENTRY *pixel_transfer)(GLenum name, GLfloat value);
static void(APIENTRY *tex_env)(GLenum target, GLenum name, GLfloat value);
static void(APIENTRY *get_tex_env)(GLenum target, GLenum name, GLfloat *value);
static void(APIENTRY *shade_model)(GLenum mode);
static void(APIENTRY *depth_bounds)(GLdouble low, GLdouble high);

static void load_fixed(void) {
  struct {
    const char *name;
    void *to;
  } functions[] = {{"glAlphaFunc", &alpha_func},          {"glPolygonStipple", &polygon_stipple},
                   {"glPixelTransferf", &pixel_transfer}, {"glTexEnvf", &tex_env},
                   {"glGetTexEnvfv", &get_tex_env},       {"glShadeModel", &shade_model},
                   {"glDepthBoundsEXT", &depth_bounds}};
  for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
    void *found = gl_address(NULL, functions[i].name);
    memcpy(functions[i].to, &found, sizeof found);
  }
}

/* ---- odd things -------------------------------------------------------------------------------------------------- */

static GLuint sampler, buffers[2], pipeline, query;

static void toggle(GLenum name, int on) { (on ? gl.Enable : gl.Disable)(name); }

static void alpha_test(int on) {
  toggle(ALPHA_TEST, on);
  alpha_func(on ? GL_GREATER : GL_ALWAYS, on ? 0.5f : 0);
}

static void stipple(int on) {
  GLubyte mask[128];
  memset(mask, on ? 0x55 : 0xff, sizeof mask);
  polygon_stipple(mask);
  toggle(POLYGON_STIPPLE, on);
}

static void clamp_fragments(int on) { gl.ClampColor(CLAMP_FRAGMENT_COLOR, on ? GL_TRUE : FIXED_ONLY); }

static void transfer(int on) {
  for (GLenum name = RED_SCALE; name <= DEPTH_BIAS; name++) {
    int scale = (name - RED_SCALE) % 2 == 0; /* scales and biases in turn, but for zoom in between */
    if (name == 0x0D16 || name == 0x0D17) continue;
    pixel_transfer(name, on ? 0.5f : (GLfloat)scale);
  }
  pixel_transfer(MAP_COLOR, (GLfloat)on);
}

static void lod_bias(int on) {
  for (int unit = 16; unit-- > 0;) {
    gl.ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    tex_env(TEXTURE_FILTER_CONTROL, GL_TEXTURE_LOD_BIAS, on ? 3.0f : 0);
  }
}

static void point_smooth(int on) { toggle(POINT_SMOOTH, on); }
static void fog(int on) { toggle(FOG, on), toggle(LIGHTING, on); }
static void flat(int on) { shade_model(on ? FLAT : SMOOTH); }

static void bounds_test(int on) {
  if (!gl_has("GL_EXT_depth_bounds_test")) return;
  toggle(DEPTH_BOUNDS_TEST, on);
  depth_bounds(on ? 0.1 : 0, on ? 0.2 : 1);
}

static void depth_parameter(GLenum name, GLint odd, GLint usual, int on) {
  gl.BindTexture(GL_TEXTURE_2D, target.depth);
  gl.TexParameteri(GL_TEXTURE_2D, name, on ? odd : usual);
}

static void base_level(int on) { depth_parameter(GL_TEXTURE_BASE_LEVEL, 1, 0, on); }
static void max_level(int on) { depth_parameter(GL_TEXTURE_MAX_LEVEL, 0, 1000, on); }
static void swizzle(int on) { depth_parameter(GL_TEXTURE_SWIZZLE_R, GL_ZERO, GL_RED, on); }
static void compare(int on) { depth_parameter(GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE, GL_NONE, on); }
static void stencil_mode(int on) {
  if (gl_version() < 43) return;
  depth_parameter(GL_DEPTH_STENCIL_TEXTURE_MODE, GL_STENCIL_INDEX, GL_DEPTH_COMPONENT, on);
}

static void sample_mask(int on) {
  toggle(GL_SAMPLE_MASK, on);
  gl.SampleMaski(0, on ? 0 : 0xffffffffu);
}

static void polygon_smooth(int on) { toggle(GL_POLYGON_SMOOTH, on); }

static void scissor(int on) {
  toggle(GL_SCISSOR_TEST, on);
  gl.Scissor(1, 2, on ? 5 : WIDTH, on ? 6 : HEIGHT);
}

static void stencil(int on) {
  toggle(GL_STENCIL_TEST, on);
  gl.StencilFuncSeparate(GL_FRONT_AND_BACK, on ? GL_NEVER : GL_ALWAYS, 0, 0xffffffffu);
}

static void blend(int on) {
  toggle(GL_BLEND, on);
  gl.BlendEquationSeparate(on ? GL_MIN : GL_FUNC_ADD, on ? GL_MIN : GL_FUNC_ADD);
}

static void logic(int on) {
  toggle(GL_COLOR_LOGIC_OP, on);
  gl.LogicOp(on ? GL_XOR : GL_COPY);
}

static void discard(int on) { toggle(GL_RASTERIZER_DISCARD, on); }
static void depth_range(int on) { gl.DepthRange(on ? 0.7 : 0, on ? 0.2 : 1); }

static void cull(int on) {
  toggle(GL_CULL_FACE, on);
  gl.CullFace(on ? GL_FRONT_AND_BACK : GL_BACK);
  gl.FrontFace(on ? GL_CW : GL_CCW);
}

static void lines(int on) { gl.PolygonMode(GL_FRONT_AND_BACK, on ? GL_LINE : GL_FILL); }

static void offset(int on) {
  toggle(GL_POLYGON_OFFSET_FILL, on);
  gl.PolygonOffset(on ? 40 : 0, on ? 4000 : 0);
}

static void restart(int on) {
  toggle(GL_PRIMITIVE_RESTART, on);
  gl.PrimitiveRestartIndex(on ? 7 : 0);
}

static void clip(int on) { toggle(GL_CLIP_DISTANCE0, on), toggle(GL_CLIP_DISTANCE0 + 5, on); }
static void srgb(int on) { toggle(GL_FRAMEBUFFER_SRGB, on); }
static void dither(int on) { toggle(GL_DITHER, !on); }
static void clamp_depth(int on) { toggle(GL_DEPTH_CLAMP, on); }

static void coverage(int on) {
  toggle(GL_SAMPLE_ALPHA_TO_COVERAGE, on), toggle(GL_SAMPLE_COVERAGE, on), toggle(GL_SAMPLE_ALPHA_TO_ONE, on);
  gl.SampleCoverage(on ? 0 : 1, GL_FALSE);
}

static void pack(int on) {
  gl.PixelStorei(GL_PACK_ROW_LENGTH, on ? 7 : 0);
  gl.PixelStorei(GL_PACK_SKIP_ROWS, on ? 2 : 0);
  gl.PixelStorei(GL_PACK_SWAP_BYTES, on);
  gl.PixelStorei(GL_PACK_ALIGNMENT, on ? 8 : 4);
}

static void unpack(int on) {
  gl.PixelStorei(GL_UNPACK_ROW_LENGTH, on ? 7 : 0);
  gl.PixelStorei(GL_UNPACK_SKIP_PIXELS, on ? 2 : 0);
  gl.PixelStorei(GL_UNPACK_SKIP_IMAGES, on);
  gl.PixelStorei(GL_UNPACK_IMAGE_HEIGHT, on ? 3 : 0);
  gl.PixelStorei(GL_UNPACK_LSB_FIRST, on);
  gl.PixelStorei(GL_UNPACK_SWAP_BYTES, on);
}

static void pixel_buffers(int on) {
  gl.BindBuffer(GL_PIXEL_PACK_BUFFER, on ? buffers[0] : 0);
  gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, on ? buffers[1] : 0);
}

static void samplers(int on) {
  for (GLuint i = 0; i < 16; i++) gl.BindSampler(i, on ? sampler : 0);
}

static void occlusion(int on) {
  if (on) gl.BeginQuery(GL_SAMPLES_PASSED, query);
  else gl.EndQuery(GL_SAMPLES_PASSED);
}

static void sample_shading(int on) {
  if (!gl.MinSampleShading) return;
  toggle(GL_SAMPLE_SHADING, on);
  gl.MinSampleShading((GLfloat)on);
}

static void point_size(int on) {
  toggle(GL_PROGRAM_POINT_SIZE, on);
  gl.PointSize(on ? 9 : 1);
}

static void masks(int on) {
  for (GLuint i = 0; i < 8; i++) gl.ColorMaski(i, !on || (i & 1), !on || !(i & 1), (GLboolean)!on, GL_TRUE);
  gl.DepthMask((GLboolean)!on);
}

static void clear_values(int on) {
  gl.ClearDepth(on ? 0.25 : 1);
  gl.ClearColor(on ? 0.2f : 0, on ? 0.3f : 0, 0, on ? 0.5f : 0);
  gl.ClearStencil(on ? 3 : 0);
}

static void pipelines(int on) {
  if (gl.BindProgramPipeline) gl.BindProgramPipeline(on ? pipeline : 0);
}

static void clip_control(int on) {
  if (gl.ClipControl) gl.ClipControl(on ? GL_UPPER_LEFT : GL_LOWER_LEFT, on ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
}

static void provoking(int on) { gl.ProvokingVertex(on ? GL_FIRST_VERTEX_CONVENTION : GL_LAST_VERTEX_CONVENTION); }
static void viewport(int on) { gl.Viewport(on ? 3 : 0, on ? 4 : 0, on ? 5 : WIDTH, on ? 6 : HEIGHT); }
static void depth_function(int on) { gl.DepthFunc(on ? GL_NEVER : GL_LESS); }
static void clamp_read(int on) { gl.ClampColor(GL_CLAMP_READ_COLOR, on ? GL_TRUE : GL_FIXED_ONLY); }

typedef struct {
  const char *name;
  void (*set)(int on);
  int fixed; /* in compatibility contexts only */
} odd;

#define ODD(name) \
  { #name, name, 0 }
#define FIXED(name) \
  { #name, name, 1 }

static const odd odds[] = {FIXED(alpha_test),  FIXED(stipple),      FIXED(clamp_fragments),
                           FIXED(transfer),    FIXED(lod_bias),     FIXED(fog),
                           FIXED(flat),        FIXED(point_smooth), ODD(bounds_test),
                           ODD(base_level),    ODD(max_level),      ODD(swizzle),
                           ODD(compare),       ODD(stencil_mode),   ODD(sample_mask),
                           ODD(scissor),       ODD(stencil),        ODD(polygon_smooth),
                           ODD(blend),         ODD(logic),          ODD(discard),
                           ODD(cull),          ODD(depth_range),    ODD(lines),
                           ODD(offset),        ODD(restart),        ODD(clip),
                           ODD(srgb),          ODD(dither),         ODD(clamp_depth),
                           ODD(coverage),      ODD(pack),           ODD(unpack),
                           ODD(pixel_buffers), ODD(samplers),       ODD(occlusion),
                           ODD(masks),         ODD(sample_shading), ODD(point_size),
                           ODD(clear_values),  ODD(pipelines),      ODD(provoking),
                           ODD(clip_control),  ODD(viewport),       ODD(depth_function),
                           ODD(clamp_read)};
enum { ODDS = sizeof odds / sizeof *odds };

/* ---- held against the plain frame -------------------------------------------------------------------------------- */

static state_list before, after;

static void read_fixed(state_list *list) {
  static const GLenum names[] = {ALPHA_TEST,  POLYGON_STIPPLE, POINT_SMOOTH, CLAMP_FRAGMENT_COLOR, RED_SCALE, RED_BIAS,
                                 DEPTH_SCALE, DEPTH_BIAS,      MAP_COLOR};
  static const GLenum parameters[] = {GL_TEXTURE_BASE_LEVEL, GL_TEXTURE_SWIZZLE_R, GL_TEXTURE_MAX_LEVEL};
  for (size_t i = 0; compatible && i < sizeof names / sizeof *names; i++) {
    GLfloat value = 0;
    gl.GetFloatv(names[i], &value);
    state_entry *entry = &list->entries[list->count++];
    *entry = (state_entry){.value = {value}};
    snprintf(entry->name, sizeof entry->name, "0x%x", names[i]);
  }
  for (size_t i = 0; i < 3; i++) {
    GLint value = 0, bound = 0;
    gl.GetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
    gl.BindTexture(GL_TEXTURE_2D, target.depth);
    gl.GetTexParameteriv(GL_TEXTURE_2D, parameters[i], &value);
    gl.BindTexture(GL_TEXTURE_2D, (GLuint)bound);
    state_entry *entry = &list->entries[list->count++];
    *entry = (state_entry){.value = {value}};
    snprintf(entry->name, sizeof entry->name, "depth texture 0x%x", parameters[i]);
  }
}

static void read_state(state_list *list) {
  state_read(list);
  read_fixed(list);
}

static pn_state_mode mode; /* PN_STATE_RESET leaves GL's defaults, so that only bits are compared */

static void draw(pn_light *light) {
  pn_receiver_desc d = host_receiver_desc(&view, &target);
  assert_int_equal(pn_state_begin(h.context), PN_OK);
  assert_int_equal(pn_receiver_set(receiver, &d), PN_OK);
  assert_int_equal(pn_maps_update(light, h.casters, PN_GROUPS_ALL, &receiver, 1), PN_OK);
  assert_int_equal(pn_visibility(light, receiver), PN_OK);
  assert_int_equal(pn_state_end(h.context), PN_OK);
}

static void check_odd(const char *spec, pn_light *light, const odd *o, const float *expected) {
  o->set(1);
  read_state(&before);
  draw(light);
  read_state(&after);
  int changed = mode == PN_STATE_RESET ? 0 : state_differences(o->name, &before, &after, NULL, NULL);
  o->set(0);
  gl.ActiveTexture(GL_TEXTURE0);
  float *image = host_result(light, receiver);
  int differ = 0;
  for (int i = 0; i < PIXELS; i++) differ += memcmp(&image[i], &expected[i], sizeof *image) != 0;
  if (differ || changed) fail_msg("%s, %s: %d pixels differ, %d pieces of state", spec, o->name, differ, changed);
  free(image);
}

static void check_technique(const char *spec) {
  pn_light_desc d = host_light_desc();
  pn_light *light;
  d.map_width = 24;
  d.fit = PN_FIT_VISIBLE;
  assert_int_equal(host_light(&h, &d, spec, &light), PN_OK);
  draw(light);
  float *expected = host_result(light, receiver);
  int dark = 0;
  for (int i = 0; i < PIXELS; i++) dark += expected[i] < 0.5f;
  assert_true(dark > PIXELS / 50);
  for (int i = 0; i < ODDS; i++)
    if (compatible || !odds[i].fixed) check_odd(spec, light, &odds[i], expected);
  free(expected);
  pn_light_destroy(&light);
}

static void test_techniques(void **state) {
  (void)state;
  for (int s = 0; host_spec(s); s++) check_technique(host_spec(s));
  assert_int_equal(h.log.counts[PN_MESSAGE_RECEIVER_RANGE], 1); /* of the odd depth range, once */
}

/* The other two modes, in contexts of their own. */
static void test_modes(void **state) {
  static const pn_state_mode modes[2] = {PN_STATE_SCOPED, PN_STATE_RESET};
  host first = h;
  pn_receiver *first_receiver = receiver;
  (void)state;
  for (int i = 0; i < 2; i++) {
    pn_context_desc desc = host_context_desc(&h);
    desc.state = mode = modes[i];
    assert_int_equal(pn_context_create(&desc, &h.context), PN_OK);
    assert_int_equal(host_cast(&h, CAST_MEMORY), PN_OK);
    assert_int_equal(pn_receiver_create(h.context, &receiver), PN_OK);
    check_technique("bitmask");
    check_technique("ssm");
    pn_context_destroy(&h.context);
  }
  mode = PN_STATE_RESTORE;
  h = first;
  receiver = first_receiver;
}

/* ---- the fixture ------------------------------------------------------------------------------------------------- */

/* Depth with stencil and with levels, as it lies in hosts that reduce it. */
static int open_target(void) {
  view = camera_sized(0, WIDTH, HEIGHT);
  gl.GenTextures(1, &target.depth);
  gl.BindTexture(GL_TEXTURE_2D, target.depth);
  for (int level = 0; level < 3; level++)
    gl.TexImage2D(GL_TEXTURE_2D, level, GL_DEPTH24_STENCIL8, WIDTH >> level, HEIGHT >> level, 0, GL_DEPTH_STENCIL,
                  GL_UNSIGNED_INT_24_8, NULL);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  gl.GenFramebuffers(1, &target.framebuffer);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_TEXTURE_2D, target.depth, 0);
  gl.DrawBuffer(GL_NONE);
  gl.ReadBuffer(GL_NONE);
  renderer_depth(&h.draw, &h.world, &view, &target);
  return gl_errors() == 0;
}

static int setup(void **state) {
  (void)state;
  if (!(compatible ? host_open_compatible : host_open)(&h)) exit(77);
  load_fixed();
  if (host_context(&h) != PN_OK || host_cast(&h, CAST_MEMORY) != PN_OK || !open_target()) return -1;
  if (pn_receiver_create(h.context, &receiver) != PN_OK) return -1;
  gl.GenSamplers(1, &sampler);
  gl.SamplerParameteri(sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl.GenBuffers(2, buffers);
  for (int i = 0; i < 2; i++) {
    gl.BindBuffer(GL_PIXEL_PACK_BUFFER, buffers[i]);
    gl.BufferData(GL_PIXEL_PACK_BUFFER, 1 << 20, NULL, GL_STREAM_READ);
  }
  gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  gl.GenQueries(1, &query);
  if (gl.GenProgramPipelines) gl.GenProgramPipelines(1, &pipeline);
  gl.Viewport(0, 0, WIDTH, HEIGHT);
  gl.Scissor(0, 0, WIDTH, HEIGHT);
  return gl_errors();
}

static int teardown(void **state) {
  (void)state;
  pn_context_destroy(&h.context);
  target_close(&target);
  gl.DeleteSamplers(1, &sampler);
  gl.DeleteBuffers(2, buffers);
  gl.DeleteQueries(1, &query);
  if (gl.DeleteProgramPipelines) gl.DeleteProgramPipelines(1, &pipeline);
  host_close(&h);
  return 0;
}

int main(int argc, char **argv) {
  compatible = argc > 1 && strcmp(argv[1], "compatibility") == 0;
  const struct CMUnitTest tests[] = {cmocka_unit_test_teardown(test_techniques, host_check),
                                     cmocka_unit_test_teardown(test_modes, host_check)};
  return cmocka_run_group_tests_name(compatible ? "one odd, compatibility" : "one odd", tests, setup, teardown);
}
