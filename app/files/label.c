#define _GNU_SOURCE /* asprintf */
#include "files/label.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char *file_label(const char *text) {
  char *label = strdup(text);
  for (char *c = label; c && *c; c++)
    if (!strchr("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._=-", *c)) *c = '-';
  return label;
}

char *picture_name(const char *scene, const char *technique, const char *ending) {
  static const char prefix[] = "builtin:";
  if (strncmp(scene, prefix, sizeof prefix - 1) == 0) scene += sizeof prefix - 1;
  char *a = file_label(scene), *b = file_label(technique), *name = NULL;
  /* A file name that began with '-' or '.' would be taken for an option, or hidden. */
  if (a && (*a == '-' || *a == '.')) *a = '_';
  if (a && b && asprintf(&name, "%.180s-%.60s%s", a, b, ending) < 0) name = NULL;
  free(a);
  free(b);
  return name;
}
