#include "search/parameters.h"

#include <stdio.h>

const char *const pni_hierarchy_names[] = {"mssm", "hsm", "hybrid", "none", NULL};

/* Texels that a receiver looks at in all maps together, where nothing is merged: as many as software GL lets loops turn
 * for. */
enum { TEXELS_MAX = 360000 };

/* Covering quads exactly takes loops of its own, and software GL ends a shader's loops after 65535 turns in all: a
 * scan of every texel would not fit, a descent that merges nothing does. */
static bool descends(const pni_search_values *v) { return v->merge > 0 || v->primitive == PNI_PRIMITIVE_QUAD_EXACT; }

/* Descent walks the pyramid, whatever narrows the window; where nothing does, gaps and blocks are there. */
static pni_range_structure structure(const pni_search_values *v) {
  if (!descends(v) && v->hierarchy == PNI_HIERARCHY_MSSM) return PNI_RANGE_STACK;
  return !descends(v) && v->hierarchy == PNI_HIERARCHY_HYBRID ? PNI_RANGE_HYBRID : PNI_RANGE_PYRAMID;
}

pni_range_kind pni_search_range(const pni_search_values *v) {
  return (pni_range_kind){structure(v), v->primitive != PNI_PRIMITIVE_PATCH, descends(v)};
}

float pni_search_focus(double percent) { return percent < 100 ? (float)(0.01 * percent) : 0; }

int pni_search_defines(const pni_search_values *v, char *out, size_t size) {
  static const int ways[] = {[PNI_RANGE_PYRAMID] = 1, [PNI_RANGE_STACK] = 2, [PNI_RANGE_HYBRID] = 3};
  int refine = v->hierarchy == PNI_HIERARCHY_NONE ? 0 : ways[structure(v)];
  return snprintf(out, size,
                  "PN_PRIMITIVE %d\nPN_GAPS %d\nPN_EDGES %d\nPN_DESCENT %d\nPN_REFINE %d\nPN_TEXELS_MAX %d\n",
                  (int)v->primitive, v->gaps, v->edges, descends(v), refine, TEXELS_MAX);
}

void pni_search_tell(const pni_job *job, pni_search_state *state, const pni_search_values *v) {
  const pni_texture *depth = &job->maps->depth;
  int most = TEXELS_MAX / depth->layers;
  bool coarser = !descends(v) && depth->width * depth->height > most && (v->cap == 0 || v->cap * v->cap > most);
  if (job->gpu->plan.on) return;
  if (coarser && !state->told)
    pni_note(job->gpu, PN_LOG_INFO, PN_MESSAGE_SEARCH_COARSER,
             "without merging, windows of more than %d texels of a map are searched in coarser blocks", most);
  state->told = coarser;
}
