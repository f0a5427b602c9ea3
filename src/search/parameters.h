/* Parameters that techniques with a search share. */
#ifndef PNI_SEARCH_PARAMETERS_H
#define PNI_SEARCH_PARAMETERS_H

#include "gather/gather.h"

typedef enum { PNI_PRIMITIVE_PATCH, PNI_PRIMITIVE_QUAD, PNI_PRIMITIVE_QUAD_EXACT } pni_primitive;
typedef enum { PNI_HIERARCHY_MSSM, PNI_HIERARCHY_HSM, PNI_HIERARCHY_HYBRID, PNI_HIERARCHY_NONE } pni_hierarchy;

extern const char *const pni_hierarchy_names[];

/* Rows of a technique's table. source: where its paper speaks of it. */
#define PNI_PARAMETER_HIERARCHY(source) \
  { \
    "hierarchy", "", \
        "what narrows the search: range stack, range pyramid, a stack above a pyramid, nothing; " \
        "with merge above 0 the pyramid", \
        source, PN_CHOICE, 0, 3, PNI_HIERARCHY_MSSM, pni_hierarchy_names \
  }
#define PNI_PARAMETER_CAP(source) \
  { \
    "cap", "texels", \
        "at most N x N primitives in a pixel's window of each map, coarser ones past it; 0 = no cap; " \
        "with merge=0 only", \
        source, PN_INT, 0, 4096, 0, NULL \
  }
#define PNI_PARAMETER_MERGE \
  { \
    "merge", "%", \
        "blocks are one primitive where that moves no edge by more than this part of the light; 0 = every texel", "", \
        PN_FLOAT, 0, 50, 1, NULL \
  }
#define PNI_PARAMETER_EDGES \
  { \
    "edges", "", \
        "quads that lack a corner are covered by the parts of the others: thin things keep their shadow; off = as in " \
        "the " \
        "paper", \
        "", PN_BOOL, 0, 1, 1, NULL \
  }
#define PNI_PARAMETER_FOCUS \
  { \
    "focus", "%", \
        "layers past the first hold this part of the map's width and height, below the light; 100 = all of it", \
        "Bitmask Soft Shadows, section 3.2", PN_FLOAT, 1, 100, 100, NULL \
  }

typedef struct {
  pni_primitive primitive;
  pni_hierarchy hierarchy;
  bool gaps, edges;
  double merge;
  int cap;
} pni_search_values;

/* What a technique keeps for a pair: whether it told what it had to tell. */
typedef struct {
  bool told;
} pni_search_state;

/* What summarises the maps for such a search. Descent walks the pyramid, whatever narrows the window. */
pni_range_kind pni_search_range(const pni_search_values *values);
/* pni_maps_want.focus from the parameter's percentage. */
float pni_search_focus(double percent);
/* The lines search.glsl wants. Returns their length. */
int pni_search_defines(const pni_search_values *values, char *out, size_t size);
/* Tells the host, once, where windows may be too large to take every texel of them; state: kept with the pair. */
void pni_search_tell(const pni_job *job, pni_search_state *state, const pni_search_values *values);

#endif
