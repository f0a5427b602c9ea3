#include "gl/state.h"

#include "gl/bound.h"
#include "gl/fixed.h"
#include "gl/label.h"

static void save_blend_functions(pni_gpu *gpu, pni_host_state *state) {
  static const GLenum names[6] = {GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA, GL_BLEND_SRC_RGB,
                                  GL_BLEND_DST_RGB,      GL_BLEND_SRC_ALPHA,      GL_BLEND_DST_ALPHA};
  for (int i = 0; i < 6; i++) {
    GLint *to = i < 2 ? &state->blend_equation[i] : &state->blend_function[i - 2];
    if (gpu->can.blend_buffers) GL(gpu, GetIntegeri_v)(names[i], 0, to);
    else GL(gpu, GetIntegerv)(names[i], to);
  }
}

static void save_bindings(pni_gpu *gpu, pni_host_state *state) {
  GL(gpu, GetIntegerv)(GL_CURRENT_PROGRAM, &state->program);
  GL(gpu, GetIntegerv)(GL_VERTEX_ARRAY_BINDING, &state->vertex_array);
  GL(gpu, GetIntegerv)(GL_ARRAY_BUFFER_BINDING, &state->array_buffer);
  GL(gpu, GetIntegerv)(GL_DRAW_FRAMEBUFFER_BINDING, &state->draw_framebuffer);
  GL(gpu, GetIntegerv)(GL_READ_FRAMEBUFFER_BINDING, &state->read_framebuffer);
  GL(gpu, GetIntegerv)(GL_UNIFORM_BUFFER_BINDING, &state->uniform_buffer);
  GL(gpu, GetIntegerv)(GL_PIXEL_PACK_BUFFER_BINDING, &state->pixel_pack);
  GL(gpu, GetIntegerv)(GL_PIXEL_UNPACK_BUFFER_BINDING, &state->pixel_unpack);
  if (gpu->can.indirect) GL(gpu, GetIntegerv)(GL_DRAW_INDIRECT_BUFFER_BINDING, &state->draw_indirect);
  GL(gpu, GetIntegeri_v)(GL_UNIFORM_BUFFER_BINDING, PNI_BLOCK_BINDING, &state->block_buffer);
  GL(gpu, GetInteger64i_v)(GL_UNIFORM_BUFFER_START, PNI_BLOCK_BINDING, &state->block_start);
  GL(gpu, GetInteger64i_v)(GL_UNIFORM_BUFFER_SIZE, PNI_BLOCK_BINDING, &state->block_size);
}

static void save_textures(pni_gpu *gpu, pni_host_state *state) {
  GL(gpu, GetIntegerv)(GL_ACTIVE_TEXTURE, &state->active_texture);
  for (int unit = 0; unit < PNI_UNITS; unit++) {
    GL(gpu, ActiveTexture)(GL_TEXTURE0 + (GLenum)unit);
    GL(gpu, GetIntegerv)(GL_TEXTURE_BINDING_2D, &state->texture_2d[unit]);
    GL(gpu, GetIntegerv)(GL_TEXTURE_BINDING_2D_ARRAY, &state->texture_array[unit]);
    GL(gpu, GetIntegerv)(GL_TEXTURE_BINDING_2D_MULTISAMPLE, &state->texture_multisample[unit]);
    GL(gpu, GetIntegerv)(GL_SAMPLER_BINDING, &state->sampler[unit]);
  }
  GL(gpu, ActiveTexture)((GLenum)state->active_texture);
}

static void save_raster(pni_gpu *gpu, pni_host_state *state) {
  GL(gpu, GetIntegerv)(GL_VIEWPORT, state->viewport);
  GL(gpu, GetIntegerv)(GL_SCISSOR_BOX, state->scissor);
  GL(gpu, GetIntegerv)(GL_CLAMP_READ_COLOR, &state->clamp_read);
  GL(gpu, GetIntegerv)(GL_DEPTH_FUNC, &state->depth_func);
  GL(gpu, GetIntegerv)(GL_CULL_FACE_MODE, &state->cull_face);
  GL(gpu, GetIntegerv)(GL_FRONT_FACE, &state->front_face);
  GL(gpu, GetIntegerv)(GL_PROVOKING_VERTEX, &state->provoking_vertex);
  /* Core contexts answer one value, compatibility contexts two. */
  GL(gpu, GetIntegerv)(GL_POLYGON_MODE, state->polygon_mode);
  GL(gpu, GetBooleanv)(GL_DEPTH_WRITEMASK, &state->depth_mask);
  GL(gpu, GetDoublev)(GL_DEPTH_RANGE, state->depth_range);
  GL(gpu, GetDoublev)(GL_DEPTH_CLEAR_VALUE, &state->clear_depth);
  if (gpu->can.clip_control) {
    GL(gpu, GetIntegerv)(GL_CLIP_ORIGIN, &state->clip_origin);
    GL(gpu, GetIntegerv)(GL_CLIP_DEPTH_MODE, &state->clip_depth);
  }
  for (int i = 0; i < gpu->can.draw_buffers; i++) {
    GL(gpu, GetBooleani_v)(GL_COLOR_WRITEMASK, (GLuint)i, state->color_mask[i]);
    state->blend[i] = GL(gpu, IsEnabledi)(GL_BLEND, (GLuint)i);
  }
  save_blend_functions(gpu, state);
  for (int i = 0; i < gpu->can.clip_distances; i++) state->clip[i] = GL(gpu, IsEnabled)(GL_CLIP_DISTANCE0 + (GLenum)i);
  for (int i = 0; i < gpu->can.switch_count; i++) state->enabled[i] = GL(gpu, IsEnabled)(gpu->can.switches[i]);
}

