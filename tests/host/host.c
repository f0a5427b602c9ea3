#include "host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void record(void *user, pn_log_level level, int message_id, const char *text) {
  host *self = user;
  if (message_id > 0 && message_id < PN_MESSAGE_COUNT) self->log.counts[message_id]++;
  if (level == PN_LOG_ERROR) self->log.errors++;
  snprintf(self->log.last, sizeof self->log.last, "%s", text);
}

int host_open(host *self) {
  memset(self, 0, sizeof *self);
  if (!headless_open(&self->window)) return 0;
  scene_make(&self->world);
  return renderer_open(&self->draw, &self->world);
}

int host_open_compatible(host *self) {
  memset(self, 0, sizeof *self);
  if (!headless_open_compatible(&self->window)) return 0;
  scene_make(&self->world);
  return renderer_open(&self->draw, &self->world);
}

int host_open_model(host *self, const mesh *model) {
  memset(self, 0, sizeof *self);
  self->world.meshes[0] = *model;
  self->world.count = 1;
  return headless_open(&self->window) && renderer_open(&self->draw, &self->world);
}

void host_close(host *self) {
  gl.DeleteProgram(self->caster_programs[0]);
  gl.DeleteProgram(self->caster_programs[1]);
  pn_context_destroy(&self->context);
  renderer_close(&self->draw);
  scene_free(&self->world);
  headless_close(&self->window);
}

pn_context_desc host_context_desc(host *self) {
  return (pn_context_desc){.get_proc_address = gl_address, .log = record, .user = self};
}

pn_result host_context(host *self) {
  pn_context_desc desc = host_context_desc(self);
  return pn_context_create(&desc, &self->context);
}

int host_setup(void **state) {
  host *self = calloc(1, sizeof *self);
  if (!self || !host_open(self)) {
    fprintf(stderr, "no GL here: skipped\n");
    exit(77);
  }
  *state = self;
  pn_result result = host_context(self);
  if (result != PN_OK) fprintf(stderr, "pn_context_create: %s: %s\n", pn_result_name(result), self->log.last);
  return result;
}

int host_teardown(void **state) {
  host *self = *state;
  host_close(self);
  free(self);
  return 0;
}

int host_check(void **state) {
  (void)state;
  return gl_errors();
}

pn_mesh_desc host_mesh_desc(const host *self, int index, cast_kind kind) {
  const mesh *m = &self->world.meshes[index];
  const gpu_mesh *g = &self->draw.meshes[index];
  size_t vertices = (size_t)m->vertex_count, indices = (size_t)m->index_count;
  pn_mesh_desc out = {.index_bytes = 4};
  if (kind == CAST_BUFFERS) {
    out.positions = (pn_span){.buffer = g->posed, .offset = POSED_OFFSET, .stride = POSED_STRIDE, .count = vertices};
    out.indices = (pn_span){.buffer = g->indices, .count = indices};
    memcpy(out.bounds_min, m->bounds_min, sizeof out.bounds_min);
    memcpy(out.bounds_max, m->bounds_max, sizeof out.bounds_max);
  } else {
    out.positions = (pn_span){.data = m->posed, .count = vertices};
    out.indices = (pn_span){.data = m->indices, .count = indices};
  }
  if (m->holes) {
    out.alpha_texture = self->draw.holes;
    out.alpha_channel = 1;
    out.texcoords = kind == CAST_BUFFERS ? (pn_span){.buffer = g->vertices, .stride = 20, .count = vertices}
                                         : (pn_span){.data = m->texcoords, .count = vertices};
  }
  return out;
}

static pn_result cast_meshes(host *self, cast_kind kind) {
  for (int i = 0; i < self->world.count; i++) {
    const mesh *m = &self->world.meshes[i];
    if (!m->casts) continue;
    pn_mesh_desc desc = host_mesh_desc(self, i, kind);
    pn_result result = pn_mesh_add(self->casters, &desc, &self->meshes[i]);
    if (result == PN_OK) {
      result = pn_instance_add(self->casters, self->meshes[i], m->place, 0, &self->instances[i]);
    }
    if (result != PN_OK) return result;
  }
  return PN_OK;
}

static void draw_casters(void *user, const pn_caster_pass *pass) {
  host *self = user;
  GLuint program = self->caster_programs[pass->peel_texture != 0];
  if (pass->peel_texture) {
    self->peeled_passes++;
    gl.UseProgram(program);
    gl.Uniform1i(gl.GetUniformLocation(program, "pn_peel_map"), pass->peel_unit);
  }
  gl.BindSampler(0, 0);
  renderer_draw(&self->draw, &self->world, program, pass->clip_from_scene, DRAW_CASTERS);
}

static pn_result cast_callback(host *self) {
  if (!self->caster_programs[0]) {
    const char *text = pn_glsl(self->context, "caster", 330, 0);
    if (!text) return PN_ERROR_SHADER;
    self->caster_programs[0] = renderer_program(NULL, renderer_caster_body(0));
    self->caster_programs[1] = renderer_program(text, renderer_caster_body(1));
    if (!self->caster_programs[0] || !self->caster_programs[1]) return PN_ERROR_SHADER;
  }
  float bounds[6];
  scene_bounds(&self->world, bounds);
  return pn_casters_draw(self->casters, 0, draw_casters, self, bounds);
}

