/* claims.h: which files one run reads and writes, so that no output destroys an input or another output. */
#ifndef PENUMBRA_APP_CLI_CLAIMS_H
#define PENUMBRA_APP_CLI_CLAIMS_H

#include "cli/options.h"

struct claim;
struct claims {
  struct claim *items;
  int count;
};

/* A file that is read: what names it in messages, such as "--setup". NULL and built-in scenes are no files. */
int claim_read(struct claims *claims, const char *what, const char *path);

/* A file that will be written. Where it is one that was claimed before, under whatever name, one line is printed and
 * STATUS_INPUT returned. NULL, standard output and devices can be claimed any number of times. */
int claim_write(struct claims *claims, const char *what, const char *path);

/* The same for a file in the folder of --save-dir, which need not exist yet. */
int claim_saved(struct claims *claims, const char *folder, const char *name);

/* The model, the set-up, and the outputs that options name. */
int claim_options(struct claims *claims, const struct options *options);

void claims_free(struct claims *claims);

#endif
