#include "gl/bound.h"

#include <string.h>

#include "gl/fixed.h"
#include "gl/label.h"

const GLenum pni_pack_names[PNI_PIXEL_NAMES] = {GL_PACK_ALIGNMENT, GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS,
                                                GL_PACK_SKIP_PIXELS, GL_PACK_SWAP_BYTES};
const GLenum pni_unpack_names[PNI_PIXEL_NAMES] = {GL_UNPACK_ALIGNMENT, GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS,
                                                  GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SWAP_BYTES};
const GLint pni_pixel_defaults[PNI_PIXEL_NAMES] = {4, 0, 0, 0, 0};

/* ---- plain settings ---------------------------------------------------------------------------------------------- */

void pni_viewport(pni_gpu *gpu, const int b[4]) {
  if (gpu->can.viewports) GL(gpu, ViewportIndexedf)(0, (GLfloat)b[0], (GLfloat)b[1], (GLfloat)b[2], (GLfloat)b[3]);
  else GL(gpu, Viewport)(b[0], b[1], b[2], b[3]);
}

void pni_depth_range(pni_gpu *gpu, double near, double far) {
  if (gpu->can.viewports) GL(gpu, DepthRangeIndexed)(0, near, far);
  else GL(gpu, DepthRange)(near, far);
}

void pni_scissor(pni_gpu *gpu, const int b[4]) {
  if (gpu->can.viewports) GL(gpu, ScissorIndexed)(0, b[0], b[1], b[2], b[3]);
  else GL(gpu, Scissor)(b[0], b[1], b[2], b[3]);
}

void pni_switch(pni_gpu *gpu, GLenum name, bool on) {
  bool indexed = gpu->can.viewports && name == GL_SCISSOR_TEST;
  if (indexed && on) GL(gpu, Enablei)(name, 0);
  else if (indexed) GL(gpu, Disablei)(name, 0);
  else if (on) GL(gpu, Enable)(name);
  else GL(gpu, Disable)(name);
}

/* Of draw buffer 0 only, where each has its own (4.0). */
void pni_blend_functions(pni_gpu *gpu, const GLint equation[2], const GLint function[4]) {
  const GLenum e[2] = {(GLenum)equation[0], (GLenum)equation[1]};
  const GLenum f[4] = {(GLenum)function[0], (GLenum)function[1], (GLenum)function[2], (GLenum)function[3]};
  if (gpu->can.blend_buffers) {
    GL(gpu, BlendEquationSeparatei)(0, e[0], e[1]);
    GL(gpu, BlendFuncSeparatei)(0, f[0], f[1], f[2], f[3]);
  } else {
    GL(gpu, BlendEquationSeparate)(e[0], e[1]);
    GL(gpu, BlendFuncSeparate)(f[0], f[1], f[2], f[3]);
  }
}

/* ---- neutral ----------------------------------------------------------------------------------------------------- */

static void neutral_pixels(pni_gpu *gpu, const pni_host_state *host) {
  if (!host || host->pixel_pack) GL(gpu, BindBuffer)(GL_PIXEL_PACK_BUFFER, 0);
  if (!host || host->pixel_unpack) GL(gpu, BindBuffer)(GL_PIXEL_UNPACK_BUFFER, 0);
  for (int i = 0; i < PNI_PIXEL_NAMES; i++) {
    if (!host || host->pack[i] != pni_pixel_defaults[i]) GL(gpu, PixelStorei)(pni_pack_names[i], pni_pixel_defaults[i]);
    if (!host || host->unpack[i] != pni_pixel_defaults[i])
      GL(gpu, PixelStorei)(pni_unpack_names[i], pni_pixel_defaults[i]);
  }
}

static void neutral_switches(pni_gpu *gpu, const pni_host_state *host) {
  bool blends = !host;
  for (int i = 0; i < gpu->can.switch_count; i++)
    if (!host || host->enabled[i]) pni_switch(gpu, gpu->can.switches[i], false);
  for (int i = 0; i < gpu->can.clip_distances; i++)
    if (!host || host->clip[i]) GL(gpu, Disable)(GL_CLIP_DISTANCE0 + (GLenum)i);
  for (int i = 0; i < gpu->can.draw_buffers && host; i++) blends = blends || host->blend[i];
  if (blends) GL(gpu, Disable)(GL_BLEND);
}

static bool all_channels(const pni_gpu *gpu, const pni_host_state *host) {
  bool all = true;
  for (int i = 0; i < gpu->can.draw_buffers; i++)
    for (int c = 0; c < 4; c++) all = all && host->color_mask[i][c];
  return all;
}