void pni_state_save(pni_gpu *gpu, pni_host_state *state) {
  pni_find_group_room(gpu);
  save_bindings(gpu, state);
  save_textures(gpu, state);
  save_raster(gpu, state);
  for (int i = 0; i < PNI_PIXEL_NAMES; i++) {
    GL(gpu, GetIntegerv)(pni_pack_names[i], &state->pack[i]);
    GL(gpu, GetIntegerv)(pni_unpack_names[i], &state->unpack[i]);
  }
  pni_fixed_save(gpu, &state->fixed);
  gpu->host = state;
}

/* ---- restoring --------------------------------------------------------------------------------------------------- */

/* Names that no longer exist are not bound again. What the library itself deletes are textures; but a program that its
 * host has deleted lives only as long as it is current; and in a scope, or a callback, hosts delete what they like. */

static GLuint living_texture(pni_gpu *gpu, GLint texture) {
  return texture && GL(gpu, IsTexture)((GLuint)texture) ? (GLuint)texture : 0;
}

static GLuint living_program(pni_gpu *gpu, GLint program) {
  return program && GL(gpu, IsProgram)((GLuint)program) ? (GLuint)program : 0;
}

static GLuint living_array(pni_gpu *gpu, GLint array, bool whole) {
  return !whole || (array && GL(gpu, IsVertexArray)((GLuint)array)) ? (GLuint)array : 0;
}

static GLuint living_buffer(pni_gpu *gpu, GLint buffer, bool whole) {
  return !whole || (buffer && GL(gpu, IsBuffer)((GLuint)buffer)) ? (GLuint)buffer : 0;
}

static GLuint living_framebuffer(pni_gpu *gpu, GLint framebuffer, bool whole) {
  return !whole || (framebuffer && GL(gpu, IsFramebuffer)((GLuint)framebuffer)) ? (GLuint)framebuffer : 0;
}

static GLuint living_sampler(pni_gpu *gpu, GLint sampler, bool whole) {
  return !whole || (sampler && GL(gpu, IsSampler)((GLuint)sampler)) ? (GLuint)sampler : 0;
}

static void bind_buffer(pni_gpu *gpu, GLenum target, GLint buffer, bool whole) {
  GL(gpu, BindBuffer)(target, living_buffer(gpu, buffer, whole));
}

/* What is bound without being remembered is always bound back. */
static void restore_buffers(pni_gpu *gpu, const pni_host_state *state, bool whole) {
  bind_buffer(gpu, GL_ARRAY_BUFFER, state->array_buffer, whole);
  bind_buffer(gpu, GL_UNIFORM_BUFFER, state->uniform_buffer, whole); /* after the indexed one, which sets it too */
  if (gpu->can.indirect) bind_buffer(gpu, GL_DRAW_INDIRECT_BUFFER, state->draw_indirect, whole);
}

static void restore_block(pni_gpu *gpu, const pni_host_state *state, bool whole) {
  GLuint buffer = living_buffer(gpu, state->block_buffer, whole);
  if (buffer && state->block_size > 0) GL(gpu, BindBufferRange)
  (GL_UNIFORM_BUFFER, PNI_BLOCK_BINDING, buffer, (GLintptr)state->block_start, (GLsizeiptr)state->block_size);
  else GL(gpu, BindBufferBase)(GL_UNIFORM_BUFFER, PNI_BLOCK_BINDING, buffer); }

