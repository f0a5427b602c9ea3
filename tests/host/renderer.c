#include "renderer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const vertex_text = "#version 330 core\n"
                                       "in vec3 position;\n"
                                       "in vec2 texcoord;\n"
                                       "uniform mat4 clip_from_scene, scene_from_object;\n"
                                       "uniform float wave, phase;\n"
                                       "out vec3 scene;\n"
                                       "out vec2 uv;\n"
                                       "invariant gl_Position;\n"
                                       "void main() {\n"
                                       "  vec3 p = position;\n"
                                       "  p.z += wave * p.x * sin(4.0 * p.x + phase);\n"
                                       "  vec4 q = scene_from_object * vec4(p, 1.0);\n"
                                       "  scene = q.xyz;\n"
                                       "  uv = texcoord;\n"
                                       "  gl_Position = clip_from_scene * q;\n"
                                       "}\n";

static const char *const fragment_head =
    "#version 330 core\n"
    "in vec3 scene;\n"
    "in vec2 uv;\n"
    "uniform sampler2D holes;\n"
    "uniform int has_holes, object;\n"
    "void alpha_test() { if (has_holes != 0 && texture(holes, uv).g < 0.5) discard; }\n";

static const char *const surface_body = "layout(location = 0) out vec4 out_position;\n"
                                        "layout(location = 1) out vec4 out_normal;\n"
                                        "void main() {\n"
                                        "  vec3 n = normalize(cross(dFdx(scene), dFdy(scene)));\n"
                                        "  alpha_test();\n"
                                        "  out_position = vec4(scene, float(object));\n"
                                        "  out_normal = vec4(n, 0.0);\n"
                                        "}\n";

const char *renderer_caster_body(int peel) {
  return peel ? "void main() { pn_peel(); alpha_test(); }\n" : "void main() { alpha_test(); }\n";
}

static GLuint compile(GLenum stage, const char *const *parts, int count) {
  GLuint shader = gl.CreateShader(stage);
  GLint ok = 0;
  gl.ShaderSource(shader, count, parts, NULL);
  gl.CompileShader(shader);
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (!ok) {
    char log[2048] = "";
    gl.GetShaderInfoLog(shader, sizeof log, NULL, log);
    fprintf(stderr, "host client: %s\n", log);
  }
  return shader;
}

GLuint compile_program(const char *const *vertex, int vertex_parts, const char *const *fragment, int fragment_parts) {
  GLuint program = gl.CreateProgram();
  GLuint a = compile(GL_VERTEX_SHADER, vertex, vertex_parts), b = compile(GL_FRAGMENT_SHADER, fragment, fragment_parts);
  gl.AttachShader(program, a);
  gl.AttachShader(program, b);
  gl.BindAttribLocation(program, 0, "position");
  gl.BindAttribLocation(program, 1, "texcoord");
  gl.LinkProgram(program);
  gl.DeleteShader(a);
  gl.DeleteShader(b);
  GLint ok = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &ok);
  if (ok) return program;
  char log[2048] = "";
  gl.GetProgramInfoLog(program, sizeof log, NULL, log);
  fprintf(stderr, "host client: %s\n", log);
  gl.DeleteProgram(program);
  return 0;
}

GLuint renderer_program(const char *text, const char *body) {
  const char *parts[3] = {fragment_head, text ? text : "", body};
  return compile_program(&vertex_text, 1, parts, 3);
}

GLuint make_texture(GLenum format, int width, int height) {
  int is_depth = format == GL_DEPTH_COMPONENT32F || format == GL_DEPTH_COMPONENT24 || format == GL_DEPTH_COMPONENT16;
  int integer = format == GL_RGBA8UI;
  int stencil = format == GL_DEPTH24_STENCIL8 || format == GL_DEPTH32F_STENCIL8;
  GLenum layout = is_depth ? GL_DEPTH_COMPONENT : stencil ? GL_DEPTH_STENCIL : integer ? GL_RGBA_INTEGER : GL_RGBA;
  GLenum type = format == GL_DEPTH24_STENCIL8    ? GL_UNSIGNED_INT_24_8
                : format == GL_DEPTH32F_STENCIL8 ? GL_FLOAT_32_UNSIGNED_INT_24_8_REV
                : integer                        ? GL_UNSIGNED_BYTE
                                                 : GL_FLOAT;
  GLuint name = 0;
  gl.GenTextures(1, &name);
  gl.BindTexture(GL_TEXTURE_2D, name);
  gl.TexImage2D(GL_TEXTURE_2D, 0, (GLint)format, width, height, 0, layout, type, NULL);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  return name;
}

