/* All GL state that a host of OpenGL 3.3 to 4.5 core may have, read as a list of named numbers, and set to unusual
 * values. */
#ifndef HOST_STATE_H
#define HOST_STATE_H

#include "gl.h"

typedef struct {
  char name[48];
  double value[4];
} state_entry;

enum { STATE_ENTRIES = 2048 };

typedef struct {
  int count;
  state_entry entries[STATE_ENTRIES];
} state_list;

void state_read(state_list *out);

/* The objects that the odd state binds. */
typedef struct {
  GLuint program, vertex_array, buffers[16], textures[11], samplers[2], framebuffers[2], colors[3], renderbuffer,
      queries[2];
  GLuint pipeline, feedback;
} odd_objects;

void odd_open(odd_objects *out);
void odd_close(odd_objects *self);

/* Everything unlike its default, with two queries running. */
void odd_set(const odd_objects *self);
/* Ends the queries and sets everything back to its default. */
void odd_unset(const odd_objects *self);

/* The part of it that came with indexed viewports, 4.1: glViewport and glScissor set all of them at once. */
void odd_set_viewports(void);
void odd_unset_viewports(void);

/* Prints every entry that differs, at most ten, and returns how many there are. allowed may be NULL, or a second state
 * whose value is fine too. Entries named in except (NULL-terminated, may be NULL) are left out. */
int state_differences(const char *when, const state_list *before, const state_list *after, const state_list *allowed,
                      const char *const *except);

#endif
