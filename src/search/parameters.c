#include "search/parameters.h"

#include <stdio.h>

const char *const pn_hierarchy_names[] = {"mssm", "hsm", "none", NULL};

pn_range_kind pn_search_range(const pn_search_values *v) {
  bool stack = v->hierarchy == PN_HIERARCHY_MSSM && v->merge == 0;
  return (pn_range_kind){stack ? PN_RANGE_STACK : PN_RANGE_PYRAMID, v->primitive != PN_PRIMITIVE_PATCH};
}

int pn_search_defines(const pn_search_values *v, char *out, size_t size) {
  bool descent = v->merge > 0;
  int refine = v->hierarchy == PN_HIERARCHY_NONE ? 0 : v->hierarchy == PN_HIERARCHY_MSSM && !descent ? 2 : 1;
  return snprintf(out, size, "PN_PRIMITIVE %d\nPN_GAPS %d\nPN_DESCENT %d\nPN_REFINE %d\nPN_MERGE %d\nPN_CAP %d\n",
                  (int)v->primitive, v->gaps, descent, refine, v->merge_index, v->cap_index);
}
