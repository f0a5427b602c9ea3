#include "host/shader_cache.h"

#include <errno.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "base/message.h"

static const double least_bytes = 32 << 20;

/* Whether the folder, or what there is of it, can take a few megabytes more. */
static int has_room(const char *folder) {
  char path[4096];
  if (snprintf(path, sizeof path, "%s", folder) >= (int)sizeof path) return 0;
  struct statvfs info;
  while (statvfs(path, &info) != 0) {
    char *slash = strrchr(path, '/');
    if (errno != ENOENT || !slash) return 0;
    slash[slash == path] = 0; /* "/" itself stays */
  }
  return access(path, W_OK | X_OK) == 0 && (double)info.f_bavail * (double)info.f_frsize >= least_bytes;
}

static int home_has_room(const char *home) {
  char path[4096];
  return snprintf(path, sizeof path, "%s/.cache", home) < (int)sizeof path && has_room(path);
}

/* The driver's own order; in a home it asks the password file where this program asks HOME, so both must do. */
static int cache_has_room(void) {
  static const char *const names[] = {"MESA_SHADER_CACHE_DIR", "MESA_GLSL_CACHE_DIR", "XDG_CACHE_HOME"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    const char *folder = getenv(names[i]);
    if (folder && *folder) return has_room(folder);
  }
  const char *home = getenv("HOME");
  const struct passwd *user = getpwuid(getuid());
  if (home && *home && !home_has_room(home)) return 0;
  return !user || !user->pw_dir || home_has_room(user->pw_dir);
}

void shader_cache_guard(void) {
  const char *base = getenv("XDG_CACHE_HOME");
  if (base && *base != '/') unsetenv("XDG_CACHE_HOME");
  if (cache_has_room()) return;
  note("the driver's shader cache is off: its folder has no room or cannot be written");
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
  setenv("MESA_GLSL_CACHE_DISABLE", "true", 1); /* its older name */
}