static void restore_bindings(pni_gpu *gpu, const pni_host_state *s, bool whole) {
  const pni_bound *b = &gpu->bound;
  if (whole || b->program != (pn_gl)s->program) GL(gpu, UseProgram)(living_program(gpu, s->program));
  if (whole || b->vertex_array != (pn_gl)s->vertex_array)
    GL(gpu, BindVertexArray)(living_array(gpu, s->vertex_array, whole));
  if (whole || b->framebuffer != (pn_gl)s->draw_framebuffer)
    GL(gpu, BindFramebuffer)(GL_DRAW_FRAMEBUFFER, living_framebuffer(gpu, s->draw_framebuffer, whole));
  if (whole || b->read_framebuffer != (pn_gl)s->read_framebuffer)
    GL(gpu, BindFramebuffer)(GL_READ_FRAMEBUFFER, living_framebuffer(gpu, s->read_framebuffer, whole));
  if (whole || b->block != (pn_gl)-1) restore_block(gpu, s, whole);
  if (whole || s->pixel_pack) bind_buffer(gpu, GL_PIXEL_PACK_BUFFER, s->pixel_pack, whole);
  if (whole || s->pixel_unpack) bind_buffer(gpu, GL_PIXEL_UNPACK_BUFFER, s->pixel_unpack, whole);
}

static void restore_textures(pni_gpu *gpu, const pni_host_state *state, bool whole) {
  bool any = whole;
  for (int unit = 0; unit < PNI_UNITS; unit++) {
    if (!whole && !(gpu->bound.touched >> unit & 1)) continue;
    any = true;
    GL(gpu, ActiveTexture)(GL_TEXTURE0 + (GLenum)unit);
    GL(gpu, BindTexture)(GL_TEXTURE_2D, living_texture(gpu, state->texture_2d[unit]));
    GL(gpu, BindTexture)(GL_TEXTURE_2D_ARRAY, living_texture(gpu, state->texture_array[unit]));
    GL(gpu, BindTexture)(GL_TEXTURE_2D_MULTISAMPLE, living_texture(gpu, state->texture_multisample[unit]));
    GL(gpu, BindSampler)((GLuint)unit, living_sampler(gpu, state->sampler[unit], whole));
  }
  if (any || gpu->bound.active_unit >= 0) GL(gpu, ActiveTexture)((GLenum)state->active_texture);
}

static void restore_blending(pni_gpu *gpu, const pni_host_state *state, bool whole) {
  const pni_bound *b = &gpu->bound;
  for (int i = 0; i < gpu->can.draw_buffers; i++) {
    const GLboolean *mask = state->color_mask[i];
    int channels = mask[0] | mask[1] << 1 | mask[2] << 2 | mask[3] << 3;
    bool blends = i == 0 && b->blend != PNI_BLEND_NONE;
    if (whole || channels != (i < 2 ? b->channels[i] : 15))
      GL(gpu, ColorMaski)((GLuint)i, mask[0], mask[1], mask[2], mask[3]);
    if (!whole && blends == state->blend[i]) continue;
    if (state->blend[i]) GL(gpu, Enablei)(GL_BLEND, (GLuint)i);
    else GL(gpu, Disablei)(GL_BLEND, (GLuint)i);
  }
  if (whole || b->blended) pni_blend_functions(gpu, state->blend_equation, state->blend_function);
}

static bool current_switch(const pni_bound *b, GLenum name) {
  switch (name) {
  case GL_SCISSOR_TEST: return b->scissor_test;
  case GL_DEPTH_TEST: return b->depth_test;
  case GL_DEPTH_CLAMP: return b->depth_clamp;
  case GL_CULL_FACE: return b->cull;
  case GL_PROGRAM_POINT_SIZE: return b->point_size;
  default: return false;
  }
}

static void restore_switches(pni_gpu *gpu, const pni_host_state *state, bool whole) {
  for (int i = 0; i < gpu->can.clip_distances; i++)
    if (whole || state->clip[i]) pni_switch(gpu, GL_CLIP_DISTANCE0 + (GLenum)i, state->clip[i]);
  for (int i = 0; i < gpu->can.switch_count; i++)
    if (whole || state->enabled[i] != current_switch(&gpu->bound, gpu->can.switches[i]))
      pni_switch(gpu, gpu->can.switches[i], state->enabled[i]);
}

static void restore_polygon_mode(pni_gpu *gpu, const pni_host_state *state) {
  if (gpu->can.compatibility) {
    GL(gpu, PolygonMode)(GL_FRONT, (GLenum)state->polygon_mode[0]);
    GL(gpu, PolygonMode)(GL_BACK, (GLenum)state->polygon_mode[1]);
  } else {
    GL(gpu, PolygonMode)(GL_FRONT_AND_BACK, (GLenum)state->polygon_mode[0]);
  }
}

static bool same_box(const int a[4], const GLint b[4]) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2] && a[3] == b[3];
}

