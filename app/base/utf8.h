/* utf8.h: names of files may be any bytes; JSON and pages may not. */
#ifndef PENUMBRA_APP_BASE_UTF8_H
#define PENUMBRA_APP_BASE_UTF8_H

/* Every byte that is no part of UTF-8 becomes "?". In place. */
void utf8_mend(char *text);

#endif
