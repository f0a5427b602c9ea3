#include "scene/import_peek.h"

#include <stdio.h>
#include <string.h>

#include "scene/import_files.h"

static int begins(const char *line, const char *word) { return strncmp(line, word, strlen(word)) == 0; }

/* The header's lines; of strips Assimp reads the first triangle. */
static void peek_ply(const struct importer *importer, char *text) {
  for (char *line = strtok(text, "\r\n"); line && !begins(line, "end_header"); line = strtok(NULL, "\r\n")) {
    char name[40];
    unsigned long long count;
    if (sscanf(line, "element %39s %llu", name, &count) != 2 || count == 0 || !strstr(name, "strip")) continue;
    refuse(importer, "holds triangle strips (element %s), which are not read; save it with faces", name);
  }
}

void peek(const struct importer *importer) {
  static char head[1 << 16];
  read_head(importer, importer->path, head, sizeof head - 1);
  char *text = begins(head, "\xef\xbb\xbf") ? head + 3 : head;
  if (begins(text, "ply\n") || begins(text, "ply\r")) peek_ply(importer, text);
}
