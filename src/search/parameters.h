/* Parameters that techniques with a search share. */
#ifndef PN_SEARCH_PARAMETERS_H
#define PN_SEARCH_PARAMETERS_H

#include "maps/maps.h"

typedef enum { PN_PRIMITIVE_PATCH, PN_PRIMITIVE_QUAD, PN_PRIMITIVE_QUAD_EXACT } pn_primitive;
typedef enum { PN_HIERARCHY_MSSM, PN_HIERARCHY_HSM, PN_HIERARCHY_NONE } pn_hierarchy;

extern const char *const pn_hierarchy_names[];

typedef struct {
  pn_primitive primitive;
  pn_hierarchy hierarchy;
  bool gaps, edges;
  double merge;
  int merge_index, cap_index; /* places in the technique's table */
} pn_search_values;

/* What summarises the maps for such a search. Descent walks the pyramid, whatever narrows the window. */
pn_range_kind pn_search_range(const pn_search_values *values);
/* The lines search.glsl wants. Returns their length. */
int pn_search_defines(const pn_search_values *values, char *out, size_t size);

#endif
