#define _GNU_SOURCE /* pipe2 */
#include "scene/import_process.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/auxv.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "scene/import_child.h"

/* What an import may take. A binary STL has 50 bytes a triangle and no format that people use has fewer than 16, so
 * the memory allows the 1 KB a triangle that importing is meant to stay under; the time is many times what the
 * slowest text format was seen to need. */
enum { IMPORT_SECONDS = 20, IMPORT_SECONDS_PER_16_MB = 20, IMPORT_MB = 1024, IMPORT_BYTES_PER_BYTE = 64 };

unsigned import_seconds(off_t size) {
  double seconds = IMPORT_SECONDS + (double)size / (16 << 20) * IMPORT_SECONDS_PER_16_MB;
  return seconds > 3600 ? 3600 : (unsigned)seconds;
}

/* ---- both sides: how the one calls the other --------------------------------------------------------------------- */

/* The arguments: argv[0], this word, the parent's process, size, up_is_z, path. Records leave through CHANNEL. */
static const char serve_word[] = "--serve-import";
enum { ARGUMENT_WORD = 1, ARGUMENT_PARENT, ARGUMENT_SIZE, ARGUMENT_UP, ARGUMENT_PATH, ARGUMENT_COUNT, CHANNEL = 3 };

/* ---- in the import's process ------------------------------------------------------------------------------------- */

static void limit(off_t size) {
  struct rlimit cpu = {import_seconds(size), import_seconds(size) + 1};
  setrlimit(RLIMIT_CPU, &cpu);
  struct rlimit core = {0, 0};
  setrlimit(RLIMIT_CORE, &core);
#if !defined(__SANITIZE_ADDRESS__) /* a sanitizer's shadow memory alone is beyond any limit */
  rlim_t bytes = ((rlim_t)IMPORT_MB << 20) + (rlim_t)size * IMPORT_BYTES_PER_BYTE;
  struct rlimit memory = {bytes, bytes};
  setrlimit(RLIMIT_DATA, &memory);
#endif
}

/* Drivers and whoever started the program may leave descriptors open over an exec: a hostile file gets none of them. */
static void close_inherited(void) {
#ifdef SYS_close_range
  if (syscall(SYS_close_range, CHANNEL + 1, ~0u, 0) == 0) return;
#endif
  enum { DESCRIPTORS_MAX = 65536 };
  long most = sysconf(_SC_OPEN_MAX);
  for (int fd = CHANNEL + 1; fd < most && fd < DESCRIPTORS_MAX; fd++) close(fd);
}

static int is_served(int argc, char **argv) {
  struct stat info;
  return argc == ARGUMENT_COUNT && strcmp(argv[ARGUMENT_WORD], serve_word) == 0 && fstat(CHANNEL, &info) == 0 &&
         S_ISFIFO(info.st_mode);
}

static void serve(char **argv) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != (pid_t)atol(argv[ARGUMENT_PARENT])) _exit(1); /* it died before the line above */
  signal(SIGINT, SIG_IGN);  /* the parent speaks for both; this process ends with it */
  signal(SIGPIPE, SIG_IGN); /* nobody reads any more: an error of the write call */
  close_inherited();
  limit((off_t)atoll(argv[ARGUMENT_SIZE]));
  import_child(argv[ARGUMENT_PATH], atoi(argv[ARGUMENT_UP]), CHANNEL);
  _exit(0);
}

/* ---- in the program ---------------------------------------------------------------------------------------------- */

/* The running executable; "": import_serve was not called, and exec would start the whole program over again. */
static char executable[PATH_MAX];

/* The link in /proc leads to the very file, even one that was replaced or removed since. Where there is no /proc: the
 * path that the kernel was given, made absolute before anybody changes the directory. */
static void find_executable(void) {
  static const char self[] = "/proc/self/exe";
  const char *path = (const char *)getauxval(AT_EXECFN);
  if (access(self, X_OK) == 0) memcpy(executable, self, sizeof self);
  else if (!path || !realpath(path, executable)) executable[0] = 0;
}

void import_serve(int argc, char **argv) {
  if (is_served(argc, argv)) serve(argv);
  find_executable();
}

/* Standard streams are closed to the importer: libraries that chat must not reach the pipe or the terminal. Signals
 * are as at a program's start, whatever this thread blocks or ignores. */
static int spawn(char **argv, int channel, pid_t *child) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  sigset_t none, usual;
  sigemptyset(&none);
  sigemptyset(&usual);
  sigaddset(&usual, SIGTERM);
  sigaddset(&usual, SIGHUP);
  sigaddset(&usual, SIGXCPU);
  int error = posix_spawn_file_actions_init(&files);
  if (error) return error;
  error = posix_spawnattr_init(&attributes);
  if (!error) {
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    error = posix_spawn_file_actions_adddup2(&files, channel, CHANNEL);
    for (int fd = 0; fd < CHANNEL && !error; fd++)
      error = posix_spawn_file_actions_addopen(&files, fd, "/dev/null", O_RDWR, 0);
    if (!error) error = posix_spawn(child, executable, &files, &attributes, argv, environ);
    posix_spawnattr_destroy(&attributes);
  }
  posix_spawn_file_actions_destroy(&files);
  return error;
}

/* Above CHANNEL, also where the program was started without standard streams: the child's own take those places. */
static int lift(int fd) {
  int lifted = fcntl(fd, F_DUPFD_CLOEXEC, CHANNEL + 1);
  close(fd);
  return lifted;
}

static int make_pipe(int ends[2]) {
  if (pipe2(ends, O_CLOEXEC) != 0) return -1;
  ends[0] = lift(ends[0]);
  ends[1] = lift(ends[1]);
  if (ends[0] >= 0 && ends[1] >= 0) return 0;
  for (int i = 0; i < 2; i++)
    if (ends[i] >= 0) close(ends[i]);
  errno = EMFILE;
  return -1;
}

int import_start(const char *path, int up_is_z, off_t size, pid_t *child) {
  int ends[2];
  if (!executable[0]) {
    errno = ENOENT;
    return -1;
  }
  if (make_pipe(ends) != 0) return -1;
  char parent[24], bytes[24];
  snprintf(parent, sizeof parent, "%ld", (long)getpid());
  snprintf(bytes, sizeof bytes, "%lld", (long long)size);
  char *argv[] = {
      (char *)"penumbra", (char *)serve_word, parent, bytes, up_is_z ? (char *)"1" : (char *)"0", (char *)path, NULL};
  int error = spawn(argv, ends[1], child);
  close(ends[1]);
  if (!error) return ends[0];
  close(ends[0]);
  errno = error;
  return -1;
}
