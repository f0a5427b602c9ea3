/* What the light's centre sees, by rays against the client's own triangles: no map, no GL. */
#ifndef HOST_TRUTH_H
#define HOST_TRUTH_H

#include <penumbra/penumbra.h>

#include "renderer.h"
#include "scene.h"

typedef struct {
  int shape; /* pn_light_shape */
  vec3 center, direction, u, v;
  double half_u, half_v;
  double texel_s, texel_t; /* a texel of the map in light map space */
} truth_light;

/* From the description and what the maps cover. */
truth_light truth_light_of(const pn_light_desc *desc, const pn_maps_info *maps);

/* The faces of a light as seen from p with geometric normal n: corners in front of the surface's plane, 0..4. */
int truth_corners(const truth_light *light, vec3 p, vec3 n);

/* Answers of truth_hard. */
enum { TRUTH_BLOCKED = 0, TRUTH_LIT = 1, TRUTH_EITHER = 2, TRUTH_AWAY = 3 };

/* Is p (on a surface with unit normal n) lit from the light's centre? TRUTH_EITHER where the answer changes within the
 * given number of map texels around (3/4 for one nearest sample: the map stores one depth a texel, and the nearest
 * texel's centre is up to half a texel away), or where the light's plane or the surface's horizon is so near that the
 * map's resolution says nothing. TRUTH_AWAY: no corner is in front. */
int truth_hard(const truth_light *light, const scene *world, vec3 p, vec3 n, double texels);

/* 1 when p sees all of the light and a margin around it: rays to 9 x 9 points of a light 1.3 times as large, and no
 * border of a shadow within four texels. */
int truth_sees_all(const truth_light *light, const scene *world, vec3 p, vec3 n);

/* 1 when the pixel's plane can be told from its neighbours: two pixels to the left or right, and two above or below,
 * show the same flat face. One would not do: that two surfaces meet shows only where a slope changes. */
int truth_plane_known(const surfaces *seen, int x, int y);

/* 1 when the segment from a to b meets a caster strictly between the fractions 0 and most. */
int truth_blocked(const scene *world, vec3 a, vec3 b, double most);

#endif
