#include "gl/label.h"

#include <stdio.h>

enum { LENGTH = 160 }; /* less than any device's limit of 256 */

/* One line; returns its length. */
static GLsizei write_name(char out[LENGTH], const char *name) {
  int length = snprintf(out, LENGTH, "penumbra %s", name);
  for (char *c = out; *c; c++)
    if (*c == '\n') *c = ' ';
  return length < LENGTH ? length : LENGTH - 1;
}

void pni_label(pni_gpu *gpu, GLenum kind, pn_gl object, const char *name) {
  char text[LENGTH];
  if (!gpu->can.labels || !object) return;
  GLsizei length = write_name(text, name);
  GL(gpu, ObjectLabel)(kind, object, length, text);
}

void pni_find_group_room(pni_gpu *gpu) {
  GLint depth = 0;
  if (!gpu->can.labels) return;
  GL(gpu, GetIntegerv)(GL_DEBUG_GROUP_STACK_DEPTH, &depth);
  gpu->group_room = depth < gpu->can.debug_groups;
}

void pni_group(pni_gpu *gpu, const char *name) {
  if (!gpu->can.labels) return;
  if (gpu->bound.group) GL(gpu, PopDebugGroup)();
  gpu->bound.group = name && gpu->group_room;
  if (!gpu->bound.group) return;
  char text[LENGTH];
  GLsizei length = write_name(text, name);
  GL(gpu, PushDebugGroup)(GL_DEBUG_SOURCE_THIRD_PARTY, 0, length, text);
}