static void neutral_raster(pni_gpu *gpu, const pni_host_state *h) {
  if (!h || !all_channels(gpu, h)) GL(gpu, ColorMask)(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  if (!h || h->depth_mask) GL(gpu, DepthMask)(GL_FALSE);
  if (!h || h->depth_func != GL_LESS) GL(gpu, DepthFunc)(GL_LESS);
  if (!h || h->depth_range[0] != 0 || h->depth_range[1] != 1) pni_depth_range(gpu, 0, 1);
  if (!h || h->provoking_vertex != GL_LAST_VERTEX_CONVENTION) GL(gpu, ProvokingVertex)(GL_LAST_VERTEX_CONVENTION);
  if (!h || h->clamp_read != GL_FIXED_ONLY) GL(gpu, ClampColor)(GL_CLAMP_READ_COLOR, GL_FIXED_ONLY);
  if (!h || !pni_fills_polygons(gpu, h)) GL(gpu, PolygonMode)(GL_FRONT_AND_BACK, GL_FILL);
  if (!h || h->front_face != GL_CCW) GL(gpu, FrontFace)(GL_CCW);
  if (!h || h->cull_face != GL_BACK) GL(gpu, CullFace)(GL_BACK);
  if (gpu->can.clip_control && (!h || h->clip_origin != GL_LOWER_LEFT || h->clip_depth != GL_NEGATIVE_ONE_TO_ONE))
    GL(gpu, ClipControl)(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
}

bool pni_fills_polygons(const pni_gpu *gpu, const pni_host_state *host) {
  return host->polygon_mode[0] == GL_FILL && (!gpu->can.compatibility || host->polygon_mode[1] == GL_FILL);
}

/* GL cannot name what was never bound. */
static void label_shared(pni_gpu *gpu) {
  if (gpu->labelled || !gpu->can.labels) return;
  gpu->labelled = true;
  pni_bind_vertex_array(gpu, gpu->vertex_array);
  pni_bind_framebuffer(gpu);
  pni_bind_read_framebuffer(gpu);
  pni_bind_texture(gpu, PNI_UNIT_SCRATCH, GL_TEXTURE_2D, 0, gpu->sampler_linear);
  pni_bind_texture(gpu, PNI_UNIT_SCRATCH, GL_TEXTURE_2D, 0, gpu->sampler_nearest);
  pni_label(gpu, GL_VERTEX_ARRAY, gpu->vertex_array, "screen");
  pni_label(gpu, GL_FRAMEBUFFER, gpu->framebuffer, "passes");
  pni_label(gpu, GL_FRAMEBUFFER, gpu->read_framebuffer, "reading");
  pni_label(gpu, GL_SAMPLER, gpu->sampler_nearest, "nearest");
  pni_label(gpu, GL_SAMPLER, gpu->sampler_linear, "linear");
}

/* What the settings below are after pni_neutral; objects that are bound are unknown. */
static void remember_neutral(pni_bound *b) {
  bool group = b->group;
  memset(b, 0xff, sizeof *b);
  b->known = true;
  b->group = group;
  b->attached = false;
  b->depth_test = b->depth_write = b->depth_clamp = b->scissor_test = b->cull = b->clockwise = b->point_size = false;
  b->culled = PN_FACES_FRONT; /* glCullFace(GL_BACK) */
  b->depth_func = GL_LESS;
  b->depth_range[0] = 0;
  b->depth_range[1] = 1;
  b->blend = PNI_BLEND_NONE;
  b->channels[0] = b->channels[1] = 15;
  b->touched = 0;
  b->blended = false;
}

void pni_neutral(pni_gpu *gpu) {
  const pni_host_state *host = gpu->host;
  neutral_switches(gpu, host);
  neutral_raster(gpu, host);
  neutral_pixels(gpu, host);
  pni_fixed_neutral(gpu, host);
  remember_neutral(&gpu->bound);
  label_shared(gpu);
}

void pni_forget(pni_gpu *gpu) {
  gpu->bound.known = false;
  gpu->program = NULL;
  gpu->host = NULL;
}

void pni_ready(pni_gpu *gpu) {
  if (!gpu->bound.known) pni_neutral(gpu);
}

/* ---- objects ----------------------------------------------------------------------------------------------------- */

void pni_bind_program(pni_gpu *gpu, pn_gl program) {
  if (gpu->bound.program == program) return;
  GL(gpu, UseProgram)(program);
  gpu->bound.program = program;
}

void pni_bind_vertex_array(pni_gpu *gpu, pn_gl array) {
  if (gpu->bound.vertex_array == array) return;
  GL(gpu, BindVertexArray)(array);
  gpu->bound.vertex_array = array;
}

void pni_bind_framebuffer(pni_gpu *gpu) {
  if (gpu->bound.framebuffer == gpu->framebuffer) return;
  GL(gpu, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, gpu->framebuffer);
  gpu->bound.framebuffer = gpu->framebuffer;
}

void pni_bind_read_framebuffer(pni_gpu *gpu) {
  if (gpu->bound.read_framebuffer == gpu->read_framebuffer) return;
  GL(gpu, BindFramebuffer)(GL_READ_FRAMEBUFFER, gpu->read_framebuffer);
  gpu->bound.read_framebuffer = gpu->read_framebuffer;
}

static void activate(pni_gpu *gpu, int unit) {
  if (gpu->bound.active_unit == unit) return;
  GL(gpu, ActiveTexture)(GL_TEXTURE0 + (GLenum)unit);
  gpu->bound.active_unit = unit;
}

void pni_bind_texture(pni_gpu *gpu, int unit, GLenum target, pn_gl texture, pn_gl sampler) {
  pni_bound *b = &gpu->bound;
  b->touched |= 1u << unit;
  if (b->texture[unit] != texture || b->target[unit] != target) {
    activate(gpu, unit);
    GL(gpu, BindTexture)(target, texture);
    b->texture[unit] = texture;
    b->target[unit] = target;
  }
  if (b->sampler[unit] == sampler) return;
  GL(gpu, BindSampler)((GLuint)unit, sampler);
  b->sampler[unit] = sampler;
}

void pni_bind_scratch(pni_gpu *gpu, GLenum target, pn_gl texture) {
  activate(gpu, PNI_UNIT_SCRATCH);
  pni_bind_texture(gpu, PNI_UNIT_SCRATCH, target, texture, gpu->sampler_nearest);
}

void pni_texture_gone(pni_gpu *gpu, pn_gl texture) {
  for (int unit = 0; unit < PNI_UNITS; unit++)
    if (gpu->bound.texture[unit] == texture) gpu->bound.texture[unit] = (pn_gl)-1;
  gpu->bound.attached = false;
}

void pni_buffer_gone(pni_gpu *gpu, pn_gl buffer) {
  if (gpu->bound.block == buffer) gpu->bound.block = (pn_gl)-1;
}

/* ---- settings ---------------------------------------------------------------------------------------------------- */

void pni_set_viewport(pni_gpu *gpu, int x, int y, int width, int height) {
  const int box[4] = {x, y, width, height};
  if (!memcmp(gpu->bound.viewport, box, sizeof box)) return;
  pni_viewport(gpu, box);
  memcpy(gpu->bound.viewport, box, sizeof box);
}

void pni_set_depth_range(pni_gpu *gpu, double near, double far) {
  double *range = gpu->bound.depth_range;
  if (range[0] == near && range[1] == far) return;
  pni_depth_range(gpu, near, far);
  range[0] = near;
  range[1] = far;
}

void pni_set_scissor(pni_gpu *gpu, int x, int y, int width, int height) {
  const int box[4] = {x, y, width, height};
  if (!memcmp(gpu->bound.scissor, box, sizeof box)) return;
  pni_scissor(gpu, box);
  memcpy(gpu->bound.scissor, box, sizeof box);
}

static void set_switch(pni_gpu *gpu, bool *remembered, GLenum name, bool on) {
  if (*remembered == on) return;
  pni_switch(gpu, name, on);
  *remembered = on;
}

void pni_set_scissor_test(pni_gpu *gpu, bool on) { set_switch(gpu, &gpu->bound.scissor_test, GL_SCISSOR_TEST, on); }

void pni_set_depth_test(pni_gpu *gpu, bool on, bool write, GLenum function) {
  pni_bound *b = &gpu->bound;
  set_switch(gpu, &b->depth_test, GL_DEPTH_TEST, on);
  if (b->depth_write != write) GL(gpu, DepthMask)(write);
  if (b->depth_func != function) GL(gpu, DepthFunc)(function);
  b->depth_write = write;
  b->depth_func = function;
}

void pni_set_depth_clamp(pni_gpu *gpu, bool on) { set_switch(gpu, &gpu->bound.depth_clamp, GL_DEPTH_CLAMP, on); }

void pni_set_point_size(pni_gpu *gpu, bool on) { set_switch(gpu, &gpu->bound.point_size, GL_PROGRAM_POINT_SIZE, on); }

void pni_set_faces(pni_gpu *gpu, pn_faces faces) {
  pni_bound *b = &gpu->bound;
  bool cull = faces == PN_FACES_FRONT || faces == PN_FACES_BACK;
  set_switch(gpu, &b->cull, GL_CULL_FACE, cull);
  if (!cull || b->culled == faces) return;
  GL(gpu, CullFace)(faces == PN_FACES_FRONT ? GL_BACK : GL_FRONT);
  b->culled = faces;
}

void pni_set_clockwise(pni_gpu *gpu, bool clockwise) {
  if (gpu->bound.clockwise == clockwise) return;
  GL(gpu, FrontFace)(clockwise ? GL_CW : GL_CCW);
  gpu->bound.clockwise = clockwise;
}

void pni_set_blend(pni_gpu *gpu, pni_blend blend) {
  if (gpu->bound.blend == blend) return;
  gpu->bound.blend = blend;
  if (blend == PNI_BLEND_NONE) {
    GL(gpu, Disablei)(GL_BLEND, 0);
    return;
  }
  gpu->bound.blended = true;
  GLint equation = blend == PNI_BLEND_MIN ? GL_MIN : GL_FUNC_ADD;
  pni_blend_functions(gpu, (GLint[2]){equation, equation}, (GLint[4]){GL_ONE, GL_ONE, GL_ONE, GL_ONE});
  GL(gpu, Enablei)(GL_BLEND, 0);
}

void pni_set_channels(pni_gpu *gpu, int image, int channels) {
  if (gpu->bound.channels[image] == channels) return;
  GL(gpu, ColorMaski)((GLuint)image, channels & 1, channels >> 1 & 1, channels >> 2 & 1, channels >> 3 & 1);
  gpu->bound.channels[image] = channels;
}