GLuint make_framebuffer(GLuint color, GLuint depth) {
  GLuint name = 0;
  gl.GenFramebuffers(1, &name);
  gl.BindFramebuffer(GL_FRAMEBUFFER, name);
  if (color) gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color, 0);
  if (depth) gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  return name;
}

static GLuint make_holes(void) {
  unsigned char texels[HOLE_TEXELS][HOLE_TEXELS][2];
  for (int y = 0; y < HOLE_TEXELS; y++) {
    for (int x = 0; x < HOLE_TEXELS; x++) {
      texels[y][x][0] = 0;
      texels[y][x][1] = scene_hole((x + 0.5) / HOLE_TEXELS, (y + 0.5) / HOLE_TEXELS) ? 0 : 255;
    }
  }
  GLuint name = 0;
  gl.GenTextures(1, &name);
  gl.BindTexture(GL_TEXTURE_2D, name);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RG8, HOLE_TEXELS, HOLE_TEXELS, 0, GL_RG, GL_UNSIGNED_BYTE, texels);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  return name;
}

static int upload(gpu_mesh *out, const mesh *m) {
  size_t count = (size_t)m->vertex_count;
  float *numbers = malloc(count * 5 * sizeof *numbers);
  if (!numbers) return 0;
  for (size_t i = 0; i < count; i++) {
    memcpy(numbers + 5 * i, m->texcoords + 2 * i, 2 * sizeof *numbers);
    memcpy(numbers + 5 * i + 2, m->rest + 3 * i, 3 * sizeof *numbers);
  }
  gl.GenVertexArrays(1, &out->vertex_array);
  gl.BindVertexArray(out->vertex_array);
  gl.GenBuffers(1, &out->vertices);
  gl.BindBuffer(GL_ARRAY_BUFFER, out->vertices);
  gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(count * 5 * sizeof *numbers), numbers, GL_STATIC_DRAW);
  gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 20, (const char *)NULL + 8);
  gl.VertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, 20, NULL);
  gl.EnableVertexAttribArray(0);
  gl.EnableVertexAttribArray(1);
  gl.GenBuffers(1, &out->indices);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, out->indices);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)((size_t)m->index_count * sizeof *m->indices), m->indices,
                GL_STATIC_DRAW);
  gl.BindVertexArray(0);
  gl.GenBuffers(1, &out->posed);
  free(numbers);
  return 1;
}

void renderer_pose(renderer *self, const scene *world) {
  for (int i = 0; i < world->count; i++) {
    const mesh *m = &world->meshes[i];
    size_t bytes = POSED_OFFSET + (size_t)m->vertex_count * POSED_STRIDE;
    char *data = calloc(bytes, 1);
    if (!data) return;
    for (int v = 0; v < m->vertex_count; v++) {
      memcpy(data + POSED_OFFSET + (size_t)v * POSED_STRIDE, m->posed + 3 * v, 3 * sizeof *m->posed);
    }
    gl.BindBuffer(GL_ARRAY_BUFFER, self->meshes[i].posed);
    gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)bytes, data, GL_DYNAMIC_DRAW);
    free(data);
  }
  gl.BindBuffer(GL_ARRAY_BUFFER, 0);
}

