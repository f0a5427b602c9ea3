/* names.h: what somebody probably meant. */
#ifndef PENUMBRA_APP_BASE_NAMES_H
#define PENUMBRA_APP_BASE_NAMES_H

#include <stddef.h>

/* Writes "did you mean X?" into hint and returns 1 when one of the names is close to what was typed; otherwise 0. */
int nearest_name(const char *typed, const char *const *names, int count, char *hint, size_t hint_size);

#endif
