/* A GL context without a window, for tests, with every GL error noticed. */
#ifndef TEST_GL_CONTEXT_H
#define TEST_GL_CONTEXT_H

/* clang-format off: cmocka.h needs these four before it */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
/* clang-format on */

#include <epoxy/gl.h>

/* Makes an OpenGL 3.3 core context current, with debug output connected. 0: there is none. */
int gl_open(void);
void gl_close(void);
/* Fails the running test when GL raised an error or reported undefined behaviour since the last call. */
void gl_assert_clean(void);

/* Runs the tests with a context, each one followed by gl_assert_clean. Answers main's exit status: 77 without GL. */
int gl_run(const char *name, const struct CMUnitTest *tests, size_t count);
#define GL_RUN(name, tests) gl_run(name, tests, sizeof(tests) / sizeof *(tests))

/* How often a random test goes round: a quarter of count in the sanitizer build, where everything takes its time. */
#ifdef __SANITIZE_ADDRESS__
#define TEST_ROUNDS(count) ((count) / 4)
#else
#define TEST_ROUNDS(count) (count)
#endif

/* A program from the text of its two stages, #version 330 core put before each. */
GLuint gl_program(const char *vertex, const char *fragment);
/* Level 0 of a texture, or of one layer of an array: channels floats a texel, freed by the caller. */
float *gl_read_texture(GLuint texture, int level, int layer, int width, int height, int channels);
float *gl_read_depth(GLuint texture, int layer, int width, int height);

#endif
