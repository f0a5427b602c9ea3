#include "kept.h"

#include <string.h>

pn_result pni_kept_get(pni_gpu *gpu, pni_kept *kept, const pni_kind *kind, void **out) {
  *out = NULL;
  if (kept->kind != kind) pni_kept_free(gpu, kept, false);
  kept->kind = kind;
  if (!kept->state && kind->bytes) {
    kept->state = pni_allocate_zero(gpu, kind->bytes);
    if (!kept->state) return PN_ERROR_OUT_OF_MEMORY;
  }
  *out = kept->state;
  return PN_OK;
}

void pni_kept_free(pni_gpu *gpu, pni_kept *kept, bool abandon) {
  if (kept->state && kept->kind->release) kept->kind->release(gpu, kept->state, abandon);
  pni_free(gpu, kept->state);
  memset(kept, 0, sizeof *kept);
}

const pni_texture *pni_kept_image(const pni_kept *kept, int index, const char **name) {
  return kept->state && kept->kind->image ? kept->kind->image(kept->state, index, name) : NULL;
}
