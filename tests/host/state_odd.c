#include <string.h>

#include "renderer.h"
#include "state.h"

/* In the order of odd_objects.textures. The last is newer than the floor. */
static const GLenum texture_targets[] = {
    GL_TEXTURE_1D,
    GL_TEXTURE_2D,
    GL_TEXTURE_3D,
    GL_TEXTURE_1D_ARRAY,
    GL_TEXTURE_2D_ARRAY,
    GL_TEXTURE_CUBE_MAP,
    GL_TEXTURE_RECTANGLE,
    GL_TEXTURE_BUFFER,
    GL_TEXTURE_2D_MULTISAMPLE,
    GL_TEXTURE_2D_MULTISAMPLE_ARRAY,
    GL_TEXTURE_CUBE_MAP_ARRAY,
};
enum { TEXTURES = sizeof texture_targets / sizeof *texture_targets, ODD_UNITS = 32 };

typedef struct {
  GLenum target;
  int since;
} buffer_target;

static const buffer_target buffer_targets[] = {
    {GL_ARRAY_BUFFER, 33},
    {GL_UNIFORM_BUFFER, 33},
    {GL_PIXEL_PACK_BUFFER, 33},
    {GL_PIXEL_UNPACK_BUFFER, 33},
    {GL_COPY_READ_BUFFER, 33},
    {GL_COPY_WRITE_BUFFER, 33},
    {GL_TRANSFORM_FEEDBACK_BUFFER, 33},
    {GL_TEXTURE_BUFFER, 33},
    {GL_DRAW_INDIRECT_BUFFER, 40},
    {GL_ATOMIC_COUNTER_BUFFER, 42},
    {GL_SHADER_STORAGE_BUFFER, 43},
    {GL_DISPATCH_INDIRECT_BUFFER, 43},
    {GL_QUERY_BUFFER, 44},
};
enum { BUFFERS = sizeof buffer_targets / sizeof *buffer_targets, ODD_UNIFORM_RANGES = 24 };

static const GLenum capabilities[] = {
    GL_COLOR_LOGIC_OP,       GL_CULL_FACE,
    GL_DEPTH_CLAMP,          GL_DEPTH_TEST,
    GL_FRAMEBUFFER_SRGB,     GL_LINE_SMOOTH,
    GL_POLYGON_OFFSET_FILL,  GL_POLYGON_OFFSET_LINE,
    GL_POLYGON_OFFSET_POINT, GL_POLYGON_SMOOTH,
    GL_PRIMITIVE_RESTART,    GL_PROGRAM_POINT_SIZE,
    GL_RASTERIZER_DISCARD,   GL_SAMPLE_ALPHA_TO_COVERAGE,
    GL_SAMPLE_ALPHA_TO_ONE,  GL_SAMPLE_COVERAGE,
    GL_SAMPLE_MASK,          GL_SCISSOR_TEST,
    GL_STENCIL_TEST,         GL_TEXTURE_CUBE_MAP_SEAMLESS,
    GL_CLIP_DISTANCE0,       GL_CLIP_DISTANCE3,
    GL_CLIP_DISTANCE7,
};
static const GLenum on_by_default[] = {GL_DITHER, GL_MULTISAMPLE};

#define COUNT(table) (sizeof table / sizeof *table)

