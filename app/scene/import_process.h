/* import_process.h: the import's own process.
 *
 * It is the running executable once more, started by exec in a hidden mode that import_serve recognises: a fork alone
 * would carry over locks that other threads hold, a GL driver's among them, and so would have to come before all
 * threads and GL. The same executable is always there, wherever the program was moved or installed, is never of
 * another version, and needs no helper to be found; tests that import are their own importer in the same way. */
#ifndef PENUMBRA_APP_SCENE_IMPORT_PROCESS_H
#define PENUMBRA_APP_SCENE_IMPORT_PROCESS_H

#include <sys/types.h>

/* First of all in main, before there is a thread: in an import's process it imports and does not return. Elsewhere it
 * remembers how to start one; without it, every import fails. */
void import_serve(int argc, char **argv);

/* Starts the import of a file of this many bytes, by which its time and memory are limited; its records come out of the
 * returned descriptor. -1 and errno: no process or pipe. The process dies with the thread that starts it. */
int import_start(const char *path, int up_is_z, off_t size, pid_t *child);

/* The CPU time that it may take. */
unsigned import_seconds(off_t size);

#endif
