/* progress.h: one progress bar on stderr with the remaining time; only on a terminal, and not with --quiet. */
#ifndef PENUMBRA_APP_BASE_PROGRESS_H
#define PENUMBRA_APP_BASE_PROGRESS_H

void progress_set_quiet(int quiet);

/* what: a few words, copied. fraction: 0..1. Redrawn at most ten times a second. */
void progress_begin(const char *what);
void progress_update(double fraction);
void progress_end(void);

/* Wipes the bar's line before something else is printed; the next update draws it again. */
void progress_hide(void);

/* Nonzero while a bar stands on the terminal: for the interrupt handler, which wipes it itself. */
int progress_visible(void);

#endif
