#include "techniques/technique.h"

enum { PRESET, SAMPLES, COUNT };

static const char *const presets[] = {"fast", "good", "exact", NULL};

static const pn_parameter parameters[COUNT] = {
    [PRESET] = {"preset", "", "sets the others; what is named besides it goes over it", "docs/techniques/pcss.md",
                PN_CHOICE, 0, 2, 1, presets},
    [SAMPLES] = {"samples", "", "samples along each axis, in the blocker search and in the filter", "Fernando 2005",
                 PN_INT, 1, 64, 8, NULL},
};

static void preset(int choice, double *values) {
  static const double samples[] = {5, 8, 16};
  values[PRESET] = choice;
  values[SAMPLES] = samples[choice];
}

static void want(const double *values, pni_maps_want *out) {
  (void)values;
  *out = (pni_maps_want){.near_layers = 1, .range = {PNI_RANGE_PYRAMID, false, false}};
}

const pni_technique_class pni_technique_pcss = {
    .table = {.name = "pcss",
              .title = "percentage-closer soft shadows",
              .help =
                  "blockers searched over the light's real extent, then one filter of the width their average asks for",
              .parameters = parameters,
              .parameter_count = COUNT,
              .forward = 1,
              .self_shadows = 1},
    .want = want,
    .preset = preset,
    .draw = pni_gather,
    .gathering = {.shader = "techniques/pcss/pcss.glsl"},
};
