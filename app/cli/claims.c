#define _GNU_SOURCE /* asprintf */
#include "cli/claims.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/message.h"
#include "files/output.h"

/* A file that exists is known by its device and number, so that links are seen through; another by where it will be. */
struct claim {
  char *what, *target;
  int exists;
  dev_t device;
  ino_t number;
};

static int is_same(const struct claim *a, const struct claim *b) {
  if (a->exists && b->exists) return a->device == b->device && a->number == b->number;
  return !a->exists && !b->exists && strcmp(a->target, b->target) == 0;
}

static int add(struct claims *claims, const char *what, const char *path, int writes) {
  struct stat info;
  int exists = stat(path, &info) == 0;
  if (exists && !S_ISREG(info.st_mode)) return STATUS_OK;
  struct claim *items = realloc(claims->items, ((size_t)claims->count + 1) * sizeof *items);
  if (!items) return memory_error();
  claims->items = items;
  struct claim *claim = &items[claims->count];
  *claim = (struct claim){.what = strdup(what), .target = output_target(path), .exists = exists};
  if (exists) {
    claim->device = info.st_dev;
    claim->number = info.st_ino;
  }
  claims->count++;
  if (!claim->what || (!claim->target && errno == ENOMEM)) return memory_error();
  if (!claim->target) return input_error("%s: %s: %s", what, path, strerror(errno));
  for (int i = 0; writes && i < claims->count - 1; i++)
    if (is_same(&items[i], claim)) return input_error("%s would overwrite %s: both are %s", what, items[i].what, path);
  return STATUS_OK;
}

int claim_read(struct claims *claims, const char *what, const char *path) {
  return !path || strncmp(path, "builtin:", 8) == 0 ? STATUS_OK : add(claims, what, path, 0);
}

int claim_write(struct claims *claims, const char *what, const char *path) {
  return !path || output_is_standard(path) ? STATUS_OK : add(claims, what, path, 1);
}

int claim_saved(struct claims *claims, const char *folder, const char *name) {
  char *path = NULL;
  if (asprintf(&path, "%s/%s", folder, name) < 0) return memory_error();
  int status = claim_write(claims, "a buffer of --save-dir", path);
  free(path);
  return status;
}

int claim_options(struct claims *claims, const struct options *o) {
  if (output_is_standard(o->json) && output_is_standard(o->html))
    return input_error("--json and --html cannot both be standard output");
  int status = o->positional_count ? claim_read(claims, "the model", o->positionals[0]) : STATUS_OK;
  if (!status) status = claim_read(claims, "the file of --setup", o->setup_file);
  if (!status) status = claim_write(claims, "--output", o->output);
  if (!status) status = claim_write(claims, "--html", o->html);
  if (!status) status = claim_write(claims, "--json", o->json);
  static const char *const buffers[] = {"position.exr", "normal.exr", "mask.exr"};
  for (size_t i = 0; i < sizeof buffers / sizeof *buffers && o->save_dir && !status; i++)
    status = claim_saved(claims, o->save_dir, buffers[i]);
  return status;
}

void claims_free(struct claims *claims) {
  for (int i = 0; i < claims->count; i++) {
    free(claims->items[i].what);
    free(claims->items[i].target);
  }
  free(claims->items);
  *claims = (struct claims){NULL, 0};
}
