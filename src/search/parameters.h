/* Parameters that techniques with a search share. */
#ifndef PN_SEARCH_PARAMETERS_H
#define PN_SEARCH_PARAMETERS_H

#include "maps/maps.h"

typedef enum { PN_PRIMITIVE_PATCH, PN_PRIMITIVE_QUAD, PN_PRIMITIVE_QUAD_EXACT } pn_primitive;
typedef enum { PN_HIERARCHY_MSSM, PN_HIERARCHY_HSM, PN_HIERARCHY_NONE } pn_hierarchy;

extern const char *const pn_hierarchy_names[];

/* Rows of a technique's table. source: where its paper speaks of it. */
#define PN_PARAMETER_HIERARCHY(source) \
  {"hierarchy", "", "what narrows the search: range stack, range pyramid, nothing; with merge above 0 the pyramid", \
   source, PN_CHOICE, 0, 2, PN_HIERARCHY_MSSM, pn_hierarchy_names}
#define PN_PARAMETER_CAP(source) \
  {"cap", "texels", "at most N x N primitives a pixel, coarser ones past it; 0 = no cap; with merge=0 only", source, \
   PN_INT, 0, 4096, 0, NULL}
#define PN_PARAMETER_MERGE \
  {"merge", "%", \
   "blocks are one primitive where that moves no edge by more than this part of the light; 0 = every texel", "", \
   PN_FLOAT, 0, 50, 1, NULL}
#define PN_PARAMETER_EDGES \
  {"edges", "", \
   "quads that lack a corner are covered by the parts of the others: thin things keep their shadow; off = as in the " \
   "paper", \
   "", PN_BOOL, 0, 1, 1, NULL}
#define PN_PARAMETER_FOCUS \
  {"focus", "%", \
   "layers past the first hold this part of the map's width and height, below the light; 100 = all of it", \
   "Bitmask Soft Shadows, section 3.2", PN_FLOAT, 1, 100, 100, NULL}

typedef struct {
  pn_primitive primitive;
  pn_hierarchy hierarchy;
  bool gaps, edges;
  double merge;
  int merge_index, cap_index; /* places in the technique's table */
} pn_search_values;

/* What summarises the maps for such a search. Descent walks the pyramid, whatever narrows the window. */
pn_range_kind pn_search_range(const pn_search_values *values);
/* pn_maps_want.focus from the parameter's percentage. */
float pn_search_focus(double percent);
/* The lines search.glsl wants. Returns their length. */
int pn_search_defines(const pn_search_values *values, char *out, size_t size);

#endif
