#include "files/json.h"

#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "base/utf8.h"
#include "files/output.h"

/* Names in it may come from files. */
static void mend_strings(cJSON *item) {
  for (; item; item = item->next) {
    if (item->valuestring) utf8_mend(item->valuestring);
    mend_strings(item->child);
  }
}

int json_write(const char *path, cJSON *object) {
  mend_strings(object);
  char *text = object ? cJSON_Print(object) : NULL;
  cJSON_Delete(object);
  if (!text) return memory_error();
  size_t length = strlen(text);
  text[length] = '\n'; /* in the terminator's place: the size says where the file ends */
  int status = output_write_file(path, text, length + 1);
  free(text);
  return status;
}
