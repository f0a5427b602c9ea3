/* Which part of light map space a light's maps cover: fitted to what casts, snapped, and split into tiles where the
 * light sees too wide. docs/space.md explains the steps. */
#ifndef PNI_MAPS_FIT_H
#define PNI_MAPS_FIT_H

#include "casters/casters.h"
#include "gl/pass.h"
#include "receiver/grid.h"
#include "space/region.h"

enum { PNI_TILES_MAX = 9 };

/* Where casters lie that can shadow something seen (maps/trim.c), cell: how finely that was looked at. */
typedef struct {
  double bounds[4], cell[2];
  bool has_floor;  /* there are casters on it or below, which are left out of the maps */
  double floor[3]; /* w = [2] + [0] s + [1] t, below all that is seen */
} pni_fit_kept;

typedef struct {
  bool empty;       /* nothing casts here */
  bool clamped;     /* opened past 170 degrees */
  double bounds[4]; /* s0, t0, s1, t1 */
  double w_near, w_far;
  pni_fit_kept kept; /* of the request, cell 0 where it had none */
  double w_reach;    /* with reach: no receiver lies below */
  bool has_ground;   /* with receivers, where surfaces are looked at: most of them lie in a plane */
  double ground[3];  /* ... w = [2] + [0] s + [1] t, moved down so that all that is seen lies above */
  int tiles;
  double tile[PNI_TILES_MAX][4]; /* with a border of one texel at least, except for a fit that is given */
} pni_fit_result;

typedef struct {
  const pni_frame *frame;
  const pni_emission *emission;
  double shear[2]; /* the light's point the map is drawn from, for both kinds of light */
  double near_distance, range;
  int width, height;
  const float *given;        /* PN_FIT_GIVEN's box, or NULL */
  const pni_region *visible; /* receivers that casters must be able to shadow, or NULL */
  const pni_grid *grid;      /* the same in detail, or NULL */
  const pni_fit_kept *kept;  /* other casters do not count, or NULL */
  /* Cover what the casters can darken, as far as the light's extent says, or reach_width map units, around them; of
   * that what visible receivers can ask for. */
  bool reach;
  double reach_width;
  bool receivers; /* maps' depth goes down to all that is seen, where casters may lie that shadow nothing */
} pni_fit_request;

/* Casters wholly beyond it cast nothing; 0: no limit. A sun has no distance. */
double pni_fit_range(const pni_fit_request *request);

void pni_fit_maps(const pn_casters *casters, uint32_t groups, const pni_fit_request *request, pni_fit_result *out);

/* The texels of a tile that layers past the first are drawn over when they hold only this share of the fit's width and
 * height: around the point straight below a rectangle, or as near to it as the fit reaches; for a sun, around the
 * fit's middle. Whole texels, outwards; empty where the tile has none. */
pni_part pni_fit_focus(const pni_fit_request *request, const pni_fit_result *fit, int tile, double share);

#endif
