#include "techniques/technique.h"

static void want(const double *values, pni_maps_want *out) {
  (void)values;
  *out = (pni_maps_want){.near_layers = 1};
}

const pni_technique_class pni_technique_hard = {
    .table = {.name = "hard",
              .title = "hard shadow",
              .help = "one map, one comparison: the shadow of the light's centre",
              .forward = 1,
              .self_shadows = 1},
    .want = want,
    .draw = pni_gather,
    .gathering = {.shader = "techniques/hard/hard.glsl"},
};
