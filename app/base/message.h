/* message.h: how the program speaks on stderr: one line each, and the exit status that goes with it. */
#ifndef PENUMBRA_APP_BASE_MESSAGE_H
#define PENUMBRA_APP_BASE_MESSAGE_H

#if defined(__GNUC__)
#define MESSAGE_FORMAT(f, a) __attribute__((format(printf, f, a)))
#else
#define MESSAGE_FORMAT(f, a)
#endif

/* Exit statuses, and what functions that can fail return: whoever meets the problem has already said so. */
enum status {
  STATUS_OK = 0,
  STATUS_FAILED = 1, /* the work failed: no GL device, out of memory, I/O */
  STATUS_INPUT = 2,  /* the command line or an input file is wrong */
  STATUS_INTERRUPTED = 130
};

/* One line on stderr; control characters in it are replaced, because file names come from strangers. */
int input_error(const char *format, ...) MESSAGE_FORMAT(1, 2); /* returns STATUS_INPUT */
int work_error(const char *format, ...) MESSAGE_FORMAT(1, 2);  /* returns STATUS_FAILED */
int memory_error(void);                                        /* "out of memory"; returns STATUS_FAILED */
void warning(const char *format, ...) MESSAGE_FORMAT(1, 2);
void note(const char *format, ...) MESSAGE_FORMAT(1, 2); /* only with --verbose */

/* --verbose lets notes through; nothing silences errors and warnings. */
void message_set_verbose(int verbose);

#endif