void odd_open(odd_objects *out) {
  int version = gl_version();
  memset(out, 0, sizeof *out);
  gl.GenVertexArrays(1, &out->vertex_array);
  gl.GenBuffers(16, out->buffers);
  gl.GenTextures(TEXTURES, out->textures);
  gl.GenSamplers(2, out->samplers);
  gl.GenQueries(2, out->queries);
  for (int i = 0; i < 16; i++) {
    gl.BindBuffer(GL_ARRAY_BUFFER, out->buffers[i]);
    gl.BufferData(GL_ARRAY_BUFFER, 4096, NULL, GL_STATIC_DRAW);
  }
  gl.BindBuffer(GL_ARRAY_BUFFER, 0);
  /* A comparing, blurring sampler, as a shadow map of the host's may have left it. */
  for (int i = 0; i < 2; i++) {
    gl.SamplerParameteri(out->samplers[i], GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    gl.SamplerParameteri(out->samplers[i], GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.SamplerParameteri(out->samplers[i], GL_TEXTURE_WRAP_S, GL_MIRRORED_REPEAT);
  }
  for (int i = 0; i < 3; i++) out->colors[i] = make_texture(GL_RGBA8, 16, 16);
  for (int i = 0; i < 2; i++) out->framebuffers[i] = make_framebuffer(out->colors[i], 0);
  gl.BindFramebuffer(GL_FRAMEBUFFER, out->framebuffers[0]);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D, out->colors[2], 0);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl.GenRenderbuffers(1, &out->renderbuffer);
  out->program = renderer_program(NULL, renderer_caster_body(0));
  if (version >= 40) gl.GenTransformFeedbacks(1, &out->feedback);
  if (version >= 41) gl.GenProgramPipelines(1, &out->pipeline);
}

void odd_close(odd_objects *self) {
  gl.DeleteVertexArrays(1, &self->vertex_array);
  gl.DeleteBuffers(16, self->buffers);
  gl.DeleteTextures(TEXTURES, self->textures);
  gl.DeleteTextures(3, self->colors);
  gl.DeleteSamplers(2, self->samplers);
  gl.DeleteQueries(2, self->queries);
  gl.DeleteFramebuffers(2, self->framebuffers);
  gl.DeleteRenderbuffers(1, &self->renderbuffer);
  gl.DeleteProgram(self->program);
  if (self->feedback) gl.DeleteTransformFeedbacks(1, &self->feedback);
  if (self->pipeline) gl.DeleteProgramPipelines(1, &self->pipeline);
}

/* on: binds the odd objects; else nothing. */
static void set_bindings(const odd_objects *o, int on, int version) {
  if (!on) gl.UseProgram(0); /* a pipeline is looked at only while no program is bound */
  if (version >= 40) gl.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, on ? o->feedback : 0);
  gl.BindVertexArray(on ? o->vertex_array : 0);
  if (on) gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, o->buffers[13]);
  for (GLuint i = 0; i < ODD_UNIFORM_RANGES; i++) {
    if (on) gl.BindBufferRange(GL_UNIFORM_BUFFER, i, o->buffers[14], 256, 512);
    else gl.BindBufferBase(GL_UNIFORM_BUFFER, i, 0);
  }
  gl.BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, on ? o->buffers[15] : 0);
  if (version >= 43) gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, on ? o->buffers[15] : 0);
  for (int i = 0; i < BUFFERS; i++) {
    if (version >= buffer_targets[i].since) gl.BindBuffer(buffer_targets[i].target, on ? o->buffers[i] : 0);
  }
  for (GLuint unit = 0; unit < ODD_UNITS; unit++) {
    gl.ActiveTexture(GL_TEXTURE0 + unit);
    gl.BindSampler(unit, on ? o->samplers[unit % 2] : 0);
    for (int i = 0; i < TEXTURES - (version < 40); i++) gl.BindTexture(texture_targets[i], on ? o->textures[i] : 0);
  }
  gl.ActiveTexture(on ? GL_TEXTURE5 : GL_TEXTURE0);
  if (version >= 42)
    gl.BindImageTexture(2, on ? o->colors[0] : 0, 0, GL_FALSE, 0, on ? GL_READ_WRITE : GL_READ_ONLY, GL_RGBA8);
  if (version >= 41) gl.BindProgramPipeline(on ? o->pipeline : 0);
  gl.UseProgram(on ? o->program : 0);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, on ? o->framebuffers[0] : 0);
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, on ? o->framebuffers[1] : 0);
  gl.BindRenderbuffer(GL_RENDERBUFFER, on ? o->renderbuffer : 0);
}

