/* What float arithmetic loses far from the origin (docs/space.md, 'Far from the origin'). */
#ifndef PNI_SPACE_ROUNDING_H
#define PNI_SPACE_ROUNDING_H

#include "space/space.h"

/* A matrix times a position, in floats: each term of a row is rounded as an entry, as a product and in three sums, by
 * 2^-24 of it each time. */
#define PNI_MATRIX_ROUNDING (5 * 0x1p-24)

/* Scene units. */
typedef struct {
  /* Of drawing into maps, by the light frame's axes, of the host's buffers and callbacks; the third grows with z: */
  double map[3], map_per_z;
  double host; /* of the host's drawing of the same meshes, into the depth that it hands over: any direction */
} pni_rounding;

/* What coordinates between low and high are better seen from: their middle, where that is at least as far away as they
 * are wide; else 0. The difference is then a float, without rounding: low and high are within a factor of two. */
double pni_far_middle(float low, float high);

/* What a box loses under the matrix because its coordinates are larger than when seen from their middle: by rows. */
void pni_box_rounding(const pni_matrix *matrix, const float min[3], const float max[3], double out[3]);

/* From what light_from_object loses, in rounding->map, to what clip_from_object does, whose rows mix that matrix's: for
 * maps within these bounds. */
void pni_map_rounding(pni_rounding *rounding, pni_projection projection, const double bounds[4], double w_near);

/* What positions near the camera lose in a host's shader that goes through scene space: scene units, any direction. */
double pni_view_rounding(const pni_matrix *eye_from_scene);

#endif
