#include "files/json.h"

#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "files/output.h"

int json_write(const char *path, cJSON *object) {
  char *text = object ? cJSON_Print(object) : NULL;
  cJSON_Delete(object);
  if (!text) return memory_error();
  size_t length = strlen(text);
  text[length] = '\n'; /* in the terminator's place: the size says where the file ends */
  int status = output_write_file(path, text, length + 1);
  free(text);
  return status;
}
