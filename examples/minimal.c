/* A window with a small renderer of its own, into which penumbra brings the soft shadow of an area light. Everything
 * that has to do with penumbra stands between the "penumbra" marks, at most 40 lines in all; the rest is what any
 * renderer has.
 *
 *     minimal [--frames N] [--screenshot FILE.ppm]
 *
 * Escape closes the window. With --frames it closes after N frames; --screenshot writes the last one. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
/* penumbra */
#include <penumbra/penumbra.h>
/* end */

enum { BOX_VERTICES = 36, FLOOR_VERTICES = 6, VERTEX_BYTES = 6 * sizeof(float) };

static const float light_center[3] = {-1.6f, 3.6f, 1.4f}, light_half = 0.55f;

typedef struct {
  GLuint program, vertices, vertex_array, depth, prepass;
  int width, height;
} renderer;

/* penumbra */
typedef struct {
  pn_context *context;
  pn_casters *casters;
  pn_receiver *view;
  pn_light *light;
  pn_instance box;
} shadows;

static pn_result shadows_open(shadows *s, const renderer *r, const float box[16]) {
  pn_mesh mesh = {0};
  pn_mesh_desc shape = {.positions = {.buffer = r->vertices, .stride = VERTEX_BYTES, .count = BOX_VERTICES},
                        .bounds_min = {-0.5f, -0.5f, -0.5f}, .bounds_max = {0.5f, 0.5f, 0.5f}};
  pn_light_desc light = {.center = {light_center[0], light_center[1], light_center[2]},
                         .direction = {1.6f, -3.1f, -1.4f}, .half_u = light_half, .half_v = light_half};
  pn_result result = pn_context_create(NULL, &s->context);
  if (!result) result = pn_casters_create(s->context, &s->casters);
  if (!result) result = pn_mesh_add(s->casters, &shape, &mesh);
  if (!result) result = pn_instance_add(s->casters, mesh, box, 0, &s->box);
  if (!result) result = pn_receiver_create(s->context, &s->view);
  if (!result) result = pn_light_create(s->context, &s->light);
  return result ? result : pn_light_set(s->light, &light);
}

/* After the depth pre-pass: a texture with the visible fraction of the light for each pixel. */
static GLuint shadows_draw(shadows *s, GLuint depth, const float *box, const float *view, const float *projection) {
  pn_image visibility = {0};
  pn_receiver_desc desc = {.depth_texture = depth};
  memcpy(desc.view, view, sizeof desc.view);
  memcpy(desc.projection, projection, sizeof desc.projection);
  pn_result result = pn_instance_move(s->casters, s->box, box);
  if (!result) result = pn_receiver_set(s->view, &desc);
  if (!result) result = pn_maps_update(s->light, s->casters, PN_GROUPS_ALL, &s->view, 1);
  if (!result) result = pn_visibility(s->light, s->view);
  if (!result) result = pn_result_image(s->light, s->view, &visibility);
  return result ? 0 : visibility.texture;
}
/* end */

/* ---- matrices, column-major -------------------------------------------------------------------------------------- */

static void multiply(float out[16], const float a[16], const float b[16]) {
  for (int i = 0; i < 16; i++) {
    out[i] = 0;
    for (int k = 0; k < 4; k++) out[i] += a[4 * k + i % 4] * b[i / 4 * 4 + k];
  }
}

static void perspective(float out[16], float tangent, float aspect, float near, float far) {
  memset(out, 0, 16 * sizeof *out);
  out[0] = 1 / (tangent * aspect);
  out[5] = 1 / tangent;
  out[10] = -(far + near) / (far - near);
  out[11] = -1;
  out[14] = -2 * far * near / (far - near);
}

/* The eye at the given height and distance, looking down a little at the box. */
static void view_from(float out[16], float height, float distance) {
  float a = -0.8f * atanf(height / distance), c = cosf(a), s = sinf(a);
  float turn[16] = {1, 0, 0, 0, 0, c, -s, 0, 0, s, c, 0, 0, 0, 0, 1};
  float move[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -height, -distance, 1};
  turn[6] = -s, turn[9] = s;
  multiply(out, turn, move);
}

static void box_at(float out[16], float angle) {
  float c = cosf(angle), s = sinf(angle);
  float m[16] = {c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, 0, 0.62f, 0, 1};
  memcpy(out, m, sizeof m);
}

/* ---- the renderer ------------------------------------------------------------------------------------------------ */

