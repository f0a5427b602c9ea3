/* The smallest technique with a parameter: a folder of tests/added that a copy of src/ is given. */
#include "techniques/technique.h"

static const pn_parameter parameters[] = {
    {"level", "", "visibility where the light's centre is hidden", "none", PN_FLOAT, 0, 1, 0.25, NULL},
};

static void want(const double *values, pni_maps_want *out) {
  (void)values;
  *out = (pni_maps_want){.near_layers = 1};
}

const pni_technique_class pni_technique_flat = {
    .table = {.name = "flat",
              .title = "flat shadow",
              .help = "a hard shadow that lets some light through",
              .parameters = parameters,
              .parameter_count = 1,
              .forward = 1,
              .self_shadows = 1},
    .want = want,
    .draw = pni_gather,
    .gathering = {.shader = "techniques/flat/flat.glsl"},
};
