#include "base/progress.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"

static struct {
  int quiet, active;
  char what[64];
  double started, drawn;
} bar;
static volatile sig_atomic_t visible;

void progress_set_quiet(int quiet) { bar.quiet = quiet; }

void progress_begin(const char *what) {
  bar.active = !bar.quiet && isatty(STDERR_FILENO);
  snprintf(bar.what, sizeof bar.what, "%s", what);
  bar.started = clock_ms();
  bar.drawn = 0;
}

void progress_update(double fraction) {
  if (!bar.active) return;
  double now = clock_ms();
  if (now - bar.drawn < 100) return;
  bar.drawn = now;
  if (!(fraction > 0)) fraction = 0;
  if (fraction > 1) fraction = 1;
  enum { WIDTH = 30 };
  char cells[WIDTH + 1];
  int filled = (int)(fraction * WIDTH);
  memset(cells, '-', WIDTH);
  memset(cells, '#', (size_t)filled);
  cells[WIDTH] = 0;
  double elapsed = (now - bar.started) / 1000;
  visible = 1;
  fprintf(stderr, "\r\033[K%s [%s] %3.0f %%", bar.what, cells, fraction * 100);
  if (fraction > 0.02 && elapsed > 1) fprintf(stderr, "  %.0f s left", elapsed * (1 - fraction) / fraction);
  fflush(stderr);
}

void progress_hide(void) {
  if (!visible) return;
  fputs("\r\033[K", stderr);
  fflush(stderr);
  visible = 0;
  bar.drawn = 0;
}

void progress_end(void) {
  progress_hide();
  bar.active = 0;
}

int progress_visible(void) { return visible; }
