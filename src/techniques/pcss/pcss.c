#include "techniques/technique.h"

static const pn_parameter parameters[] = {
    {"samples", "", "samples along each axis, in the blocker search and in the filter", "Fernando 2005", PN_INT, 1, 64,
     8, NULL},
};

static void want(const double *values, pn_maps_want *out) {
  (void)values;
  *out = (pn_maps_want){.near_layers = 1, .range = {PN_RANGE_PYRAMID, false}};
}

const pn_technique_class pn_technique_pcss = {
    .table = {.name = "pcss",
              .title = "percentage-closer soft shadows",
              .help =
                  "blockers searched over the light's real extent, then one filter of the width their average asks for",
              .parameters = parameters,
              .parameter_count = 1,
              .forward = 1,
              .self_shadows = 1},
    .want = want,
    .shader = "techniques/pcss/pcss.glsl",
};
