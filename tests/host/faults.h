/* Faults on demand: the n-th allocation, or the n-th time that the driver makes, compiles or checks something. */
#ifndef HOST_FAULTS_H
#define HOST_FAULTS_H

#include <stddef.h>

typedef enum {
  FAULT_MEMORY = 0,  /* the allocator returns NULL */
  FAULT_GL_MEMORY,   /* an image or a buffer is GL_OUT_OF_MEMORY */
  FAULT_COMPILE,     /* a shader does not compile */
  FAULT_LINK,        /* a program does not link */
  FAULT_FRAMEBUFFER, /* a new texture cannot be drawn into */
  FAULT_KINDS
} fault_kind;

/* From now on the at-th of that kind fails, once. */
void faults_arm(fault_kind kind, long at);
/* Whether it came to that; enough: there were so many (a new texture need not be drawn into). */
int faults_disarm(int *enough);

/* pn_context_desc.allocate and .get_proc_address. */
void *faults_allocate(void *user, void *old, size_t bytes);
void *faults_address(void *user, const char *name);

#endif
