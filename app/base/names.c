#include "base/names.h"

#include <stdio.h>
#include <string.h>

enum { NAME_MAX_LENGTH = 63 };

/* Levenshtein distance, with a swap of neighbours counted as one; names of up to NAME_MAX_LENGTH characters. */
static int distance(const char *a, const char *b) {
  int n = (int)strlen(a), m = (int)strlen(b);
  if (n > NAME_MAX_LENGTH || m > NAME_MAX_LENGTH) return NAME_MAX_LENGTH;
  int rows[3][NAME_MAX_LENGTH + 2];
  for (int j = 0; j <= m; j++) rows[0][j] = j;
  for (int i = 1; i <= n; i++) {
    int *row = rows[i % 3], *above = rows[(i + 2) % 3], *above2 = rows[(i + 1) % 3];
    row[0] = i;
    for (int j = 1; j <= m; j++) {
      int best = above[j - 1] + (a[i - 1] != b[j - 1]);
      if (above[j] + 1 < best) best = above[j] + 1;
      if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && above2[j - 2] + 1 < best)
        best = above2[j - 2] + 1;
      row[j] = best;
    }
  }
  return rows[n % 3][m];
}

int nearest_name(const char *typed, const char *const *names, int count, char *hint, size_t hint_size) {
  int best = -1, best_distance = 0;
  for (int i = 0; i < count; i++) {
    int d = distance(typed, names[i]);
    /* A beginning of the name is close, however much is missing. */
    if (*typed && strncmp(typed, names[i], strlen(typed)) == 0) d = 1;
    if (best < 0 || d < best_distance) {
      best = i;
      best_distance = d;
    }
  }
  if (best < 0 || best_distance > 2 + (int)strlen(names[best]) / 6) return 0;
  snprintf(hint, hint_size, "did you mean %s?", names[best]);
  return 1;
}
