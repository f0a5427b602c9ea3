#include "gl/pass.h"

#include <stdint.h>
#include <string.h>

#include "gl/bound.h"
#include "gl/host.h"
#include "gl/label.h"

/* ---- targets ----------------------------------------------------------------------------------------------------- */

static bool same_image(const pni_image *a, const pni_image *b) {
  return a->texture == b->texture && a->array == b->array && a->level == b->level && a->layer == b->layer;
}

static bool attach(pni_gpu *gpu, GLenum point, const pni_image *image, pni_image *bound) {
  if (gpu->bound.attached && same_image(image, bound)) return false;
  if (image->texture && image->array)
    GL(gpu, FramebufferTextureLayer)(GL_DRAW_FRAMEBUFFER, point, image->texture, image->level, image->layer);
  else GL(gpu, FramebufferTexture2D)(GL_DRAW_FRAMEBUFFER, point, GL_TEXTURE_2D, image->texture, image->level);
  *bound = *image;
  return true;
}

static pn_result fail_attached(pni_gpu *gpu, const pni_pass *pass, GLenum status) {
  const pni_image *image = pass->color[0].texture ? &pass->color[0] : &pass->depth;
  gpu->bound.attached = false;
  return pni_fail(gpu, PN_ERROR_UNSUPPORTED, PN_MESSAGE_FRAMEBUFFER,
                  "this device cannot draw into a %d x %d image of texture %u, level %d, layer %d (0x%x)", pass->width,
                  pass->height, image->texture, image->level, image->layer, status);
}

static pn_result attach_all(pni_gpu *gpu, const pni_pass *pass) {
  static const GLenum points[PNI_COLORS] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT0 + 1, GL_COLOR_ATTACHMENT0 + 2};
  pni_bound *b = &gpu->bound;
  GLenum draw[PNI_COLORS];
  bool changed = false;
  pni_bind_framebuffer(gpu);
  for (int i = 0; i < PNI_COLORS; i++) {
    changed = attach(gpu, points[i], &pass->color[i], &b->color[i]) || changed;
    draw[i] = pass->color[i].texture ? points[i] : GL_NONE;
  }
  changed = attach(gpu, GL_DEPTH_ATTACHMENT, &pass->depth, &b->depth) || changed;
  if (!changed) return PN_OK;
  b->attached = true;
  GL(gpu, DrawBuffers)(PNI_COLORS, draw);
  GLenum status = GL(gpu, CheckFramebufferStatus)(GL_DRAW_FRAMEBUFFER);
  return status == GL_FRAMEBUFFER_COMPLETE ? PN_OK : fail_attached(gpu, pass, status);
}

/* ---- settings ---------------------------------------------------------------------------------------------------- */

static void set_depth(pni_gpu *gpu, const pni_pass *pass) {
  static const GLenum functions[] = {[PNI_DEPTH_NONE] = GL_LESS,
                                     [PNI_DEPTH_NEAREST] = GL_LESS,
                                     [PNI_DEPTH_FARTHEST] = GL_GREATER,
                                     [PNI_DEPTH_WRITE] = GL_ALWAYS,
                                     [PNI_DEPTH_TEST] = GL_LESS};
  bool on = pass->depth.texture != 0, whole = pass->depth_range[1] <= 0;
  pni_set_depth_test(gpu, on, on && pass->depth_use != PNI_DEPTH_TEST,
                     functions[on ? pass->depth_use : PNI_DEPTH_NONE]);
  pni_set_depth_clamp(gpu, pass->depth_clamp); /* primitives are clipped without a depth image too */
  pni_set_depth_range(gpu, whole ? 0 : pass->depth_range[0], whole ? 1 : pass->depth_range[1]);
}

static void set_all(pni_gpu *gpu, const pni_pass *pass) {
  pni_set_viewport(gpu, 0, 0, pass->width, pass->height);
  set_depth(gpu, pass);
  pni_set_blend(gpu, pass->blend);
  pni_set_faces(gpu, pass->faces);
  pni_set_clockwise(gpu, false);
  pni_set_point_size(gpu, pass->points);
  pni_set_channels(gpu, 0, pass->channels ? pass->channels : 15);
}

static void clear(pni_gpu *gpu, const pni_pass *pass) {
  static const GLuint zero[4] = {0, 0, 0, 0};
  bool farthest = pass->depth_use == PNI_DEPTH_FARTHEST;
  GLfloat nothing = farthest ? 0.0f : 1.0f;
  pni_set_scissor_test(gpu, false);
  if (pass->depth.texture && (farthest || pass->depth_use == PNI_DEPTH_NEAREST))
    GL(gpu, ClearBufferfv)(GL_DEPTH, 0, &nothing);
  if (pass->clear) GL(gpu, ClearBufferfv)(GL_COLOR, 0, pass->clear);
  if (pass->clear_integer) GL(gpu, ClearBufferuiv)(GL_COLOR, 0, zero);
}

