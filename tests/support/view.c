#include "view.h"

#include <stdlib.h>
#include <string.h>

/* ---- matrices, column-major ---- */

static void look_at(const camera *c, float out[16]) {
  vec back = unit(sub(c->eye, c->target)), right = unit(cross(c->up, back)), up = cross(back, right);
  const vec rows[3] = {right, up, back};
  memset(out, 0, 16 * sizeof *out);
  for (int r = 0; r < 3; r++) {
    out[r] = (float)rows[r].x;
    out[4 + r] = (float)rows[r].y;
    out[8 + r] = (float)rows[r].z;
    out[12 + r] = (float)-dot(rows[r], c->eye);
  }
  out[15] = 1;
}

/* Clip depth runs from -1 (or 0) at the first distance to 1 at the second; reversed swaps them and runs from 0. */
static void project(const camera *c, float out[16]) {
  double aspect = (double)c->width / c->height, low = c->reversed ? 0 : -1;
  double start = c->reversed ? c->far : c->near, end = c->reversed ? c->near : c->far;
  memset(out, 0, 16 * sizeof *out);
  out[0] = (float)(1 / (c->half_height * aspect));
  out[5] = (float)(1 / c->half_height);
  if (c->orthographic) {
    out[10] = (float)(-(1 - low) / (end - start));
    out[14] = (float)(1 - (1 - low) * end / (end - start));
    out[15] = 1;
  } else { /* depth = a + b / z, z the distance before the camera */
    double b = (1 - low) / (1 / end - 1 / start), a = 1 - b / end;
    out[10] = (float)-a;
    out[14] = (float)b;
    out[11] = -1;
  }
}

static void multiply(const double a[16], const double b[16], double out[16]) {
  for (int c = 0; c < 4; c++)
    for (int r = 0; r < 4; r++) {
      out[4 * c + r] = 0;
      for (int k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
    }
}

static void clip_matrix(const view *v, double out[16]) {
  double a[16], b[16];
  for (int i = 0; i < 16; i++) {
    a[i] = v->projection[i];
    b[i] = v->view[i];
  }
  multiply(a, b, out);
}

/* ---- drawing ---- */

static const char vertex_text[] =
    "layout(location = 0) in vec3 position; layout(location = 1) in vec3 normal; uniform mat4 clip; out vec3 n;\n"
    "void main() { gl_Position = clip * vec4(position, 1.0); n = normal; }\n";
static const char fragment_text[] =
    "in vec3 n; layout(location = 0) out vec4 out_normal; layout(location = 1) out vec4 out_shown;\n"
    "void main() { out_normal = vec4(n, 1.0); out_shown = vec4(float(gl_PrimitiveID)); }\n";

static GLuint make_texture(GLenum format, int width, int height) {
  GLuint texture;
  bool depth = format != GL_RGBA32F && format != GL_R32F;
  GLenum layout = depth ? GL_DEPTH_COMPONENT : GL_RGBA;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, (GLint)format, width, height, 0, layout, depth ? GL_UNSIGNED_INT : GL_FLOAT, NULL);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  glBindTexture(GL_TEXTURE_2D, 0);
  return texture;
}

static GLuint upload(const soup *s, GLuint *array) {
  float *vertices = malloc((size_t)(s->count ? s->count : 1) * 18 * sizeof *vertices), *at = vertices;
  for (int t = 0; t < s->count; t++) {
    vec n = normal_of(&s->list[t]);
    const float normal[3] = {(float)n.x, (float)n.y, (float)n.z};
    for (int i = 0; i < 3; i++, at += 6) {
      memcpy(at, s->list[t].p[i], 12);
      memcpy(at + 3, normal, 12);
    }
  }
  GLuint buffer;
  glGenVertexArrays(1, array);
  glBindVertexArray(*array);
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)((size_t)s->count * 18 * sizeof *vertices), vertices, GL_STATIC_DRAW);
  free(vertices);
  for (GLuint i = 0; i < 2; i++) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, 24, (const void *)(uintptr_t)(12 * i));
  }
  return buffer;
}

static void draw_surfaces(const view *v) {
  static const GLfloat none[4] = {-1, -1, -1, -1}, zero[4] = {0, 0, 0, 0};
  GLfloat background = v->camera.reversed ? 0 : 1;
  double clip[16];
  float matrix[16];
  clip_matrix(v, clip);
  for (int i = 0; i < 16; i++) matrix[i] = (float)clip[i];
  GLuint array, buffer = upload(v->surfaces, &array), program = gl_program(vertex_text, fragment_text);
  if (v->camera.reversed) glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glViewport(0, 0, v->camera.width, v->camera.height);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(v->camera.reversed ? GL_GREATER : GL_LESS);
  glClearBufferfv(GL_COLOR, 0, zero);
  glClearBufferfv(GL_COLOR, 1, none);
  glClearBufferfv(GL_DEPTH, 0, &background);
  glUseProgram(program);
  glUniformMatrix4fv(glGetUniformLocation(program, "clip"), 1, GL_FALSE, matrix);
  glDrawArrays(GL_TRIANGLES, 0, 3 * v->surfaces->count);
  glDisable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  if (v->camera.reversed) glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  glUseProgram(0);
  glBindVertexArray(0);
  glDeleteProgram(program);
  glDeleteVertexArrays(1, &array);
  glDeleteBuffers(1, &buffer);
}