int renderer_open(renderer *out, const scene *world) {
  memset(out, 0, sizeof *out);
  for (int i = 0; i < world->count; i++) {
    if (!upload(&out->meshes[i], &world->meshes[i])) return 0;
  }
  renderer_pose(out, world);
  out->holes = make_holes();
  out->depth_program = renderer_program(NULL, renderer_caster_body(0));
  out->surface_program = renderer_program(NULL, surface_body);
  return out->depth_program && out->surface_program;
}

void renderer_close(renderer *self) {
  for (int i = 0; i < SCENE_MESHES; i++) {
    gpu_mesh *m = &self->meshes[i];
    GLuint buffers[3] = {m->vertices, m->posed, m->indices};
    gl.DeleteVertexArrays(1, &m->vertex_array);
    gl.DeleteBuffers(3, buffers);
  }
  gl.DeleteTextures(1, &self->holes);
  gl.DeleteProgram(self->depth_program);
  gl.DeleteProgram(self->surface_program);
}

static GLint uniform(GLuint program, const char *name) { return gl.GetUniformLocation(program, name); }

void renderer_draw(const renderer *self, const scene *world, GLuint program, const float clip_from_scene[16],
                   int which) {
  gl.UseProgram(program);
  gl.UniformMatrix4fv(uniform(program, "clip_from_scene"), 1, GL_FALSE, clip_from_scene);
  gl.Uniform1f(uniform(program, "phase"), world->phase);
  gl.Uniform1i(uniform(program, "holes"), 0);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, self->holes);
  for (int i = 0; i < world->count; i++) {
    const mesh *m = &world->meshes[i];
    if (!(which & (m->casts ? DRAW_CASTERS : DRAW_RECEIVERS))) continue;
    gl.UniformMatrix4fv(uniform(program, "scene_from_object"), 1, GL_FALSE, m->place);
    gl.Uniform1f(uniform(program, "wave"), m->wave);
    gl.Uniform1i(uniform(program, "has_holes"), m->holes);
    gl.Uniform1i(uniform(program, "object"), i);
    gl.BindVertexArray(self->meshes[i].vertex_array);
    gl.DrawElements(GL_TRIANGLES, m->index_count, GL_UNSIGNED_INT, NULL);
  }
  gl.BindVertexArray(0);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  gl.UseProgram(0);
}

static int has_stencil(unsigned format) { return format == GL_DEPTH24_STENCIL8 || format == GL_DEPTH32F_STENCIL8; }

int target_open(depth_target *out, const camera *view) {
  GLenum point = has_stencil(view->format) ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT;
  int w = view->target_width, h = view->target_height;
  *out = (depth_target){.is_renderbuffer = view->renderbuffer};
  gl.GenFramebuffers(1, &out->framebuffer);
  gl.BindFramebuffer(GL_FRAMEBUFFER, out->framebuffer);
  if (view->renderbuffer) {
    gl.GenRenderbuffers(1, &out->depth);
    gl.BindRenderbuffer(GL_RENDERBUFFER, out->depth);
    gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, view->samples, view->format, w, h);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, point, GL_RENDERBUFFER, out->depth);
    gl.BindRenderbuffer(GL_RENDERBUFFER, 0);
  } else if (view->samples) {
    gl.GenTextures(1, &out->depth);
    gl.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, out->depth);
    gl.TexImage2DMultisample(GL_TEXTURE_2D_MULTISAMPLE, view->samples, view->format, w, h, GL_TRUE);
    gl.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, 0);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, point, GL_TEXTURE_2D_MULTISAMPLE, out->depth, 0);
  } else {
    out->depth = make_texture(view->format, w, h);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, point, GL_TEXTURE_2D, out->depth, 0);
  }
  gl.DrawBuffer(GL_NONE);
  gl.ReadBuffer(GL_NONE);
  int complete = gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  return complete;
}

void target_close(depth_target *self) {
  gl.DeleteFramebuffers(1, &self->framebuffer);
  if (self->is_renderbuffer) {
    gl.DeleteRenderbuffers(1, &self->depth);
  } else {
    gl.DeleteTextures(1, &self->depth);
  }
  *self = (depth_target){0};
}