static void limit(pni_gpu *gpu, const pni_part *part) {
  pni_set_scissor_test(gpu, part != NULL);
  if (part) pni_set_scissor(gpu, part->x, part->y, part->width, part->height);
}

/* What can fail of a pass: its program, and its images where one of them is new. */
static pn_result plan(pni_gpu *gpu, const pni_pass *pass) {
  const pni_program *program;
  gpu->program = NULL; /* nothing below has a name in it */
  pn_result result = pass->program.fragment ? pni_program_get(gpu, &pass->program, &program) : PN_OK;
  if (result != PN_OK || !gpu->plan.made) return result;
  pni_ready(gpu);
  return attach_all(gpu, pass);
}

static pn_result set_up(pni_gpu *gpu, const pni_pass *pass, bool fresh) {
  if (gpu->plan.on) return plan(gpu, pass);
  pni_ready(gpu);
  pni_group(gpu, pass->name);
  gpu->program = NULL;
  pn_result result = pass->program.fragment ? pni_pass_program(gpu, &pass->program) : PN_OK;
  if (result == PN_OK) result = attach_all(gpu, pass);
  if (result != PN_OK) return result;
  set_all(gpu, pass);
  if (fresh) clear(gpu, pass);
  limit(gpu, pass->part);
  return PN_OK;
}

pn_result pni_pass_begin(pni_gpu *gpu, const pni_pass *pass) { return set_up(gpu, pass, true); }

pn_result pni_pass_resume(pni_gpu *gpu, const pni_pass *pass) { return set_up(gpu, pass, false); }

pn_result pni_pass_program(pni_gpu *gpu, const pni_program_key *key) {
  const pni_program *program;
  pn_result result = pni_program_get(gpu, key, &program);
  if (result != PN_OK || gpu->plan.on) return result;
  pni_bind_program(gpu, program->id);
  gpu->program = program;
  gpu->textures_set = 0;
  return PN_OK;
}

void pni_pass_clockwise(pni_gpu *gpu, bool clockwise) {
  if (!gpu->plan.on) pni_set_clockwise(gpu, clockwise);
}

pn_result pni_fill(pni_gpu *gpu, const char *name, const pni_pass *where, float value) {
  pni_pass pass = *where;
  pass.name = name;
  pn_result result = pni_pass_begin(gpu, &pass);
  if (result != PN_OK || gpu->plan.on) return result;
  const GLfloat values[4] = {value, value, value, value};
  pni_set_scissor_test(gpu, true);
  pni_set_scissor(gpu, 0, 0, pass.width, pass.height);
  GL(gpu, ClearBufferfv)(GL_COLOR, 0, values);
  return PN_OK;
}

/* ---- by name ----------------------------------------------------------------------------------------------------- */

static GLint location(pni_gpu *gpu, const char *name) {
  const pni_uniform *uniform = pni_find_uniform(gpu->program, name);
  return uniform ? uniform->location : -1;
}

void pni_set_int(pni_gpu *gpu, const char *name, int value) {
  GLint at = location(gpu, name);
  if (at >= 0) GL(gpu, Uniform1i)(at, value);
}

void pni_set_ints(pni_gpu *gpu, const char *name, int x, int y, int z, int w) {
  GLint at = location(gpu, name);
  const GLint values[4] = {x, y, z, w};
  if (at >= 0) GL(gpu, Uniform4iv)(at, 1, values);
}

void pni_set_float(pni_gpu *gpu, const char *name, float value) {
  GLint at = location(gpu, name);
  if (at >= 0) GL(gpu, Uniform1f)(at, value);
}

void pni_set_floats(pni_gpu *gpu, const char *name, const float values[4]) {
  GLint at = location(gpu, name);
  if (at >= 0) GL(gpu, Uniform4fv)(at, 1, values);
}

void pni_set_matrix3(pni_gpu *gpu, const char *name, const float values[9]) {
  GLint at = location(gpu, name);
  if (at >= 0) GL(gpu, UniformMatrix3fv)(at, 1, GL_FALSE, values);
}

void pni_set_matrix4(pni_gpu *gpu, const char *name, const float values[16]) {
  GLint at = location(gpu, name);
  if (at >= 0) GL(gpu, UniformMatrix4fv)(at, 1, GL_FALSE, values);
}

