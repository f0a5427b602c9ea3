#include "base/interrupt.h"

#include <signal.h>
#include <stddef.h>
#include <unistd.h>

#include "base/message.h"
#include "base/progress.h"

/* The handler ends the process itself: GL calls and model imports can run for many seconds without returning to a
 * loop that could look at a flag. It uses async-signal-safe calls only. An import's process ends with this one. */
enum { FILES_MAX = 16 };
static const char *volatile files[FILES_MAX];
static const char *volatile folder;

static void stop(int signal_number) {
  for (int i = 0; i < FILES_MAX; i++)
    if (files[i]) unlink(files[i]);
  if (folder) rmdir(folder); /* fails where something is in it */
  if (progress_visible()) {
    static const char wipe[] = "\r\033[K";
    ssize_t ignored = write(STDERR_FILENO, wipe, sizeof wipe - 1);
    (void)ignored;
  }
  _exit(signal_number == SIGINT ? STATUS_INTERRUPTED : 128 + signal_number);
}

void interrupt_install(void) {
  struct sigaction action = {0};
  action.sa_handler = stop;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  sigaction(SIGHUP, &action, NULL);
  /* A full pipe or a file size limit is an error of the write call, reported as one line; not a silent death. */
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);
}

void interrupt_watch_file(const char *path) {
  for (int i = 0; i < FILES_MAX; i++)
    if (!files[i]) {
      files[i] = path;
      return;
    }
}

void interrupt_forget_file(const char *path) {
  for (int i = 0; i < FILES_MAX; i++)
    if (files[i] == path) files[i] = NULL;
}

void interrupt_watch_folder(const char *path) { folder = path; }
