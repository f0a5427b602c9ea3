/* cache.h: visibility that was traced before, on disk, because people compare the same view again and again.
 *
 * Files lie in $XDG_CACHE_HOME/penumbra/reference (~/.cache where that is unset or not absolute), one for each
 * result, named by a hash of everything the result depends on. They are written under another name and renamed; a
 * checksum guards them; the longest unused ones go when all together exceed CACHE_BYTES_MAX. Whatever goes wrong here
 * costs time, never a result: the caller is told by a text. */
#ifndef PENUMBRA_APP_REFERENCE_CACHE_H
#define PENUMBRA_APP_REFERENCE_CACHE_H

#include "reference/hash.h"
#include "reference/reference.h"

#define CACHE_BYTES_MAX (512ull << 20)

/* Of everything that reference_trace's result depends on; threads and progress are not part of that. */
struct digest cache_key(const struct reference_casters *casters, const struct reference_light *light,
                        const struct reference_points *points, int samples);

/* Nonzero: visibility holds count values as they were stored, and *result what tracing them took. why: empty when
 * there is simply no such file, else one line about a cache that cannot be used. */
int cache_load(const struct digest *key, size_t count, float *visibility, struct reference_result *result, char *why,
               size_t why_size);

/* Nonzero: stored. why as above. */
int cache_store(const struct digest *key, size_t count, const float *visibility, const struct reference_result *result,
                char *why, size_t why_size);

/* The cache's directory, not necessarily there; returns 0 when neither XDG_CACHE_HOME nor HOME names one. */
int cache_directory(char *path, size_t size);

/* Removes the longest unused files of a directory until what is left is at most so many bytes. */
void cache_trim(const char *directory, unsigned long long bytes_max);

#endif
