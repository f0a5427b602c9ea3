/* Images seen from the light: layers of depth over the tiles of a fit, and the range pyramid above them. */
#ifndef PN_MAPS_MAPS_H
#define PN_MAPS_MAPS_H

#include "maps/fit.h"

enum { PNI_MAPS_MAX = 16, PNI_LAYERS_MAX = 16, PNI_PARAMETERS_MAX = 12 };

/* Largest and smallest w of neighbourhoods: a pyramid (the papers' HSM: level i over blocks of 2^i texels a side) or
 * a stack (their MSSM: level i over the 2^i x 2^i texels centred on each texel, at full resolution). Over quads, each
 * texel brings its right and upper neighbours. least_there, pyramids only: a third channel has the smallest w beside
 * empty texels, 1e30 where all are. */
typedef enum {
  PNI_RANGE_NONE = 0,
  PNI_RANGE_PYRAMID,
  PNI_RANGE_STACK,
  PNI_RANGE_OWN /* the technique puts an image of its own in that place: see pni_technique_class.build */
} pni_range_structure;
typedef struct {
  pni_range_structure structure;
  bool quads, least_there;
} pni_range_kind;

/* What a technique wants to have drawn. In the array texture, a map's layers are: near surfaces first, nearest to
 * farther, then the farthest one. */
typedef struct {
  int near_layers;                /* peeled layers from the nearest; 0..PNI_LAYERS_MAX */
  bool farthest;                  /* the farthest surface, as the last layer */
  pn_faces near_faces, far_faces; /* which surfaces count: PN_FACES_ANY where it does not matter */
  float focus;                    /* layers past the first hold only this share of the map's width and height; 0: all */
  pni_range_kind range;           /* what summarises every layer */
  bool reach;                     /* maps cover what the casters can darken, not only the casters themselves */
  double reach_width;             /* ... that is so far around them, map units; 0: as far as the light's size says */
} pni_maps_want;

/* The uniform block of maps.glsl, std140. */
typedef struct {
  float scene_u[4], scene_v[4], scene_z[4];
  float extent[4];
  float maps[4];
  float range[4]; /* pn_LightData.range: not the pyramid */
  float parameters[PNI_PARAMETERS_MAX];
  float map_bounds[PNI_MAPS_MAX][4];
  float map_depth[PNI_MAPS_MAX][4];
} pni_light_block;

typedef struct {
  pni_texture depth, range, peel[2], aside; /* aside: a level of the stack while it is drawn */
  pni_maps_want want;
  pni_fit_result fit;
  int layers;                   /* of each map */
  pni_light_block block;        /* all but the parameters */
  pni_part later[PNI_MAPS_MAX]; /* with want.focus: what layers past the first of each map hold */
  bool ready;
} pni_maps;

int pni_want_layers(const pni_maps_want *want);

/* Shapes the textures for what is wanted. */
pn_result pni_maps_shape(pni_gpu *gpu, pni_maps *maps, const pni_maps_want *want, int count, int width, int height);
/* Draws one map (tile or light sample) into its layers. */
typedef struct {
  const pni_frame *frame;
  pn_casters *casters;
  uint32_t groups;
  int map; /* its place in the list */
  double bounds[4], w_near, w_far, shear[2];
  pni_part later; /* with want.focus: the texels that layers past the first are drawn over */
} pni_map_draw;
pn_result pni_maps_draw(pni_gpu *gpu, pni_maps *maps, const pni_map_draw *draw);
/* Fills pyramid or stack from what was drawn; the block must be bound. (maps/range.c) */
pn_result pni_range_build(pni_gpu *gpu, pni_maps *maps);
/* The levels of a pyramid above its first one, for every layer. */
pn_result pni_range_reduce(pni_gpu *gpu, const pni_texture *range);
pn_result pni_range_shape(pni_gpu *gpu, pni_texture *texture, const pni_range_kind *kind, int layers, int width,
                          int height);
pn_result pni_range_prepare(pni_gpu *gpu, const pni_range_kind *kind);
pn_result pni_maps_prepare(pni_gpu *gpu, const pni_maps_want *want);
/* The parts of the block that do not depend on single maps. count: of maps. */
void pni_block_frame(pni_light_block *block, const pni_frame *frame, const pni_gpu *gpu, int count, int layers,
                     int width, int height);
/* Adds a map to the block. */
void pni_block_map(pni_light_block *block, const pni_gpu *gpu, const pni_map_draw *draw, int width, int height);
void pni_maps_free(pni_gpu *gpu, pni_maps *maps, bool abandon);

#endif