static const char *const vertex_text =
    "#version 330 core\n"
    "layout(location = 0) in vec3 position;\n"
    "layout(location = 1) in vec3 normal;\n"
    "uniform mat4 clip_from_scene, scene_from_object;\n"
    "out vec3 scene, n;\n"
    "invariant gl_Position;\n"
    "void main() {\n"
    "  vec4 p = scene_from_object * vec4(position, 1.0);\n"
    "  scene = p.xyz;\n"
    "  n = mat3(scene_from_object) * normal;\n"
    "  gl_Position = clip_from_scene * p;\n"
    "}\n";

static const char *const fragment_text =
    "#version 330 core\n"
    "in vec3 scene, n;\n"
    "uniform sampler2D visibility;\n"
    "uniform vec3 light, color;\n"
    "out vec4 result;\n"
    "void main() {\n"
    "  vec3 to_light = normalize(light - scene);\n"
    "  float lit = max(dot(normalize(n), to_light), 0.0) * texelFetch(visibility, ivec2(gl_FragCoord.xy), 0).r;\n"
    "  result = vec4(pow(color * (0.06 + 0.94 * lit), vec3(1.0 / 2.2)), 1.0);\n"
    "}\n";

static GLuint compile(GLenum stage, const char *text) {
  GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 1, &text, NULL);
  glCompileShader(shader);
  return shader;
}

static int link_program(renderer *r) {
  GLint ok = 0;
  r->program = glCreateProgram();
  GLuint vertex = compile(GL_VERTEX_SHADER, vertex_text), fragment = compile(GL_FRAGMENT_SHADER, fragment_text);
  glAttachShader(r->program, vertex);
  glAttachShader(r->program, fragment);
  glLinkProgram(r->program);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  glGetProgramiv(r->program, GL_LINK_STATUS, &ok);
  return ok;
}

static void put_vertex(float *out, const float position[3], int axis, float normal) {
  memcpy(out, position, 3 * sizeof *out);
  out[3 + axis] = normal;
}

/* A box of side 1 around the origin, then a floor. */
static void make_vertices(float *out) {
  static const int corners[6][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}};
  for (int face = 0; face < 6; face++) {
    for (int i = 0; i < 6; i++, out += 6) {
      int axis = face / 2;
      float side = face % 2 ? 0.5f : -0.5f, p[3];
      p[axis] = side;
      p[(axis + 1) % 3] = 0.5f * (float)corners[i][0];
      p[(axis + 2) % 3] = 0.5f * (float)corners[i][1];
      put_vertex(out, p, axis, 2 * side);
    }
  }
  for (int i = 0; i < FLOOR_VERTICES; i++, out += 6) {
    float p[3] = {4 * (float)corners[i][0], 0, 4 * (float)corners[i][1]};
    put_vertex(out, p, 1, 1);
  }
}

static int renderer_open(renderer *r) {
  float numbers[(BOX_VERTICES + FLOOR_VERTICES) * 6] = {0};
  make_vertices(numbers);
  glGenVertexArrays(1, &r->vertex_array);
  glBindVertexArray(r->vertex_array);
  glGenBuffers(1, &r->vertices);
  glBindBuffer(GL_ARRAY_BUFFER, r->vertices);
  glBufferData(GL_ARRAY_BUFFER, sizeof numbers, numbers, GL_STATIC_DRAW);
  for (GLuint i = 0; i < 2; i++) {
    glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, VERTEX_BYTES, (const char *)NULL + i * 3 * sizeof(float));
    glEnableVertexAttribArray(i);
  }
  glGenFramebuffers(1, &r->prepass);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  return link_program(r);
}

static void renderer_resize(renderer *r, int width, int height) {
  if (width == r->width && height == r->height) return;
  r->width = width, r->height = height;
  glDeleteTextures(1, &r->depth);
  glGenTextures(1, &r->depth);
  glBindTexture(GL_TEXTURE_2D, r->depth);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, width, height, 0, GL_DEPTH_COMPONENT, GL_FLOAT, NULL);
  glBindFramebuffer(GL_FRAMEBUFFER, r->prepass);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, r->depth, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
}

static void draw_part(const renderer *r, const float place[16], const float color[3], int first, int count) {
  glUniformMatrix4fv(glGetUniformLocation(r->program, "scene_from_object"), 1, GL_FALSE, place);
  glUniform3fv(glGetUniformLocation(r->program, "color"), 1, color);
  glDrawArrays(GL_TRIANGLES, first, count);
}