static void depth_state(const camera *view, int on) {
  if (view->zero_to_one && gl.ClipControl) gl.ClipControl(GL_LOWER_LEFT, on ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
  gl.DepthFunc(on && view->reversed ? GL_GREATER : GL_LESS);
  gl.ClearDepth(on && view->reversed ? 0 : 1);
  (on ? gl.Enable : gl.Disable)(GL_DEPTH_TEST);
}

void renderer_depth(const renderer *self, const scene *world, const camera *view, const depth_target *target) {
  mat4 clip = camera_clip(view);
  float m[16];
  to_float(&clip, m);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
  depth_state(view, 1);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.Viewport(view->x, view->y, view->width, view->height);
  renderer_draw(self, world, self->depth_program, m, DRAW_ALL);
  depth_state(view, 0);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
}

/* Where in the pixel the library's sample lies: its centre, or sample 0 of a multisampled target. */
static void sample_position(const camera *view, float position[2]) {
  depth_target target;
  position[0] = position[1] = 0.5f;
  if (!view->samples || !target_open(&target, view)) return;
  gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  gl.GetMultisamplefv(GL_SAMPLE_POSITION, 0, position);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  target_close(&target);
}

static void surfaces_read(surfaces *out, const camera *view) {
  mat4 m = from_float(view->view);
  int ortho = view->projection[15] != 0;
  gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
  gl.ReadPixels(0, 0, out->width, out->height, GL_RGBA, GL_FLOAT, out->position);
  gl.ReadBuffer(GL_COLOR_ATTACHMENT1);
  gl.ReadPixels(0, 0, out->width, out->height, GL_RGB, GL_FLOAT, out->normal);
  vec3 axis = v3(m.m[2], m.m[6], m.m[10]);
  for (int i = 0; i < out->width * out->height; i++) {
    vec3 p = project(&m, v3_of(out->position + 4 * i), NULL), n = v3_of(out->normal + 3 * i);
    vec3 eye_n =
        v3(m.m[0] * n.x + m.m[4] * n.y + m.m[8] * n.z, m.m[1] * n.x + m.m[5] * n.y + m.m[9] * n.z, dot(axis, n));
    double towards = ortho ? eye_n.z : -dot(eye_n, p);
    if (towards < 0) {
      for (int k = 0; k < 3; k++) out->normal[3 * i + k] = -out->normal[3 * i + k];
    }
  }
}

int surfaces_draw(surfaces *out, const renderer *self, const scene *world, const camera *view) {
  static const GLfloat nothing[4] = {0, 0, 0, -1};
  static const GLenum both[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  size_t pixels = (size_t)view->width * (size_t)view->height;
  *out = (surfaces){view->width, view->height, malloc(pixels * 4 * sizeof(float)), malloc(pixels * 3 * sizeof(float))};
  if (!out->position || !out->normal) return 0;
  float at[2];
  sample_position(view, at);
  mat4 clip = camera_clip(view), shift = translation((1 - 2 * at[0]) / view->width, (1 - 2 * at[1]) / view->height, 0);
  clip = multiply(&shift, &clip);
  float m[16];
  to_float(&clip, m);
  GLuint textures[3] = {make_texture(GL_RGBA32F, view->width, view->height),
                        make_texture(GL_RGBA32F, view->width, view->height),
                        make_texture(GL_DEPTH_COMPONENT32F, view->width, view->height)};
  GLuint framebuffer = make_framebuffer(textures[0], textures[2]);
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D, textures[1], 0);
  gl.DrawBuffers(2, both);
  depth_state(view, 1);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.ClearBufferfv(GL_COLOR, 0, nothing);
  gl.Viewport(0, 0, view->width, view->height);
  renderer_draw(self, world, self->surface_program, m, DRAW_ALL);
  depth_state(view, 0);
  surfaces_read(out, view);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl.DeleteFramebuffers(1, &framebuffer);
  gl.DeleteTextures(3, textures);
  return 1;
}

void surfaces_free(surfaces *self) {
  free(self->position);
  free(self->normal);
  *self = (surfaces){0};
}