void view_draw(view *v, const camera *c, const soup *surfaces) {
  static const GLenum both[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  *v = (view){.camera = *c, .surfaces = surfaces};
  look_at(c, v->view);
  project(c, v->projection);
  v->depth = make_texture(c->depth_format ? c->depth_format : GL_DEPTH_COMPONENT32F, c->width, c->height);
  v->normal = make_texture(GL_RGBA32F, c->width, c->height);
  GLuint framebuffer, shown = make_texture(GL_R32F, c->width, c->height);
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, v->depth, 0);
  glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, both[0], GL_TEXTURE_2D, v->normal, 0);
  glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, both[1], GL_TEXTURE_2D, shown, 0);
  glDrawBuffers(2, both);
  assert_int_equal(glCheckFramebufferStatus(GL_DRAW_FRAMEBUFFER), GL_FRAMEBUFFER_COMPLETE);
  draw_surfaces(v);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glDeleteFramebuffers(1, &framebuffer);
  float *ids = gl_read_texture(shown, 0, -1, c->width, c->height, 1);
  v->depths = gl_read_depth(v->depth, -1, c->width, c->height);
  v->shown = malloc((size_t)c->width * (size_t)c->height * sizeof *v->shown);
  for (int i = 0; i < c->width * c->height; i++) v->shown[i] = (int)ids[i];
  free(ids);
  glDeleteTextures(1, &shown);
}

void view_free(view *v) {
  glDeleteTextures(1, &v->depth);
  glDeleteTextures(1, &v->normal);
  free(v->shown);
  free(v->depths);
  *v = (view){0};
}

pn_receiver_desc view_desc(const view *v, bool normals) {
  pn_receiver_desc d = PN_RECEIVER_DEFAULTS;
  d.depth_texture = v->depth;
  d.reversed_depth = v->camera.reversed;
  d.depth_zero_to_one = v->camera.reversed;
  d.normal_texture = normals ? v->normal : 0;
  d.format = PN_FORMAT_R32F;
  memcpy(d.view, v->view, sizeof d.view);
  memcpy(d.projection, v->projection, sizeof d.projection);
  return d;
}

/* ---- truth ---- */

/* The pixel's line holds the scene points with (row 0 - x row 3) . p = 0 and (row 1 - y row 3) . p = 0; with the
 * triangle's plane these are three linear equations. */
vec view_point(const view *v, int x, int y) {
  double m[16], rhs[3];
  clip_matrix(v, m);
  const triangle *t = &v->surfaces->list[view_shown(v, x, y)];
  double ndc[2] = {2 * (x + 0.5) / v->camera.width - 1, 2 * (y + 0.5) / v->camera.height - 1};
  vec row[3];
  for (int i = 0; i < 2; i++) {
    row[i] = v3(m[i] - ndc[i] * m[3], m[4 + i] - ndc[i] * m[7], m[8 + i] - ndc[i] * m[11]);
    rhs[i] = -(m[12 + i] - ndc[i] * m[15]);
  }
  row[2] = normal_of(t);
  rhs[2] = dot(row[2], corner_of(t, 0));
  double determinant = dot(row[0], cross(row[1], row[2]));
  vec sum = add(mul(rhs[0], cross(row[1], row[2])),
                add(mul(rhs[1], cross(row[2], row[0])), mul(rhs[2], cross(row[0], row[1]))));
  return mul(1 / determinant, sum);
}

vec view_normal(const view *v, int x, int y) {
  vec n = normal_of(&v->surfaces->list[view_shown(v, x, y)]);
  vec to_eye = v->camera.orthographic ? sub(v->camera.eye, v->camera.target) : sub(v->camera.eye, view_point(v, x, y));
  return dot(n, to_eye) < 0 ? mul(-1, n) : n;
}

static bool same_plane(const view *v, int a, int b) {
  if (a == b) return true;
  if (a < 0 || b < 0) return false;
  const triangle *t = &v->surfaces->list[a], *other = &v->surfaces->list[b];
  vec n = normal_of(t);
  double size = length(sub(corner_of(t, 1), corner_of(t, 0)));
  for (int i = 0; i < 3; i++)
    if (fabs(dot(n, sub(corner_of(other, i), corner_of(t, 0)))) > 1e-6 * size) return false;
  return true;
}

bool view_flat_around(const view *v, int x, int y, int distance) {
  int here = view_shown(v, x, y);
  if (here < 0) return false;
  for (int j = y - distance; j <= y + distance; j++)
    for (int i = x - distance; i <= x + distance; i++) {
      if (i < 0 || j < 0 || i >= v->camera.width || j >= v->camera.height) continue;
      if (!same_plane(v, here, view_shown(v, i, j))) return false;
    }
  return true;
}
