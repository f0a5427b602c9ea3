/* Soft shadow maps: the parts that ssm.c is made of. */
#ifndef PN_TECHNIQUES_SSM_SSM_H
#define PN_TECHNIQUES_SSM_SSM_H

#include "techniques/technique.h"

/* The pair's textures that are ours. */
enum { SSM_COUNTS, SSM_LIST, SSM_LIMITS, SSM_ARGUMENTS, SSM_BATCH, SSM_SUM, SSM_SOFT = SSM_SUM + 2, SSM_BOUND };
_Static_assert((int)SSM_BOUND < (int)PNI_WORK_MAX, "the pair has a place for every texture");

/* What the GPU counts: vertices of a list's micropatches, and of the rows of its texture. */
enum { SSM_DRAW_PATCHES, SSM_DRAW_ROWS, SSM_DRAWS };

/* Entries of a list: more micropatches are drawn by several lists, one after the other. */
enum { SSM_LIST_WIDTH = 1024, SSM_LIST_MOST = 1024 * 1024 };

/* One list of micropatches: those of one side in one map, for one layer of the receiver map. */
typedef struct {
  const pni_visibility_request *request;
  int map, layer; /* of the occluder maps, and within one */
  int seen_layer;
  double share; /* of the light's width that merging may move an edge; 0: every texel for itself */
  int first;    /* entry */
} ssm_list;

/* Entries there can be at most, and the size of one list. */
int ssm_list_most(const pni_maps *maps);
int ssm_list_size(const pni_maps *maps);

/* The pyramid of counts, then the list from entry first on, and its draw's arguments. (extents_gpu.c) */
pn_result ssm_gpu_count(const ssm_list *list);
pn_result ssm_gpu_list(const ssm_list *list);
/* Entries in all: read back. */
pn_result ssm_gpu_total(const ssm_list *list, int *out);
pn_result ssm_gpu_shape(const pni_visibility_request *request);
pn_result ssm_gpu_prepare(pni_gpu *gpu);

/* The same list, made on the CPU from the maps read back. entries: 8 floats each, as list.frag.glsl lays them out;
 * pni_free frees them. (extents_cpu.c) */
pn_result ssm_cpu_list(const ssm_list *list, float **entries, int *count);
/* Puts entries from list->first on where the GPU's list lies. */
pn_result ssm_cpu_upload(const ssm_list *list, const float *entries, int count);

/* What is summed up: the shadow, the bound of its error, or how many micropatches there are. */
typedef enum { SSM_SUM_SHADOW, SSM_SUM_BOUND, SSM_SUM_COUNT } ssm_sum_kind;

typedef struct {
  const pni_visibility_request *r;
  bool by_batches; /* of the shadow only */
  bool on_cpu;     /* where extents are found */
  double share;    /* as ssm_list's */
  ssm_sum_kind kind;
  const pni_texture *soft; /* the soft shadow map: sides, and in each a layer for each of the receivers */
  int sum;                 /* by batches: which of two images holds it */
  pni_attachment target;   /* the layer of it that is summed up */
} ssm_scattering;

/* Sums up all sides for all layers of receivers into soft. (scatter.c) */
pn_result ssm_scatter(ssm_scattering *scattering);
pn_result ssm_scatter_prepare(pni_gpu *gpu);
/* What was drawn since the last mark was this stage. */
void ssm_mark(const ssm_scattering *scattering, const char *stage);

#endif