pn_result host_cast(host *self, cast_kind kind) {
  pn_result result = pn_casters_create(self->context, &self->casters);
  if (result != PN_OK) return result;
  return kind == CAST_CALLBACK ? cast_callback(self) : cast_meshes(self, kind);
}

void host_uncast(host *self) { pn_casters_destroy(&self->casters); }

pn_light_desc host_light_desc(void) {
  return (pn_light_desc){.center = {-1.5f, 3.6f, 2.6f},
                         .direction = {1.5f, -3.4f, -2.5f},
                         .half_u = 0.3f,
                         .half_v = 0.2f,
                         .map_width = 256};
}

pn_light_desc host_light_desc_other(void) {
  return (pn_light_desc){.center = {2.6f, 3.0f, 1.0f},
                         .direction = {-2.6f, -2.6f, -0.8f},
                         .axis_u = {0, 0, 1},
                         .half_u = 0.15f,
                         .half_v = 0.4f,
                         .map_width = 200,
                         .map_height = 120};
}

pn_light_desc host_sun_desc(void) {
  return (pn_light_desc){
      .shape = PN_LIGHT_SUN, .direction = {-0.5f, -2.0f, -0.7f}, .half_u = 0.05f, .half_v = 0.05f, .map_width = 256};
}

pn_result host_light(host *self, const pn_light_desc *desc, const char *technique, pn_light **out) {
  pn_result result = pn_light_create(self->context, out);
  if (result == PN_OK) result = pn_light_set(*out, desc);
  if (result == PN_OK && technique) result = pn_light_technique(*out, technique, NULL, 0);
  return result;
}

pn_receiver_desc host_receiver_desc(const camera *view, const depth_target *target) {
  pn_receiver_desc out = PN_RECEIVER_DEFAULTS;
  out.format = PN_FORMAT_R32F;
  if (target->is_renderbuffer) {
    out.depth_framebuffer = target->framebuffer;
    out.use_framebuffer = 1;
  } else {
    out.depth_texture = target->depth;
  }
  out.x = view->x, out.y = view->y, out.width = view->width, out.height = view->height;
  memcpy(out.view, view->view, sizeof out.view);
  memcpy(out.projection, view->projection, sizeof out.projection);
  out.depth_zero_to_one = view->zero_to_one;
  out.reversed_depth = view->reversed;
  return out;
}

pn_result host_view(host *self, const camera *view, camera_view *out) {
  *out = (camera_view){.view = *view};
  if (!target_open(&out->target, view)) return PN_ERROR_UNSUPPORTED;
  renderer_depth(&self->draw, &self->world, view, &out->target);
  pn_receiver_desc desc = host_receiver_desc(view, &out->target);
  pn_result result = pn_receiver_create(self->context, &out->receiver);
  return result == PN_OK ? pn_receiver_set(out->receiver, &desc) : result;
}

void host_view_close(camera_view *self) {
  pn_receiver_destroy(&self->receiver);
  target_close(&self->target);
}

pn_result host_lit_view(host *self, cast_kind kind, const pn_light_desc *desc, const char *technique, lit_view *out) {
  camera view = camera_at(0);
  *out = (lit_view){0};
  pn_result result = host_view(self, &view, &out->v);
  if (result == PN_OK) result = host_cast(self, kind);
  return result == PN_OK ? host_light(self, desc, technique, &out->light) : result;
}

void host_lit_view_close(host *self, lit_view *lit) {
  pn_light_destroy(&lit->light);
  host_uncast(self);
  host_view_close(&lit->v);
}

float *host_result(pn_light *light, pn_receiver *receiver) {
  pn_image image;
  if (pn_result_image(light, receiver, &image) != PN_OK || image.target != GL_TEXTURE_2D) return NULL;
  float *out = malloc((size_t)image.width * (size_t)image.height * sizeof *out);
  if (!out) return NULL;
  gl.BindTexture(GL_TEXTURE_2D, image.texture);
  gl.GetTexImage(GL_TEXTURE_2D, 0, GL_RED, GL_FLOAT, out);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  return out;
}

float *host_visibility(host *self, pn_light *light, const camera_view *view) {
  if (pn_maps_update(light, self->casters, PN_GROUPS_ALL, NULL, 0) != PN_OK) return NULL;
  if (pn_visibility(light, view->receiver) != PN_OK) return NULL;
  return host_result(light, view->receiver);
}

size_t host_gpu_memory(const host *self) {
  pn_info info = {0};
  return pn_context_info(self->context, &info) == PN_OK ? info.gpu_memory : 0;
}

const char *host_spec(int index) {
  static const char *const variants[] = {"average:samples=20",
                                         "bitmask:maps=layers",
                                         "bitmask:maps=layers,layers=4,focus=40",
                                         "bitmask:merge=0",
                                         "bitmask:merge=0,hierarchy=none",
                                         "ssm:accumulate=fp16-batched,faces=culled",
                                         "ssm:sides=front,extents=cpu",
                                         "smoothies:geometry=edges,width=0.1"};
  enum { VARIANTS = sizeof variants / sizeof *variants };
  if (index < VARIANTS) return variants[index];
  const pn_technique *t = NULL;
  for (int i = 0, left = index - VARIANTS; (t = pn_technique_at(i)); i++)
    if (strcmp(t->name, "average") != 0 && left-- == 0) return t->name;
  return NULL;
}
