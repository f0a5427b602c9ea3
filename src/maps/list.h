/* The list of a light's maps: what a technique may want of it, and what it consists of. An entry may be a tile of a
 * wide light or the view from a point of it: techniques do not care. */
#ifndef PNI_MAPS_LIST_H
#define PNI_MAPS_LIST_H

#include "casters/rounding.h"
#include "gl/pass.h"
#include "maps/block.h"
#include "maps/fit.h"

enum { PNI_LAYERS_MAX = 16 };

/* Largest and smallest w of neighbourhoods: a pyramid (the papers' HSM: level i over blocks of 2^i texels a side) or
 * a stack (their MSSM: level i over the 2^i x 2^i texels centred on each texel, at full resolution), or a pyramid up to
 * blocks of PNI_HYBRID_BLOCK texels and a stack over these. Over quads, or where least_there asks for it in a pyramid:
 * a third channel has the smallest w beside empty texels, PN_EVERYTHING where all are. Over quads: a fourth has gaps in
 * depth (gaps.glsl). Both: each texel brings its right and upper neighbours, so that a block has all corners of its
 * quads; without least_there ranges are those of texels. */
typedef enum { PNI_RANGE_NONE = 0, PNI_RANGE_PYRAMID, PNI_RANGE_STACK, PNI_RANGE_HYBRID } pni_range_structure;
enum { PNI_HYBRID_BLOCK = 4 };
typedef struct {
  pni_range_structure structure;
  bool quads, least_there;
} pni_range_kind;

/* What a technique wants to have drawn. In the array texture, a map's layers are: near surfaces first, nearest to
 * farther, then the farthest one. */
typedef struct {
  int near_layers;                /* peeled layers from the nearest; 0..PNI_LAYERS_MAX */
  bool farthest;                  /* the farthest surface, as the last layer */
  pn_faces near_faces, far_faces; /* which surfaces count: 0 where it does not matter */
  float focus;                    /* layers past the first hold only this share of the map's width and height; 0: all */
  pni_range_kind range;           /* what summarises every layer */
  bool reach;                     /* maps cover what the casters can darken, not only the casters themselves */
  double reach_width;             /* ... that is so far around them, map units; 0: as far as the light's size says */
  bool reach_turned;              /* ... or as far as that along the normals of edges, more than A on an axis */
  bool receivers;                 /* casters that shadow nothing seen are drawn too: shadows fall on them */
  int variant;                    /* of what the technique's own update makes beside the maps */
} pni_maps_want;

typedef struct {
  pni_texture depth, range, peel[2], aside; /* aside: a level of the stack while it is drawn */
  pni_maps_want want;
  pni_fit_result fit;
  pni_rounding rounding;        /* of what they show */
  pni_light_block block;        /* all but the parameters */
  pni_part later[PNI_MAPS_MAX]; /* with want.focus: what layers past the first of each map hold */
  bool ready;
} pni_maps;

/* Depth images of each map. */
static inline int pni_want_layers(const pni_maps_want *want) { return want->near_layers + (want->farthest ? 1 : 0); }

/* Whether maps drawn for one are those that the other wants. */
bool pni_want_same(const pni_maps_want *a, const pni_maps_want *b);

#endif