static void set_tests(int on) {
  GLenum op = on ? GL_INCR_WRAP : GL_KEEP;
  gl.DepthFunc(on ? GL_NEVER : GL_LESS);
  gl.DepthMask(!on);
  gl.DepthRange(on ? 0.75 : 0, on ? 0.25 : 1);
  gl.StencilFuncSeparate(GL_FRONT, on ? GL_NEVER : GL_ALWAYS, on ? 3 : 0, on ? 0x55u : ~0u);
  gl.StencilFuncSeparate(GL_BACK, on ? GL_EQUAL : GL_ALWAYS, on ? 5 : 0, on ? 0x33u : ~0u);
  gl.StencilMaskSeparate(GL_FRONT, on ? 0x0fu : ~0u);
  gl.StencilMaskSeparate(GL_BACK, on ? 0xf0u : ~0u);
  gl.StencilOpSeparate(GL_FRONT, op, on ? GL_ZERO : GL_KEEP, on ? GL_INVERT : GL_KEEP);
  gl.StencilOpSeparate(GL_BACK, on ? GL_ZERO : GL_KEEP, op, on ? GL_REPLACE : GL_KEEP);
  gl.SampleCoverage(on ? 0.25f : 1, on ? GL_TRUE : GL_FALSE);
  gl.SampleMaski(0, on ? 0 : ~0u);
  if (on) gl.Scissor(3, 4, 1, 2);
}

static void set_raster(int on, int version) {
  gl.CullFace(on ? GL_FRONT_AND_BACK : GL_BACK);
  gl.FrontFace(on ? GL_CW : GL_CCW);
  gl.PolygonMode(GL_FRONT_AND_BACK, on ? GL_LINE : GL_FILL);
  gl.PolygonOffset(on ? 7 : 0, on ? -9 : 0);
  gl.PointSize(on ? 3 : 1);
  gl.LineWidth(on ? 2 : 1);
  gl.PointParameterf(GL_POINT_FADE_THRESHOLD_SIZE, on ? 4 : 1);
  gl.PointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, on ? GL_LOWER_LEFT : GL_UPPER_LEFT);
  gl.ProvokingVertex(on ? GL_FIRST_VERTEX_CONVENTION : GL_LAST_VERTEX_CONVENTION);
  /* The most mischievous index: every mesh has it. */
  gl.PrimitiveRestartIndex(on ? 1 : 0);
  if (on) gl.Viewport(5, 6, 7, 8);
  if (gl.ClipControl) gl.ClipControl(on ? GL_UPPER_LEFT : GL_LOWER_LEFT, on ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
  static const GLenum hints[] = {GL_LINE_SMOOTH_HINT, GL_POLYGON_SMOOTH_HINT, GL_TEXTURE_COMPRESSION_HINT,
                                 GL_FRAGMENT_SHADER_DERIVATIVE_HINT};
  for (size_t i = 0; i < COUNT(hints); i++) gl.Hint(hints[i], on ? GL_FASTEST : GL_DONT_CARE);
  if (version >= 40) {
    static const GLfloat levels[4] = {2, 3, 4, 5}, ones[4] = {1, 1, 1, 1};
    gl.MinSampleShading(on ? 0.5f : 0);
    gl.PatchParameteri(GL_PATCH_VERTICES, on ? 5 : 3);
    gl.PatchParameterfv(GL_PATCH_DEFAULT_OUTER_LEVEL, on ? levels : ones);
    gl.PatchParameterfv(GL_PATCH_DEFAULT_INNER_LEVEL, on ? levels : ones);
    (on ? gl.Enable : gl.Disable)(GL_SAMPLE_SHADING);
  }
  if (version >= 43) (on ? gl.Enable : gl.Disable)(GL_PRIMITIVE_RESTART_FIXED_INDEX);
}

