#include "glsl_call.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "context.h"
#include "gl/host.h"
#include "gl/source.h"

enum { WIDTH = 64, MAPS_UNIT = 0, RANGE_UNIT, INPUT_UNIT = PNI_UNITS };

static const char vertex_text[] =
    "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }\n";
static const char before[] = "uniform highp sampler2DArray pn_maps, pn_range; uniform sampler2D call_inputs; uniform "
                             "int call_vectors; uvec4 results[8];\n"
                             "layout(location = 0) out uvec4 out_0; layout(location = 1) out uvec4 out_1; "
                             "layout(location = 2) out uvec4 out_2;\n"
                             "layout(location = 3) out uvec4 out_3; layout(location = 4) out uvec4 out_4; "
                             "layout(location = 5) out uvec4 out_5;\n"
                             "layout(location = 6) out uvec4 out_6; layout(location = 7) out uvec4 out_7;\n"
                             "vec4 taken(int i) { return texelFetch(call_inputs, ivec2(int(gl_FragCoord.x) * "
                             "call_vectors + i, int(gl_FragCoord.y)), 0); }\n";
static const char after[] = "void main() {\n"
                            "  for (int i = 0; i < 8; i++) results[i] = uvec4(0u);\n"
                            "  call();\n"
                            "  out_0 = results[0]; out_1 = results[1]; out_2 = results[2]; out_3 = results[3];\n"
                            "  out_4 = results[4]; out_5 = results[5]; out_6 = results[6]; out_7 = results[7];\n"
                            "}\n";

static GLuint make_program(stage *s, const glsl_function *f) {
  char *library;
  assert_ok(pni_shader_text(&s->context->gpu, f->paths, f->defines, &library));
  size_t length = strlen(library) + sizeof before + strlen(f->text) + sizeof after;
  char *whole = malloc(length);
  snprintf(whole, length, "%s%s%s%s", library, before, f->text, after);
  pni_free(&s->context->gpu, library);
  GLuint program = gl_program(vertex_text, whole);
  free(whole);
  glUseProgram(program);
  glUniform1i(glGetUniformLocation(program, "pn_maps"), MAPS_UNIT);
  glUniform1i(glGetUniformLocation(program, "pn_range"), RANGE_UNIT);
  glUniform1i(glGetUniformLocation(program, "call_inputs"), INPUT_UNIT);
  return program;
}

static GLuint make_texture(GLenum format, int width, int height, GLenum layout, GLenum type, const void *values) {
  GLuint texture;
  glGenTextures(1, &texture);
  glActiveTexture(GL_TEXTURE0 + INPUT_UNIT);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, (GLint)format, width, height, 0, layout, type, values);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  return texture;
}

static void read_results(uint32_t *out, int count, int height) {
  uint32_t *image = malloc((size_t)WIDTH * (size_t)height * 16);
  for (int k = 0; k < CALL_RESULTS; k++) {
    glReadBuffer(GL_COLOR_ATTACHMENT0 + (GLenum)k);
    glReadPixels(0, 0, WIDTH, height, GL_RGBA_INTEGER, GL_UNSIGNED_INT, image);
    for (int i = 0; i < count; i++) memcpy(out + 32 * i + 4 * k, image + 4 * i, 16);
  }
  free(image);
}

uint32_t *glsl_call(stage *s, const glsl_function *function, const float *inputs, int vectors, int count) {
  int height = (count + WIDTH - 1) / WIDTH;
  size_t bytes = (size_t)vectors * 16;
  GLuint program = make_program(s, function), framebuffer, array, targets[CALL_RESULTS];
  GLenum points[CALL_RESULTS];
  for (int k = 0; k < CALL_RESULTS; k++) {
    targets[k] = make_texture(GL_RGBA32UI, WIDTH, height, GL_RGBA_INTEGER, GL_UNSIGNED_INT, NULL);
    points[k] = GL_COLOR_ATTACHMENT0 + (GLenum)k;
  }
  float *padded = calloc((size_t)WIDTH * (size_t)height, bytes);
  memcpy(padded, inputs, (size_t)count * bytes);
  GLuint source = make_texture(GL_RGBA32F, WIDTH * vectors, height, GL_RGBA, GL_FLOAT, padded);
  free(padded);
  glUniform1i(glGetUniformLocation(program, "call_vectors"), vectors);
  glGenVertexArrays(1, &array);
  glBindVertexArray(array);
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  for (int k = 0; k < CALL_RESULTS; k++)
    glFramebufferTexture2D(GL_FRAMEBUFFER, points[k], GL_TEXTURE_2D, targets[k], 0);
  glDrawBuffers(CALL_RESULTS, points);
  assert_int_equal(glCheckFramebufferStatus(GL_FRAMEBUFFER), GL_FRAMEBUFFER_COMPLETE);
  glViewport(0, 0, WIDTH, height);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  uint32_t *out = malloc((size_t)count * 32 * sizeof *out);
  read_results(out, count, height);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glDeleteFramebuffers(1, &framebuffer);
  glDeleteTextures(CALL_RESULTS, targets);
  glDeleteTextures(1, &source);
  glActiveTexture(GL_TEXTURE0);
  glBindVertexArray(0);
  glDeleteVertexArrays(1, &array);
  glUseProgram(0);
  glDeleteProgram(program);
  return out;
}
