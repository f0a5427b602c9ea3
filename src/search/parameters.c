#include "search/parameters.h"

#include <stdio.h>

const char *const pni_hierarchy_names[] = {"mssm", "hsm", "none", NULL};

/* Covering quads exactly takes loops of its own, and software GL ends a shader's loops after 65535 turns in all: a
 * scan of every texel would not fit, a descent that merges nothing does. */
static bool descends(const pni_search_values *v) { return v->merge > 0 || v->primitive == PNI_PRIMITIVE_QUAD_EXACT; }

pni_range_kind pni_search_range(const pni_search_values *v) {
  bool descent = descends(v), stack = v->hierarchy == PNI_HIERARCHY_MSSM && !descent;
  return (pni_range_kind){stack ? PNI_RANGE_STACK : PNI_RANGE_PYRAMID, v->primitive != PNI_PRIMITIVE_PATCH, descent};
}

float pni_search_focus(double percent) { return percent < 100 ? (float)(0.01 * percent) : 0; }

int pni_search_defines(const pni_search_values *v, char *out, size_t size) {
  bool descent = descends(v);
  int refine = v->hierarchy == PNI_HIERARCHY_NONE ? 0 : v->hierarchy == PNI_HIERARCHY_MSSM && !descent ? 2 : 1;
  return snprintf(out, size, "PN_PRIMITIVE %d\nPN_GAPS %d\nPN_EDGES %d\nPN_DESCENT %d\nPN_REFINE %d\n",
                  (int)v->primitive, v->gaps, v->edges, descent, refine);
}
