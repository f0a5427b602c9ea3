/* A loader that counts: each function it hands out notes its call and jumps on to the real one. */
#ifndef HOST_COUNTED_H
#define HOST_COUNTED_H

/* 0 where this machine cannot make such functions. */
int counted_available(void);

/* pn_context_desc.get_proc_address. */
void *counted_address(void *user, const char *name);

/* Calls since the last reset of all functions whose names begin with the prefix; "" is all of them. */
long counted_calls(const char *prefix);
void counted_reset(void);

#endif
