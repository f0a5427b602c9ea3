/* A GL context without a window. */
#ifndef HOST_HEADLESS_H
#define HOST_HEADLESS_H

typedef struct {
  void *display, *context;
} headless;

/* OpenGL core of at least 3.3 with debug messages, current on this thread, and the table in gl.h filled. 1, or 0 with a
 * line on stderr. */
int headless_open(headless *out);
/* The same with a compatibility profile. */
int headless_open_compatible(headless *out);

/* An OpenGL ES 3.0 context on the same display, made current; 0 when there is none. */
int headless_open_es(const headless *main, headless *out);

void headless_current(const headless *self);
void headless_close(headless *self);
void headless_close_es(headless *self);

#endif
