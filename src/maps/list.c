#include "maps/list.h"

static bool same_range(const pni_range_kind *a, const pni_range_kind *b) {
  return a->structure == b->structure && a->quads == b->quads && a->least_there == b->least_there;
}

bool pni_want_same(const pni_maps_want *a, const pni_maps_want *b) {
  return a->near_layers == b->near_layers && a->farthest == b->farthest && a->near_faces == b->near_faces &&
         a->far_faces == b->far_faces && a->focus == b->focus && same_range(&a->range, &b->range) &&
         a->reach == b->reach && a->reach_width == b->reach_width && a->reach_turned == b->reach_turned &&
         a->receivers == b->receivers && a->variant == b->variant;
}
