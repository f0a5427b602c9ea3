/* hash.h: SipHash-2-4 with 128 bits of result (Aumasson and Bernstein 2012) under a fixed key: one pass over what is
 * written piece by piece. */
#ifndef PENUMBRA_APP_REFERENCE_HASH_H
#define PENUMBRA_APP_REFERENCE_HASH_H

#include <stddef.h>
#include <stdint.h>

struct hash {
  uint64_t v[4];
  uint64_t length;
  uint8_t rest[8]; /* length % 8 bytes not yet in v */
};

struct digest {
  uint8_t bytes[16];
};

void hash_begin(struct hash *hash);
void hash_bytes(struct hash *hash, const void *bytes, size_t count);
struct digest hash_end(struct hash *hash);

/* count before bytes, so that neighbouring arrays cannot be taken for others with the border elsewhere. */
void hash_array(struct hash *hash, const void *items, size_t count, size_t item_size);

#endif
