/* Soft shadow maps: the parts that ssm.c is made of. */
#ifndef PNI_TECHNIQUES_SSM_SSM_H
#define PNI_TECHNIQUES_SSM_SSM_H

#include "techniques/ssm/seen.h"
#include "techniques/technique.h"

/* What it keeps for a pair. */
typedef struct {
  pni_seen seen;
  pni_texture counts;         /* pyramid: micropatches in and below each node of the occluders' */
  pni_texture list, limits;   /* of micropatches, as list.frag.glsl lays them out */
  pni_texture totals;         /* what the GPU counts, by PNI_SSM_DRAW_... */
  pni_buffer arguments;       /* the same as arguments of draws */
  pni_texture batch, sums[2]; /* sums by batches: one of them, and those before it in turn */
  pni_texture soft;           /* the soft shadow map: sides, and in each a layer for each of the receivers */
  pni_texture covered;        /* how often each texel was come by, when debugging */
  pni_texture bounds, bound;  /* of the error, when debugging: the map, and as the camera sees it */
  float *scratch;             /* for lists made on the CPU, during a draw */
  size_t scratch_floats;
  pn_soft_shadow_map shown; /* of the last draw; no texture: none */
  bool warned;              /* the last draw had something to warn of */
} pni_ssm_state;

/* What the GPU counts: vertices of a list's micropatches, and of the rows of its texture. */
enum { PNI_SSM_DRAW_PATCHES, PNI_SSM_DRAW_ROWS, PNI_SSM_DRAWS };

/* Entries of a list: more micropatches are drawn by several lists, one after the other. */
enum { PNI_SSM_LIST_WIDTH = 1024, PNI_SSM_LIST_MOST = 1024 * 1024 };

/* One list of micropatches: those of one side in one map, for one layer of seen surfaces. */
typedef struct {
  const pni_job *job;
  pni_ssm_state *state;
  int map, layer; /* of the occluder maps, and within one */
  int seen_layer;
  double share; /* of the light's width that merging may move an edge; 0: every texel for itself */
  bool pairs;   /* whatever a texel or its right or upper neighbour reaches: Eq. 3 speaks of pairs */
  int first;    /* entry */
} pni_ssm_list;

/* Entries there can be at most, and the size of one list. */
int pni_ssm_list_most(const pni_maps *maps);
int pni_ssm_list_size(const pni_maps *maps);

/* The pyramid of counts, then the list from entry first on, and its draw's arguments. (extents_gpu.c) */
pn_result pni_ssm_gpu_count(const pni_ssm_list *list);
pn_result pni_ssm_gpu_list(const pni_ssm_list *list);
/* Entries in all: read back. */
int pni_ssm_gpu_total(const pni_ssm_list *list);
pn_result pni_ssm_gpu_shape(const pni_job *job);

/* The same list, made on the CPU from the maps read back, and put where the GPU's lies. total: entries in all, 1 while
 * the call is planned. (extents_cpu.c) */
pn_result pni_ssm_cpu_list(const pni_ssm_list *list, int *total);

/* What is summed up: the shadow, the bound of its error, or how many micropatches there are. */
typedef enum { PNI_SSM_SUM_SHADOW, PNI_SSM_SUM_BOUND, PNI_SSM_SUM_COUNT } pni_ssm_sum_kind;

typedef struct {
  const pni_job *job;
  pni_ssm_state *state;
  bool by_batches;  /* of the shadow only */
  bool consecutive; /* a batch takes neighbours in the list, not entries from all over it */
  bool on_cpu;      /* where extents are found */
  double share;     /* as pni_ssm_list's */
  pni_ssm_sum_kind kind;
  const pni_texture *soft; /* what is summed up into */
  int sum;                 /* by batches: which of two images holds it */
  int target;              /* the layer of soft that is summed up */
} pni_ssm_scattering;

/* Sums up all sides for all layers of receivers into soft. (scatter.c) */
pn_result pni_ssm_scatter(pni_ssm_scattering *scattering);
/* What was drawn since the last mark was this stage. */
void pni_ssm_mark(const pni_ssm_scattering *scattering, const char *stage);

#endif
