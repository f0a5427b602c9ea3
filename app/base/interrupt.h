/* interrupt.h: Ctrl-C ends the program at once, wherever it is, with status 130 and no temporary file left behind. */
#ifndef PENUMBRA_APP_BASE_INTERRUPT_H
#define PENUMBRA_APP_BASE_INTERRUPT_H

void interrupt_install(void);

/* A file to remove when interrupted. The path must stay valid until it is forgotten. Not for use by several threads. */
void interrupt_watch_file(const char *path);
void interrupt_forget_file(const char *path);

/* A folder to remove when interrupted, if nothing is in it by then; NULL: none. */
void interrupt_watch_folder(const char *path);

#endif
