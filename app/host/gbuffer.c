#include "host/gbuffer.h"

#include <epoxy/gl.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "scene/vector.h"

static const char vertex_source[] = "#version 330 core\n"
                                    "layout(location = 0) in vec3 position;\n"
                                    "layout(location = 1) in vec2 texcoord;\n"
                                    "uniform mat4 clip_from_object;\n"
                                    "out vec2 uv;\n"
                                    "void main() {\n"
                                    "  uv = texcoord;\n"
                                    "  gl_Position = clip_from_object * vec4(position, 1.0);\n"
                                    "}\n";

/* The normal's side follows the winding on the screen, which stays right under mirroring transforms, where normals
 * are made with cofactors. */
static const char fragment_source[] =
    "#version 330 core\n"
    "in vec2 uv;\n"
    "uniform samplerBuffer normals;\n"
    "uniform sampler2D alpha;\n"
    "uniform float cutoff;\n"
    "uniform mat3 scene_from_object_cofactors;\n"
    "uniform float receives;\n"
    "layout(location = 0) out vec4 normal;\n"
    "layout(location = 1) out float mask;\n"
    "void main() {\n"
    "  if (cutoff > 0.0 && textureLod(alpha, uv, 0.0).r < cutoff) discard;\n"
    "  vec3 n = scene_from_object_cofactors * texelFetch(normals, gl_PrimitiveID).xyz;\n"
    "  n /= length(n);\n"
    "  normal = vec4(gl_FrontFacing ? n : -n, 1.0);\n"
    "  mask = receives;\n"
    "}\n";

static GLuint compile(GLenum stage, const char *source) {
  GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 1, &source, NULL);
  glCompileShader(shader);
  return shader;
}

static int link_program(struct gbuffer *g) {
  GLuint vertex = compile(GL_VERTEX_SHADER, vertex_source), fragment = compile(GL_FRAGMENT_SHADER, fragment_source);
  g->program = glCreateProgram();
  glAttachShader(g->program, vertex);
  glAttachShader(g->program, fragment);
  glLinkProgram(g->program);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  GLint linked = 0;
  glGetProgramiv(g->program, GL_LINK_STATUS, &linked);
  if (linked) return STATUS_OK;
  char log[300] = "";
  glGetProgramInfoLog(g->program, sizeof log, NULL, log);
  return work_error("the camera's shader does not link on this device: %s", log);
}

static pn_gl make_texture(GLenum internal, GLenum format, GLenum type, int width, int height) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, (GLint)internal, width, height, 0, format, type, NULL);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

static int make_targets(struct gbuffer *g) {
  GLint limit = 0, viewport[2] = {0, 0};
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  int widest = limit < viewport[0] ? limit : viewport[0], highest = limit < viewport[1] ? limit : viewport[1];
  if (g->width > widest || g->height > highest)
    return input_error("--size %dx%d is beyond this device's limit of %dx%d", g->width, g->height, widest, highest);
  g->depth = make_texture(GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, g->width, g->height);
  g->normal = make_texture(GL_RGBA32F, GL_RGBA, GL_FLOAT, g->width, g->height);
  g->mask = make_texture(GL_R8, GL_RED, GL_UNSIGNED_BYTE, g->width, g->height);
  if (glGetError() == GL_OUT_OF_MEMORY)
    return work_error("the GL device ran out of memory for a picture of %dx%d", g->width, g->height);
  glGenFramebuffers(1, &g->framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, g->framebuffer);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, g->depth, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, g->normal, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D, g->mask, 0);
  const GLenum targets[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glDrawBuffers(2, targets);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return work_error("this device cannot draw into the camera's framebuffer");
  return STATUS_OK;
}

