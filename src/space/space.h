/* Light map space (s, t, w): one formula for everything (docs/space.md). space.glsl has the same functions under the
 * same names; tests/unit/test_space_glsl.c holds the two together.
 *
 *   rectangle  s = x / z   t = y / z   w = 1 / z     with (x, y, z) in the light's frame: origin at its centre,
 *   sun        s = x       t = y       w = -z        z where it shines
 *
 * A receiver R sees an occluder Q in front of the light's point ((s_Q - s_R) / (w_Q - w_R), (t_Q - t_R) / (w_Q -
 * w_R)). */
#ifndef PNI_SPACE_SPACE_H
#define PNI_SPACE_SPACE_H

#include <penumbra/penumbra.h>
#include "space/matrix.h"

/* How the space is projected: towards a light's centre, or along a sun's rays. What the light looks like from there,
 * its outline and emission, is another matter: pni_emission. */
typedef enum { PNI_CENTRAL = 0, PNI_PARALLEL } pni_projection;

typedef struct {
  double origin[3], u[3], v[3], z[3]; /* scene space; u, v, z unit and perpendicular */
  pni_projection projection;
} pni_frame;

/* What emits: the rectangle [-A_u, A_u] x [-A_v, A_v] in the frame's u and v, every point alike. */
typedef struct {
  double extent[2]; /* A_u, A_v: scene units, or tangents */
} pni_emission;

/* The w of what is not there, behind every receiver, and its opposite. Anything beyond a tenth of them is one of
 * them. */
#define PNI_NOTHING -1e30f
#define PNI_EVERYTHING 1e30f
static inline bool pni_is_nothing(double w) { return w <= -1e29; }

/* Stored depths keep this far from 0 and 1, so that those two mean 'nothing here', even where depth clamping moved a
 * caster to the end of the range. */
#define PNI_DEPTH_MARGIN (1.0 / 65536.0)

/* The most a map may open: tangent of 85 degrees to each side. */
#define PNI_TANGENT_MAX 11.430052302761343

/* frame->u, v, z from a direction and an axis; false when either is zero, not finite, or they are parallel. */
bool pni_frame_axes(const float direction[3], const float axis_u[3], pni_frame *frame);
pni_matrix pni_light_from_scene(const pni_frame *frame);

/* Where the frame's origin lies in the (s, t, w) that the host is told: that of a sun begins at the scene's origin. */
void pni_frame_offset(const pni_frame *frame, double m[3]);

/* p in the light's frame to (s, t, w). */
void pni_map_point(const double p[3], pni_projection projection, double m[3]);
/* ... and back. */
void pni_light_point(const double m[3], pni_projection projection, double p[3]);
/* The light's point behind Q as R sees it; meaningful for w_Q > w_R. */
void pni_back_project(const double q[3], const double r[3], double light_point[2]);
/* n . P for a rectangle, n_z for a sun: with it, horizons and planes are the same formula for both. */
double pni_plane_offset(const double n[3], const double p[3], pni_projection projection);
/* How far Q lies in front of R's tangent plane, times w_Q for a rectangle: no division, so no sign flips. k =
 * pni_plane_offset. */
double pni_plane_front(const double n[3], double k, const double q[3], const double r[3]);
/* Above 0 where the light's point lies above R's horizon. */
double pni_horizon(const double n[3], double k, const double light_point[2]);
/* Half width, along s or t, of the texels that can block a receiver at w_r when nothing lies nearer than w_max. */
double pni_search_window(double extent, double w_max, double w_r);
/* How far, along s or t, a micropatch at w can darken receivers no farther than w_min. */
double pni_penumbra_extent(double extent, double w, double w_min);

/* Depth is affine in w: w = w_of_depth[0] + w_of_depth[1] * stored depth. */
void pni_depth_scale(double w_near, double w_far, double w_of_depth[2]);

/* Clip space of a map that covers [s0, s1] x [t0, t1] between w_near and w_far, for coordinates in the light's frame;
 * sheared, it is the map as seen from the light's point (shear[0], shear[1]): s' = s - shear w, for both kinds of
 * light. */
pni_matrix pni_clip_from_light(pni_projection projection, const double bounds[4], double w_near, double w_far,
                               const double shear[2]);

#endif
