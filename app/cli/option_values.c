#include "cli/option_values.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/message.h"
#include "scene/scene.h"

/* One number in plain decimal notation; strtod alone would also take "nan", "inf" and hexadecimal. NULL: there is
 * none. */
static const char *read_number(const char *text, double *out) {
  if (!*text || text[strspn(text, "+-.0123456789eE")] == 'x' || !strchr("+-.0123456789", *text)) return NULL;
  char *end;
  *out = strtod(text, &end);
  return end == text || !isfinite(*out) || isalpha((unsigned char)end[-1]) ? NULL : end;
}

int read_numbers(const char *name, const char *text, int count, const char *shape, double *out) {
  const char *at = text;
  for (int i = 0; i < count; i++) {
    at = read_number(at, &out[i]);
    if (!at || *at != (i + 1 < count ? ',' : 0)) {
      if (count == 1) return input_error("%s: '%s' is not a finite number", name, text);
      return input_error("%s: '%s' is not %s in finite numbers", name, text, shape);
    }
    if (fabs(out[i]) > COORDINATE_MAX) return input_error("%s: '%s' is beyond %g", name, text, COORDINATE_MAX);
    at++;
  }
  return STATUS_OK;
}

int read_integer(const char *name, const char *text, int least, int most, int *out) {
  char *end;
  long value = strtol(text, &end, 10);
  if (end == text || *end || isspace((unsigned char)*text) || value < least || value > most)
    return input_error("%s: '%s' is not a whole number from %d to %d", name, text, least, most);
  *out = (int)value;
  return STATUS_OK;
}

int read_size(const char *name, const char *text, int least, int most, int square, int out[2]) {
  char *end = NULL, *end2 = NULL;
  long a = 0, b = 0;
  if (isdigit((unsigned char)*text)) a = b = strtol(text, &end, 10);
  int ok = end && ((square && !*end) || *end == 'x');
  if (ok && *end == 'x') {
    ok = isdigit((unsigned char)end[1]);
    if (ok) b = strtol(end + 1, &end2, 10);
    ok = ok && !*end2;
  }
  const char *shape = square ? "N or NxM" : "WxH";
  if (!ok)
    return input_error("%s: '%s' is not %s, such as %s", name, text, shape, square ? "512 or 512x256" : "1024x768");
  if (a < least || a > most || b < least || b > most)
    return input_error("%s: '%s' is out of range: each must be from %d to %d", name, text, least, most);
  out[0] = (int)a;
  out[1] = (int)b;
  return STATUS_OK;
}

int read_choice(const char *name, const char *text, const char *const *choices, int *out) {
  char list[160] = "";
  for (int i = 0; choices[i]; i++) {
    if (strcmp(text, choices[i]) == 0) {
      *out = i;
      return STATUS_OK;
    }
    size_t length = strlen(list);
    snprintf(list + length, sizeof list - length, "%s%s", !i ? "" : choices[i + 1] ? ", " : " or ", choices[i]);
  }
  return input_error("%s: '%s' is not %s", name, text, list);
}