static void set_view(struct gbuffer *g, const struct camera *camera, const double origin[3]) {
  double z[3], x[3], y[3], eye[3], up[3] = {camera->up[0], camera->up[1], camera->up[2]};
  v3_sub(camera->position, origin, eye);
  v3_sub(camera->position, camera->target, z);
  v3_normalize(z);
  v3_normalize(up);
  v3_cross(up, z, x);
  if (v3_length(x) < 1e-6) { /* looking along up: the top of the picture is away from +z, or +x */
    double other[3] = {0, 0, fabs(z[2]) > 0.9 ? 0 : -1};
    if (fabs(z[2]) > 0.9) other[0] = 1;
    v3_cross(other, z, x);
  }
  v3_normalize(x);
  v3_cross(z, x, y);
  for (int k = 0; k < 3; k++) {
    g->view[4 * k + 0] = (float)x[k];
    g->view[4 * k + 1] = (float)y[k];
    g->view[4 * k + 2] = (float)z[k];
    g->view[4 * k + 3] = 0;
  }
  g->view[12] = (float)-v3_dot(x, eye);
  g->view[13] = (float)-v3_dot(y, eye);
  g->view[14] = (float)-v3_dot(z, eye);
  g->view[15] = 1;
}

static void set_projection(struct gbuffer *g, double fov, double near, double far) {
  double f = 1 / tan(fov * 3.14159265358979323846 / 360);
  memset(g->projection, 0, sizeof g->projection);
  g->projection[0] = (float)(f * g->height / g->width);
  g->projection[5] = (float)f;
  g->projection[10] = (float)((near + far) / (near - far));
  g->projection[11] = -1;
  g->projection[14] = (float)(2 * near * far / (near - far));
}

/* out = a * b, column-major, in double. */
static void multiply(const double a[16], const double b[16], double out[16]) {
  for (int c = 0; c < 4; c++)
    for (int r = 0; r < 4; r++) {
      out[4 * c + r] = 0;
      for (int k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
    }
}

static void widen(const float in[16], double out[16]) {
  for (int i = 0; i < 16; i++) out[i] = in[i];
}

static void set_instance(const struct gbuffer *g, const struct instance *instance) {
  double p[16], v[16], m[16], pv[16], pvm[16], columns[3][3], cofactors[3][3];
  widen(g->projection, p);
  widen(g->view, v);
  widen(instance->placed, m);
  multiply(p, v, pv);
  multiply(pv, m, pvm);
  float clip[16], normal[9];
  for (int i = 0; i < 16; i++) clip[i] = (float)pvm[i];
  for (int c = 0; c < 3; c++)
    for (int r = 0; r < 3; r++) columns[c][r] = m[4 * c + r];
  double largest = 0;
  for (int c = 0; c < 3; c++) {
    v3_cross(columns[(c + 1) % 3], columns[(c + 2) % 3], cofactors[c]);
    largest = fmax(largest, v3_length(cofactors[c]));
  }
  for (int i = 0; i < 9; i++) normal[i] = (float)(cofactors[i / 3][i % 3] / (largest > 0 ? largest : 1));
  glUniformMatrix4fv(glGetUniformLocation(g->program, "clip_from_object"), 1, GL_FALSE, clip);
  glUniformMatrix3fv(glGetUniformLocation(g->program, "scene_from_object_cofactors"), 1, GL_FALSE, normal);
  glUniform1f(glGetUniformLocation(g->program, "receives"), instance->receives ? 1 : 0);
}

static void draw_instance(const struct gbuffer *g, const struct gpu_scene *gpu, const struct instance *instance) {
  const struct mesh *mesh = &gpu->scene->meshes[instance->mesh];
  const struct gpu_mesh *buffers = &gpu->meshes[instance->mesh];
  set_instance(g, instance);
  glUniform1f(glGetUniformLocation(g->program, "cutoff"), mesh->texture >= 0 ? mesh->cutoff : 0);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, mesh->texture >= 0 ? gpu->textures[mesh->texture] : 0);
  glActiveTexture(GL_TEXTURE0);
  glBindVertexArray(buffers->vertex_array);
  for (int i = 0; i < buffers->run_count; i++) {
    const struct gpu_run *run = &buffers->runs[i];
    glBindTexture(GL_TEXTURE_BUFFER, run->normals);
    const char *offset = (const char *)0 + (size_t)run->first * 3 * sizeof(uint32_t);
    glDrawElements(GL_TRIANGLES, (GLsizei)(run->count * 3), GL_UNSIGNED_INT, offset);
  }
}

