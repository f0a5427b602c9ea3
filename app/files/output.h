/* output.h: files that appear whole or not at all: written under a temporary name beside the target, then renamed. */
#ifndef PENUMBRA_APP_FILES_OUTPUT_H
#define PENUMBRA_APP_FILES_OUTPUT_H

#include <stdio.h>

struct output {
  FILE *file;
  char *path;      /* as given, for messages */
  char *target;    /* with symbolic links followed */
  char *temporary; /* NULL: a device or pipe, written directly */
};

/* Where path leads with its folder's name made absolute and symbolic links followed, whether or not the file, or the
 * folder, exists yet; malloc'ed. NULL: out of memory, or links without end. */
char *output_target(const char *path);

/* Whether path, which may be NULL, is "-": standard output. */
int output_is_standard(const char *path);

/* Opens path for writing. "-" is standard output. On failure one line was printed and the exit status is returned. */
int output_open(struct output *output, const char *path);

/* Flushes to the disk and gives the file its name. On failure nothing is left and one line was printed. */
int output_commit(struct output *output);

/* Takes everything back; prints nothing. */
void output_abort(struct output *output);

/* Takes everything back and says why, from errno where reason is NULL. Returns STATUS_FAILED. */
int output_fail(struct output *output, const char *reason);

/* A whole file from memory. */
int output_write_file(const char *path, const void *bytes, size_t size);

/* Whether path could be written, before long work starts: its folder exists and is writable, and it is no folder
 * itself. */
int output_check(const char *path);

#endif