static void set_sampler(pni_gpu *gpu, const char *name, pn_gl texture, pn_gl sampler) {
  const pni_uniform *uniform = pni_find_uniform(gpu->program, name);
  if (!uniform || !uniform->target) return;
  pni_bind_texture(gpu, uniform->unit, uniform->target, texture, sampler);
  gpu->textures_set |= 1u << uniform->unit;
}

void pni_set_texture(pni_gpu *gpu, const char *name, const pni_texture *texture) {
  set_sampler(gpu, name, texture->id, gpu->sampler_nearest);
}

void pni_set_host_texture(pni_gpu *gpu, const char *name, pn_gl texture, pni_sampling sampling) {
  const pn_gl samplers[] = {gpu->sampler_nearest, 0, gpu->sampler_linear};
  set_sampler(gpu, name, texture, samplers[sampling]);
}

/* A sampler that was given nothing reads nothing: not what another pass left, which may be what this one draws to. */
static void unbind_others(pni_gpu *gpu) {
  const pni_program *program = gpu->program;
  for (int i = 0; program && i < program->uniform_count; i++) {
    const pni_uniform *u = &program->uniforms[i];
    if (u->target && !(gpu->textures_set >> u->unit & 1))
      pni_bind_texture(gpu, u->unit, u->target, 0, gpu->sampler_nearest);
  }
}

/* ---- draws ------------------------------------------------------------------------------------------------------- */

static void draw_arrays(pni_gpu *gpu, GLenum mode, int count) {
  if (gpu->plan.on) return;
  unbind_others(gpu);
  pni_bind_vertex_array(gpu, gpu->vertex_array);
  GL(gpu, DrawArrays)(mode, 0, count);
}

void pni_draw_screen(pni_gpu *gpu) { draw_arrays(gpu, GL_TRIANGLES, 3); }

void pni_draw_points(pni_gpu *gpu, int count) { draw_arrays(gpu, GL_POINTS, count); }

void pni_draw_triangles(pni_gpu *gpu, int vertices) { draw_arrays(gpu, GL_TRIANGLES, vertices); }

void pni_draw_vertices(pni_gpu *gpu, const pni_vertices *vertices, int index_bytes, size_t offset, size_t first,
                       size_t count) {
  if (gpu->plan.on) return;
  unbind_others(gpu);
  pni_bind_vertex_array(gpu, vertices->id);
  if (!index_bytes) {
    GL(gpu, DrawArrays)(GL_TRIANGLES, (GLint)first, (GLsizei)count);
    return;
  }
  GLenum type = index_bytes == 2 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT;
  const void *at = (const void *)(uintptr_t)(offset + first * (size_t)index_bytes);
  GL(gpu, DrawElements)(GL_TRIANGLES, (GLsizei)count, type, at);
}

/* ---- draws that the GPU counts ----------------------------------------------------------------------------------- */

enum { ARGUMENT_BYTES = 16 }; /* four unsigned integers: GL's DrawArraysIndirectCommand */

pn_result pni_counts_take(pni_gpu *gpu, const pni_texture *arguments, pni_buffer *buffer) {
  if (!gpu->can.indirect) return PN_OK;
  size_t bytes = ARGUMENT_BYTES * (size_t)arguments->width;
  pn_result result = pni_buffer_reserve(gpu, buffer, "counts", PNI_BUFFER_COUNTS, bytes);
  if (result != PN_OK || gpu->plan.on) return result;
  GL(gpu, BindBuffer)(GL_PIXEL_PACK_BUFFER, buffer->id);
  pni_texture_read(gpu, arguments, 0, 0, arguments->width, 1, 4, NULL); /* into the buffer */
  GL(gpu, BindBuffer)(GL_PIXEL_PACK_BUFFER, 0);
  return PN_OK;
}

void pni_draw_counted(pni_gpu *gpu, const pni_buffer *buffer, int index, int most) {
  if (gpu->plan.on) return;
  if (!gpu->can.indirect) {
    draw_arrays(gpu, GL_TRIANGLES, most);
    return;
  }
  unbind_others(gpu);
  pni_bind_vertex_array(gpu, gpu->vertex_array);
  GL(gpu, BindBuffer)(GL_DRAW_INDIRECT_BUFFER, buffer->id);
  GL(gpu, DrawArraysIndirect)(GL_TRIANGLES, (const void *)(uintptr_t)(ARGUMENT_BYTES * index));
}

/* ---- the host's own draws ---------------------------------------------------------------------------------------- */

void pni_host_begin(pni_gpu *gpu, const pni_texture *peel) {
  if (peel) pni_bind_texture(gpu, PNI_UNIT_PEEL, GL_TEXTURE_2D, peel->id, gpu->sampler_nearest);
}

void pni_host_end(pni_gpu *gpu) { pni_forget(gpu); }