static void draw(const struct gbuffer *g, const struct gpu_scene *gpu) {
  glBindFramebuffer(GL_FRAMEBUFFER, g->framebuffer);
  glViewport(0, 0, g->width, g->height);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glClearColor(0, 0, 0, 0);
  glClearDepth(1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glUseProgram(g->program);
  glUniform1i(glGetUniformLocation(g->program, "normals"), 0);
  glUniform1i(glGetUniformLocation(g->program, "alpha"), 1);
  for (int i = 0; i < gpu->scene->instance_count; i++) draw_instance(g, gpu, &gpu->scene->instances[i]);
  glBindVertexArray(0);
  glUseProgram(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

static float *read_depth(const struct gbuffer *g) {
  float *depth = malloc((size_t)g->width * (size_t)g->height * sizeof *depth);
  if (!depth) return NULL;
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glBindTexture(GL_TEXTURE_2D, g->depth);
  glGetTexImage(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT, GL_FLOAT, depth);
  return depth;
}

static double eye_distance(const struct gbuffer *g, double depth) {
  return g->projection[14] / (2 * depth - 1 + g->projection[10]);
}

/* Planes around everything first, then close around what that showed: the depth buffer's precision is what the
 * surface's positions have. */
static int draw_tightly(struct gbuffer *g, const struct gpu_scene *gpu) {
  const struct scene *scene = gpu->scene;
  double far = 0, near = DBL_MAX, z[3] = {g->view[2], g->view[6], g->view[10]};
  for (int i = 0; i < scene->instance_count; i++) {
    const struct instance *instance = &scene->instances[i];
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    double placed[16];
    widen(instance->placed, placed);
    for (int c = 0; c < 8; c++) {
      double p[3], q[3];
      for (int k = 0; k < 3; k++) p[k] = c >> k & 1 ? mesh->bounds_max[k] : mesh->bounds_min[k];
      m4_point(placed, p, q);
      double distance = -(v3_dot(z, q) + g->view[14]);
      far = fmax(far, distance);
      near = fmin(near, distance);
    }
  }
  if (!(far > 0)) far = 1; /* everything is behind the camera */
  far *= 1.001;
  near = fmax(near * 0.999, far * 1e-4);
  set_projection(g, scene->setup.camera.fov, near, far);
  draw(g, gpu);
  float *depth = read_depth(g);
  if (!depth) return memory_error();
  float least = 1, most = 0;
  for (size_t i = 0; i < (size_t)g->width * (size_t)g->height; i++)
    if (depth[i] < 1) {
      least = fminf(least, depth[i]);
      most = fmaxf(most, depth[i]);
    }
  free(depth);
  if (least >= 1) return STATUS_OK; /* nothing but background */
  double nearest = fmax(near, 0.98 * eye_distance(g, least)), farthest = fmin(far, 1.02 * eye_distance(g, most));
  if (!(farthest > nearest)) return STATUS_OK;
  set_projection(g, scene->setup.camera.fov, nearest, farthest);
  draw(g, gpu);
  return STATUS_OK;
}

int gbuffer_create(const struct gpu_scene *gpu, struct gbuffer **out) {
  *out = NULL;
  struct gbuffer *g = calloc(1, sizeof *g);
  if (!g) return memory_error();
  g->width = gpu->scene->setup.size[0];
  g->height = gpu->scene->setup.size[1];
  int status = make_targets(g);
  if (!status) status = link_program(g);
  if (!status) {
    set_view(g, &gpu->scene->setup.camera, gpu->scene->origin);
    status = draw_tightly(g, gpu);
  }
  if (status) gbuffer_free(&g);
  *out = g;
  return status;
}

void gbuffer_free(struct gbuffer **gbuffer) {
  if (!gbuffer || !*gbuffer) return;
  struct gbuffer *g = *gbuffer;
  const GLuint textures[3] = {g->depth, g->normal, g->mask};
  glDeleteFramebuffers(1, &g->framebuffer);
  glDeleteTextures(3, textures);
  glDeleteProgram(g->program);
  free(g);
  *gbuffer = NULL;
}