static void set_output(int on, int version) {
  static const GLenum odd_buffers[2] = {GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT0};
  gl.ClearColor(on ? 0.1f : 0, on ? 0.2f : 0, on ? 0.3f : 0, on ? 0.4f : 0);
  gl.ClearDepth(on ? 0.25 : 1);
  gl.ClearStencil(on ? 9 : 0);
  gl.LogicOp(on ? GL_XOR : GL_COPY);
  gl.ClampColor(GL_CLAMP_READ_COLOR, on ? GL_TRUE : GL_FIXED_ONLY);
  gl.BlendColor(on ? 0.5f : 0, on ? 0.6f : 0, on ? 0.7f : 0, on ? 0.8f : 0);
  gl.BlendEquationSeparate(on ? GL_MAX : GL_FUNC_ADD, on ? GL_MIN : GL_FUNC_ADD);
  gl.BlendFuncSeparate(on ? GL_DST_COLOR : GL_ONE, on ? GL_ONE : GL_ZERO, on ? GL_ZERO : GL_ONE, on ? GL_ONE : GL_ZERO);
  for (GLuint i = 0; i < 8; i++) {
    GLboolean mask = on ? GL_FALSE : GL_TRUE;
    gl.ColorMaski(i, mask, on && i % 2 ? GL_TRUE : mask, mask, mask);
    (on ? gl.Enablei : gl.Disablei)(GL_BLEND, i);
    if (version >= 40 && on) {
      gl.BlendEquationSeparatei(i, i % 2 ? GL_FUNC_SUBTRACT : GL_MAX, GL_FUNC_REVERSE_SUBTRACT);
      gl.BlendFuncSeparatei(i, GL_ZERO, i % 2 ? GL_ONE : GL_SRC_COLOR, GL_DST_ALPHA, GL_ONE);
    }
  }
  if (on) {
    gl.DrawBuffers(2, odd_buffers);
    gl.ReadBuffer(GL_NONE);
  }
}

static void set_pixel_store(int on) {
  static const GLenum lengths[] = {
      GL_PACK_ROW_LENGTH,   GL_PACK_IMAGE_HEIGHT,   GL_PACK_SKIP_ROWS,   GL_PACK_SKIP_PIXELS,   GL_PACK_SKIP_IMAGES,
      GL_UNPACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_IMAGES};
  for (size_t i = 0; i < COUNT(lengths); i++) gl.PixelStorei(lengths[i], on ? 3 + (GLint)i : 0);
  gl.PixelStorei(GL_PACK_SWAP_BYTES, on);
  gl.PixelStorei(GL_UNPACK_SWAP_BYTES, on);
  gl.PixelStorei(GL_PACK_LSB_FIRST, on);
  gl.PixelStorei(GL_UNPACK_LSB_FIRST, on);
  gl.PixelStorei(GL_PACK_ALIGNMENT, on ? 8 : 4);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, on ? 8 : 4);
}

static void set_all(const odd_objects *self, int on) {
  int version = gl_version();
  set_bindings(self, on, version);
  for (size_t i = 0; i < COUNT(capabilities); i++) (on ? gl.Enable : gl.Disable)(capabilities[i]);
  for (size_t i = 0; i < COUNT(on_by_default); i++) (on ? gl.Disable : gl.Enable)(on_by_default[i]);
  set_tests(on);
  set_raster(on, version);
  set_output(on, version);
  set_pixel_store(on);
}

void odd_set(const odd_objects *self) {
  set_all(self, 1);
  gl.BeginQuery(GL_TIME_ELAPSED, self->queries[0]);
  gl.BeginQuery(GL_SAMPLES_PASSED, self->queries[1]);
}

void odd_unset(const odd_objects *self) {
  GLint running = 0;
  gl.GetQueryiv(GL_TIME_ELAPSED, GL_CURRENT_QUERY, &running);
  if (running) gl.EndQuery(GL_TIME_ELAPSED);
  gl.GetQueryiv(GL_SAMPLES_PASSED, GL_CURRENT_QUERY, &running);
  if (running) gl.EndQuery(GL_SAMPLES_PASSED);
  set_all(self, 0);
}

void odd_set_viewports(void) {
  for (GLuint i = 1; i < 4; i++) {
    gl.ViewportIndexedf(i, (GLfloat)i, 2, 3, 4);
    gl.ScissorIndexed(i, (GLint)i, 2, 3, 4);
    gl.DepthRangeIndexed(i, 0.25, 0.5);
    (i == 2 ? gl.Disablei : gl.Enablei)(GL_SCISSOR_TEST, i);
  }
}

void odd_unset_viewports(void) {
  gl.Disable(GL_SCISSOR_TEST);
  gl.DepthRange(0, 1);
  gl.Viewport(0, 0, CAMERA_WIDTH, CAMERA_HEIGHT);
  gl.Scissor(0, 0, CAMERA_WIDTH, CAMERA_HEIGHT);
}
