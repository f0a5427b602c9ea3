#include "reference/hash.h"

#include <string.h>

static inline uint64_t rotate(uint64_t x, int bits) { return x << bits | x >> (64 - bits); }

static inline void rounds(uint64_t v[4], int count) {
  for (int i = 0; i < count; i++) {
    v[0] += v[1];
    v[2] += v[3];
    v[1] = rotate(v[1], 13) ^ v[0];
    v[3] = rotate(v[3], 16) ^ v[2];
    v[0] = rotate(v[0], 32);
    v[2] += v[1];
    v[0] += v[3];
    v[1] = rotate(v[1], 17) ^ v[2];
    v[3] = rotate(v[3], 21) ^ v[0];
    v[2] = rotate(v[2], 32);
  }
}

static inline uint64_t little_endian(const uint8_t *bytes) {
  uint64_t word = 0;
  for (int i = 0; i < 8; i++) word |= (uint64_t)bytes[i] << (8 * i);
  return word;
}

static inline void absorb(uint64_t v[4], uint64_t word) {
  v[3] ^= word;
  rounds(v, 2);
  v[0] ^= word;
}

/* The key is the one of the published test vectors: bytes 0 to 15. It guards against accidents, not against
 * attackers. */
void hash_begin(struct hash *hash) {
  const uint64_t key[2] = {0x0706050403020100u, 0x0f0e0d0c0b0a0908u};
  memset(hash, 0, sizeof *hash);
  hash->v[0] = key[0] ^ 0x736f6d6570736575u;
  hash->v[1] = key[1] ^ 0x646f72616e646f6du ^ 0xee;
  hash->v[2] = key[0] ^ 0x6c7967656e657261u;
  hash->v[3] = key[1] ^ 0x7465646279746573u;
}

void hash_bytes(struct hash *hash, const void *bytes, size_t count) {
  const uint8_t *next = bytes;
  size_t held = hash->length % 8;
  hash->length += count;
  if (held) {
    size_t taken = count < 8 - held ? count : 8 - held;
    memcpy(hash->rest + held, next, taken);
    next += taken;
    count -= taken;
    if (held + taken < 8) return;
    absorb(hash->v, little_endian(hash->rest));
  }
  for (; count >= 8; count -= 8, next += 8) absorb(hash->v, little_endian(next));
  if (count) memcpy(hash->rest, next, count);
}

struct digest hash_end(struct hash *hash) {
  size_t held = hash->length % 8;
  memset(hash->rest + held, 0, 8 - held);
  absorb(hash->v, little_endian(hash->rest) | hash->length << 56);
  struct digest digest;
  hash->v[2] ^= 0xee;
  for (int half = 0; half < 2; half++) {
    rounds(hash->v, 4);
    uint64_t word = hash->v[0] ^ hash->v[1] ^ hash->v[2] ^ hash->v[3];
    for (int i = 0; i < 8; i++) digest.bytes[8 * half + i] = (uint8_t)(word >> (8 * i));
    hash->v[1] ^= 0xdd;
  }
  return digest;
}

void hash_array(struct hash *hash, const void *items, size_t count, size_t item_size) {
  uint64_t header[2] = {count, item_size};
  hash_bytes(hash, header, sizeof header);
  if (items && count) hash_bytes(hash, items, count * item_size);
}
