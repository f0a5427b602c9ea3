#include "base/utf8.h"

#include <stdint.h>

/* How many bytes the character takes that begins here; 0: it is none. Overlong forms, surrogates and what lies beyond
 * U+10FFFF are none. The zero that ends the text continues nothing. */
static int character_size(const unsigned char *p) {
  if (p[0] < 0x80) return 1;
  int size = p[0] >= 0xf0 ? 4 : p[0] >= 0xe0 ? 3 : 2;
  if (p[0] < 0xc2 || p[0] > 0xf4) return 0;
  uint32_t code = p[0] & (0x7fu >> size);
  for (int i = 1; i < size; i++) {
    if ((p[i] & 0xc0) != 0x80) return 0;
    code = code << 6 | (p[i] & 0x3fu);
  }
  static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  return code < least[size] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000) ? 0 : size;
}

void utf8_mend(char *text) {
  while (*text) {
    int size = character_size((const unsigned char *)text);
    if (!size) *text = '?';
    text += size ? size : 1;
  }
}
