/* What one room keeps with another one's object, which knows nothing of it but how to free it: a technique with a
 * light or with a pair, the silhouettes with a mesh. */
#ifndef PNI_KEPT_H
#define PNI_KEPT_H

#include "gl/host.h"
#include "gl/texture.h"

typedef struct {
  size_t bytes; /* of the state, zeroed at first; 0: there is none */
  /* Frees what the state holds, not itself. NULL: it holds nothing. */
  void (*release)(pni_gpu *gpu, void *state, bool abandon);
  /* Images for looking at, by index from 0 until NULL. NULL: none. */
  const pni_texture *(*image)(const void *state, int index, const char **name);
} pni_kind;

typedef struct {
  const pni_kind *kind;
  void *state; /* NULL: none */
} pni_kept;

/* The state of that kind: kept, or made in place of one of another kind. *out NULL where the kind has none. */
pn_result pni_kept_get(pni_gpu *gpu, pni_kept *kept, const pni_kind *kind, void **out);
void pni_kept_free(pni_gpu *gpu, pni_kept *kept, bool abandon);
/* As pni_kind.image; NULL too where nothing is kept. */
const pni_texture *pni_kept_image(const pni_kept *kept, int index, const char **name);

#endif
