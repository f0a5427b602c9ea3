/* The patches that cameras see, in cells of (s, t): which casters can shadow any of them. */
#ifndef PNI_RECEIVER_GRID_H
#define PNI_RECEIVER_GRID_H

#include "receiver/patches.h"

enum { PNI_GRID_CELLS = 64, PNI_GRID_BLOCK = 8 }; /* a side; cells to a side of a block */

typedef struct {
  const pni_patch_list *list_of;
  const pni_patch *patches;
  double extent[2]; /* the light's */
  double origin[2], cell[2];
  int *first; /* of each cell's patches in list, and one more */
  int *list;
  double least_w[PNI_GRID_CELLS * PNI_GRID_CELLS]; /* of what is seen there; infinite where nothing is */
  double block_w[PNI_GRID_CELLS / PNI_GRID_BLOCK * (PNI_GRID_CELLS / PNI_GRID_BLOCK)];
  pni_region region;
} pni_grid;

/* patches must outlive the grid. A list without any makes a grid that nothing shadows. */
pn_result pni_grid_make(pni_gpu *gpu, const pni_patch_list *patches, const double extent[2], pni_grid **out);
void pni_grid_free(pni_gpu *gpu, pni_grid **grid);

/* How far a caster's point may be off: in w, and in place along s and t. */
typedef struct {
  double w, place[2];
} pni_caster_error;

/* Whether any of the hull of these points, (s, t, w), can take light from what is seen: false only where none can. */
bool pni_grid_shadowed(const pni_grid *grid, const double (*points)[3], int count, const pni_caster_error *error);

/* The plane w = plane[2] + plane[0] s + plane[1] t that most of what is seen lies in: a ground, a floor, a wall
 * that the whole light shines on. False: there is none. */
bool pni_grid_plane(const pni_grid *grid, double plane[3]);

#endif
