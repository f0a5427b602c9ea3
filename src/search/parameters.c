#include "search/parameters.h"

#include <stdio.h>

const char *const pn_hierarchy_names[] = {"mssm", "hsm", "none", NULL};

/* Covering quads exactly takes loops of its own, and software GL ends a shader's loops after 65535 turns in all: a
 * scan of every texel would not fit, a descent that merges nothing does. */
static bool descends(const pn_search_values *v) { return v->merge > 0 || v->primitive == PN_PRIMITIVE_QUAD_EXACT; }

pn_range_kind pn_search_range(const pn_search_values *v) {
  bool descent = descends(v), stack = v->hierarchy == PN_HIERARCHY_MSSM && !descent;
  return (pn_range_kind){stack ? PN_RANGE_STACK : PN_RANGE_PYRAMID, v->primitive != PN_PRIMITIVE_PATCH, descent};
}

float pn_search_focus(double percent) { return percent < 100 ? (float)(0.01 * percent) : 0; }

int pn_search_defines(const pn_search_values *v, char *out, size_t size) {
  bool descent = descends(v);
  int refine = v->hierarchy == PN_HIERARCHY_NONE ? 0 : v->hierarchy == PN_HIERARCHY_MSSM && !descent ? 2 : 1;
  return snprintf(out, size,
                  "PN_PRIMITIVE %d\nPN_GAPS %d\nPN_EDGES %d\nPN_DESCENT %d\nPN_REFINE %d\nPN_MERGE %d\nPN_CAP %d\n",
                  (int)v->primitive, v->gaps, v->edges, descent, refine, v->merge_index, v->cap_index);
}