static void draw_scene(const renderer *r, GLuint framebuffer, GLuint visibility, const float *clip, const float *box) {
  static const float still[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  static const float red[3] = {0.7f, 0.25f, 0.2f}, grey[3] = {0.6f, 0.6f, 0.58f};
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, r->width, r->height);
  glClearColor(0.2f, 0.25f, 0.32f, 1);
  glClear(GL_DEPTH_BUFFER_BIT | (framebuffer ? 0 : GL_COLOR_BUFFER_BIT));
  glUseProgram(r->program);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, visibility);
  glUniformMatrix4fv(glGetUniformLocation(r->program, "clip_from_scene"), 1, GL_FALSE, clip);
  glUniform3fv(glGetUniformLocation(r->program, "light"), 1, light_center);
  glUniform1i(glGetUniformLocation(r->program, "visibility"), 0);
  glBindVertexArray(r->vertex_array);
  draw_part(r, box, red, 0, BOX_VERTICES);
  draw_part(r, still, grey, BOX_VERTICES, FLOOR_VERTICES);
}

/* ---- the window -------------------------------------------------------------------------------------------------- */

static int frame(renderer *r, shadows *s, float angle) {
  float box[16], view[16], projection[16], clip[16];
  box_at(box, angle);
  view_from(view, 2.6f, 4.2f);
  perspective(projection, 0.45f, (float)r->width / (float)r->height, 0.1f, 50);
  multiply(clip, projection, view);
  draw_scene(r, r->prepass, 0, clip, box);
  /* penumbra */
  GLuint visibility = shadows_draw(s, r->depth, box, view, projection);
  /* end */
  draw_scene(r, 0, visibility, clip, box);
  return visibility != 0;
}

static int screenshot(const char *path, int width, int height) {
  size_t row = 3 * (size_t)width;
  unsigned char *pixels = malloc(row * (size_t)height);
  FILE *file = pixels ? fopen(path, "wb") : NULL;
  int ok = file != NULL;
  if (ok) {
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels);
    fprintf(file, "P6\n%d %d\n255\n", width, height);
    for (int y = height - 1; y >= 0; y--) ok &= fwrite(pixels + (size_t)y * row, 1, row, file) == row;
    ok &= fclose(file) == 0;
  }
  free(pixels);
  if (!ok) fprintf(stderr, "minimal: cannot write %s\n", path);
  return ok;
}

static GLFWwindow *open_window(void) {
  if (!glfwInit()) return NULL;
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  GLFWwindow *window = glfwCreateWindow(960, 720, "penumbra: minimal", NULL, NULL);
  if (window) glfwMakeContextCurrent(window);
  return window;
}

static int run(GLFWwindow *window, long frames, const char *picture) {
  renderer r = {0};
  float box[16];
  box_at(box, 0);
  int ok = renderer_open(&r);
  /* penumbra */
  shadows s = {0};
  ok = ok && shadows_open(&s, &r, box) == PN_OK;
  /* end */
  if (!ok) fprintf(stderr, "minimal: this OpenGL cannot do it\n");
  for (long i = 0; ok && !glfwWindowShouldClose(window) && (frames == 0 || i < frames); i++) {
    int width, height;
    glfwPollEvents();
    glfwGetFramebufferSize(window, &width, &height);
    if (glfwGetKey(window, GLFW_KEY_ESCAPE) == GLFW_PRESS) break;
    if (width == 0 || height == 0) continue;
    renderer_resize(&r, width, height);
    ok = frame(&r, &s, frames ? 0.6f : (float)glfwGetTime() * 0.5f);
    if (ok && picture && i + 1 == frames) ok = screenshot(picture, width, height);
    glfwSwapBuffers(window);
  }
  /* penumbra */
  pn_context_destroy(&s.context);
  /* end */
  return ok;
}

int main(int argc, char **argv) {
  long frames = 0;
  const char *picture = NULL;
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "--frames") == 0 && i + 1 < argc) {
      frames = strtol(argv[++i], NULL, 10);
    } else if (strcmp(argv[i], "--screenshot") == 0 && i + 1 < argc) {
      picture = argv[++i];
    } else {
      fprintf(stderr, "minimal: unknown option %s; there are --frames N and --screenshot FILE.ppm\n", argv[i]);
      return 2;
    }
  }
  GLFWwindow *window = open_window();
  if (!window) {
    fprintf(stderr, "minimal: no window with OpenGL 3.3\n");
    glfwTerminate();
    return 1;
  }
  int ok = run(window, frames, picture);
  glfwTerminate();
  return ok ? 0 : 1;
}
