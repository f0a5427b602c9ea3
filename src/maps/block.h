/* What shaders are told of a light and its maps: the uniform block of maps/maps.glsl, member for member. A test asks
 * the compiler for every offset and holds the two together. */
#ifndef PNI_MAPS_BLOCK_H
#define PNI_MAPS_BLOCK_H

enum { PNI_MAPS_MAX = 16, PNI_PARAMETERS_MAX = 32 };

typedef struct {
  float origin[2];      /* s0, t0 */
  float density[2];     /* texels per unit of s, of t */
  float w_of_depth[2];  /* w at depth 0, w per depth */
  float light_point[2]; /* that it is seen from, beside the light's centre */
  float size[2];        /* texels */
  float first_layer;    /* in the array of depth images */
  float layers;
} pni_map_block;

typedef struct {
  float scene_u[4], scene_v[4], scene_z[4]; /* light frame from scene, by rows */
  float scene_error[4];                     /* by what far object coordinates lose: light frame, and along z per z */
  float extent[2];                          /* A_u, A_v */
  float parallel;                           /* 1 for a sun */
  float w_reach;                            /* no receiver lies below (maps that reach as far as shadows do) */
  float map_count;
  float w_near, w_far;                  /* planes: no caster lies beyond */
  float w_error;                        /* of a stored depth, in w */
  float raster_error;                   /* texels */
  float layers;                         /* the most that a map has */
  float texel[2];                       /* width and height of the largest texel of all maps, in s and t */
  float parameters[PNI_PARAMETERS_MAX]; /* the technique's, in the order of its table */
  pni_map_block maps[PNI_MAPS_MAX];
} pni_light_block;

_Static_assert(sizeof(pni_map_block) == 48 && sizeof(pni_light_block) % 16 == 0, "std140: rows of four");

#endif
