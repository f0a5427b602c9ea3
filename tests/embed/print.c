/* Prints the embedded file argv[1], or without arguments the names of all. */
#include "gl/embedded.h"
#include <stdio.h>
#include <string.h>

int main(int argc, char **argv) {
  int found = argc < 2;
  for (int i = 0; i < pni_embedded_shader_count; i++) {
    const pni_embedded_shader *shader = &pni_embedded_shaders[i];
    if (argc < 2) puts(shader->path);
    if (argc >= 2 && strcmp(shader->path, argv[1]) == 0) {
      fputs(shader->text, stdout);
      found = 1;
    }
  }
  return found && !pni_embedded_shaders[pni_embedded_shader_count].path ? 0 : 1;
}
