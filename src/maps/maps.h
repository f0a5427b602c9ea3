/* Images seen from the light: layers of depth over the tiles of a fit, and the range pyramid above them. */
#ifndef PN_MAPS_MAPS_H
#define PN_MAPS_MAPS_H

#include "maps/fit.h"

enum { PN_MAPS_MAX = 16, PN_LAYERS_MAX = 16, PN_PARAMETERS_MAX = 12 };

/* Largest and smallest w of neighbourhoods: a pyramid (the papers' HSM: level i over blocks of 2^i texels a side) or
 * a stack (their MSSM: level i over the 2^i x 2^i texels centred on each texel, at full resolution). Over quads, each
 * texel brings its right and upper neighbours. least_there, pyramids only: a third channel has the smallest w beside
 * empty texels, 1e30 where all are. */
typedef enum {
  PN_RANGE_NONE = 0,
  PN_RANGE_PYRAMID,
  PN_RANGE_STACK,
  PN_RANGE_OWN /* the technique puts an image of its own in that place: see pn_technique_class.build */
} pn_range_structure;
typedef struct {
  pn_range_structure structure;
  bool quads, least_there;
} pn_range_kind;

/* What a technique wants to have drawn. In the array texture, a map's layers are: near surfaces first, nearest to
 * farther, then the farthest one. */
typedef struct {
  int near_layers;                /* peeled layers from the nearest; 0..PN_LAYERS_MAX */
  bool farthest;                  /* the farthest surface, as the last layer */
  pn_faces near_faces, far_faces; /* which surfaces count: PN_FACES_ANY where it does not matter */
  float focus;                    /* layers past the first hold only this share of the map's width and height; 0: all */
  pn_range_kind range;            /* what summarises every layer */
  bool reach;                     /* maps cover what the casters can darken, not only the casters themselves */
  double reach_width;             /* ... that is so far around them, map units; 0: as far as the light's size says */
} pn_maps_want;

/* The uniform block of maps.glsl, std140. */
typedef struct {
  float scene_u[4], scene_v[4], scene_z[4];
  float extent[4];
  float maps[4];
  float range[4]; /* pn_LightData.range: not the pyramid */
  float parameters[PN_PARAMETERS_MAX];
  float map_bounds[PN_MAPS_MAX][4];
  float map_depth[PN_MAPS_MAX][4];
} pn_light_block;

typedef struct {
  pn_texture depth, range, peel[2], aside; /* aside: a level of the stack while it is drawn */
  pn_maps_want want;
  pn_fit_result fit;
  int layers;                 /* of each map */
  pn_light_block block;       /* all but the parameters */
  pn_part later[PN_MAPS_MAX]; /* with want.focus: what layers past the first of each map hold */
  bool ready;
} pn_maps;

int pn_want_layers(const pn_maps_want *want);

/* Shapes the textures for what is wanted. */
pn_result pn_maps_shape(pn_gpu *gpu, pn_maps *maps, const pn_maps_want *want, int count, int width, int height);
/* Draws one map (tile or light sample) into its layers. */
typedef struct {
  const pn_frame *frame;
  pn_casters *casters;
  uint32_t groups;
  int map; /* its place in the list */
  double bounds[4], w_near, w_far, shear[2];
  pn_part later; /* with want.focus: the texels that layers past the first are drawn over */
} pn_map_draw;
pn_result pn_maps_draw(pn_gpu *gpu, pn_maps *maps, const pn_map_draw *draw);
/* Fills pyramid or stack from what was drawn; the block must be bound. (maps/range.c) */
pn_result pn_range_build(pn_gpu *gpu, pn_maps *maps);
/* The levels of a pyramid above its first one, for every layer. */
pn_result pn_range_reduce(pn_gpu *gpu, const pn_texture *range);
pn_result pn_range_shape(pn_gpu *gpu, pn_texture *texture, const pn_range_kind *kind, int layers, int width,
                         int height);
pn_result pn_range_prepare(pn_gpu *gpu, const pn_range_kind *kind);
pn_result pn_maps_prepare(pn_gpu *gpu, const pn_maps_want *want);
/* The parts of the block that do not depend on single maps. count: of maps. */
void pn_block_frame(pn_light_block *block, const pn_frame *frame, const pn_gpu *gpu, int count, int layers, int width,
                    int height);
/* Adds a map to the block. */
void pn_block_map(pn_light_block *block, const pn_gpu *gpu, const pn_map_draw *draw, int width, int height);
void pn_maps_free(pn_gpu *gpu, pn_maps *maps, bool abandon);

#endif