/* What passes set, against what they last set. */
static void restore_raster(pni_gpu *gpu, const pni_host_state *s, bool whole) {
  const pni_bound *b = &gpu->bound;
  bool untouched = b->viewport[2] < 0; /* a viewport has no negative width */
  if (whole || (!untouched && !same_box(b->viewport, s->viewport))) pni_viewport(gpu, s->viewport);
  if (whole || (b->scissor[2] >= 0 && !same_box(b->scissor, s->scissor))) pni_scissor(gpu, s->scissor);
  if (whole || b->depth_func != (GLenum)s->depth_func) GL(gpu, DepthFunc)((GLenum)s->depth_func);
  if (whole || b->depth_write != s->depth_mask) GL(gpu, DepthMask)(s->depth_mask);
  if (whole || b->depth_range[0] != s->depth_range[0] || b->depth_range[1] != s->depth_range[1])
    pni_depth_range(gpu, s->depth_range[0], s->depth_range[1]);
  GLenum culled = b->culled == PN_FACES_FRONT ? GL_BACK : GL_FRONT;
  if (whole || culled != (GLenum)s->cull_face) GL(gpu, CullFace)((GLenum)s->cull_face);
  if (whole || (b->clockwise ? GL_CW : GL_CCW) != s->front_face) GL(gpu, FrontFace)((GLenum)s->front_face);
}

/* What is only made neutral, against that. */
static void restore_others(pni_gpu *gpu, const pni_host_state *s, bool whole) {
  if (whole || s->clamp_read != GL_FIXED_ONLY) GL(gpu, ClampColor)(GL_CLAMP_READ_COLOR, (GLenum)s->clamp_read);
  if (whole || s->provoking_vertex != GL_LAST_VERTEX_CONVENTION) GL(gpu, ProvokingVertex)((GLenum)s->provoking_vertex);
  if (whole || !pni_fills_polygons(gpu, s)) restore_polygon_mode(gpu, s);
  if (whole) GL(gpu, ClearDepth)(s->clear_depth);
  if (gpu->can.clip_control && (whole || s->clip_origin != GL_LOWER_LEFT || s->clip_depth != GL_NEGATIVE_ONE_TO_ONE))
    GL(gpu, ClipControl)((GLenum)s->clip_origin, (GLenum)s->clip_depth);
  for (int i = 0; i < PNI_PIXEL_NAMES; i++) {
    if (whole || s->pack[i] != pni_pixel_defaults[i]) GL(gpu, PixelStorei)(pni_pack_names[i], s->pack[i]);
    if (whole || s->unpack[i] != pni_pixel_defaults[i]) GL(gpu, PixelStorei)(pni_unpack_names[i], s->unpack[i]);
  }
}

void pni_state_restore(pni_gpu *gpu, const pni_host_state *state, bool whole) {
  /* Read, and nothing was drawn or made since: only what is bound without being remembered may differ. */
  if (whole || gpu->bound.known) {
    restore_bindings(gpu, state, whole);
    restore_textures(gpu, state, whole);
    restore_raster(gpu, state, whole);
    restore_others(gpu, state, whole);
    restore_blending(gpu, state, whole);
    restore_switches(gpu, state, whole);
    pni_fixed_restore(gpu, state, whole);
  }
  restore_buffers(gpu, state, whole);
}

void pni_state_reset(pni_gpu *gpu) {
  gpu->host = NULL;
  pni_neutral(gpu);
  GL(gpu, Enable)(GL_DITHER);
  GL(gpu, DepthMask)(GL_TRUE);
  GL(gpu, ClearDepth)(1);
  pni_blend_functions(gpu, (GLint[2]){GL_FUNC_ADD, GL_FUNC_ADD}, (GLint[4]){GL_ONE, GL_ZERO, GL_ONE, GL_ZERO});
  GL(gpu, UseProgram)(0);
  GL(gpu, BindVertexArray)(0);
  GL(gpu, BindBuffer)(GL_ARRAY_BUFFER, 0);
  GL(gpu, BindFramebuffer)(GL_FRAMEBUFFER, 0);
  if (gpu->can.indirect) GL(gpu, BindBuffer)(GL_DRAW_INDIRECT_BUFFER, 0);
  GL(gpu, BindBufferBase)(GL_UNIFORM_BUFFER, PNI_BLOCK_BINDING, 0);
  for (int unit = PNI_UNITS; unit-- > 0;) { /* ends at unit 0, the default active one */
    GL(gpu, ActiveTexture)(GL_TEXTURE0 + (GLenum)unit);
    GL(gpu, BindTexture)(GL_TEXTURE_2D, 0);
    GL(gpu, BindTexture)(GL_TEXTURE_2D_ARRAY, 0);
    GL(gpu, BindTexture)(GL_TEXTURE_2D_MULTISAMPLE, 0);
    GL(gpu, BindSampler)((GLuint)unit, 0);
  }
}
