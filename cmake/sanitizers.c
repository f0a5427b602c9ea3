/* Linked into every executable of the sanitizer build: what the sanitizers' run-time libraries ask a program at its
 * start. */

const char *__ubsan_default_options(void);
const char *__lsan_default_options(void);
const char *__lsan_default_suppressions(void);
int dlclose(void *handle);

const char *__ubsan_default_options(void) { return "print_stacktrace=1"; }

const char *__lsan_default_options(void) { return "print_suppressions=0"; }

/* Leaks of OpenGL drivers and of what lies around them, and caches that live as long as the process; no caller can free
 * them. */
const char *__lsan_default_suppressions(void) {
  return "leak:libEGL\n"
         "leak:libGL\n"
         "leak:libgallium\n"
         "leak:_dri.so\n"
         "leak:libLLVM\n"
         "leak:libgbm\n"
         "leak:libnvidia\n"
         "leak:libX11\n"
         "leak:libxcb\n"
         "leak:libfontconfig\n";
}

/* A driver that was closed before the search for leaks has no name by which it could be excused: it stays open. */
__attribute__((visibility("default"))) int dlclose(void *handle) {
  (void)handle;
  return 0;
}
